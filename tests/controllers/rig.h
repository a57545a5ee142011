// Test rig of the controllers: artificial inputs, and a toy plant with closed forms.
#pragma once

#include <algorithm>
#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tools/registry/program_catalogues.h"

namespace slipbench::controllers {

inline constexpr std::size_t pillars = 9;
inline constexpr double period = 0.02;  // s, of the loop

inline Channel vector_channel_of(const std::string& name, const std::string& unit) { return {name, unit, {pillars, 3}, {}}; }

// The channels of a PapillArray.
inline std::vector<Channel> papillarray_channels() {
  return {vector_channel_of("force", "N"), vector_channel_of("displacement", "m")};
}

// A PapillArray in a grasp with a preset of 4 N, and a detector.
inline GripSource papillarray_source() { return {.channels = papillarray_channels(), .preset = 4.0, .detected = true}; }

// The declaration of the controller `name`.
inline const Entry& about(const std::string& name) {
  for (const ControllerKind& kind : controller_catalogue()) {
    if (kind.about.name == name) return kind.about;
  }
  throw std::logic_error("no controller " + name);
}

using Settings = std::vector<std::pair<std::string, std::string>>;

// The controller `name` with its defaults changed by `settings`, written as in a scene.
inline Named named(const std::string& name, const Settings& settings = {}) {
  Named result{name, defaults_of(about(name).parameters)};
  for (const auto& [key, text] : settings) {
    bool known = false;
    for (const ParameterSpec& spec : about(name).parameters) {
      if (spec.name == key) result.parameters.set(key, parse_scalar(spec, text)), known = true;
    }
    if (!known) throw std::logic_error("no parameter " + key);
  }
  return result;
}

// `preset` in N.
inline std::unique_ptr<Controller> make(const std::string& name, const Settings& settings = {}, double preset = 4.0) {
  GripSource source = papillarray_source();
  source.preset = preset;
  return make_controller(named(name, settings), source);
}

// A frame of a PapillArray, all zero at first.
class PillarFrame {
 public:
  PillarFrame() : values_(2 * pillars * 3) {}

  // Shares `normal` and `tangential` (along x) equally among the nine pillars.
  static PillarFrame of_forces(double normal, double tangential = 0.0) {
    PillarFrame frame;
    for (std::size_t i = 0; i < pillars; ++i) frame.set_force(i, normal / pillars, tangential / pillars);
    return frame;
  }

  void set_force(std::size_t pillar, double normal, double tangential) {
    values_[3 * pillar] = static_cast<float>(tangential);
    values_[3 * pillar + 2] = static_cast<float>(normal);
  }

  [[nodiscard]] SensorFrame at(double time) const { return {time, values_}; }

 private:
  std::vector<float> values_;
};

// Input of the update `tick`: all pillars stick, half or none, depending on `state`. Refers to
// `frame`, which must outlive it.
inline ControlInput input_of(const PillarFrame& frame, int position, PadState state = PadState::non_slip, int tick = 0) {
  const double time = period * tick;
  ControlInput input;
  input.slip.time = time;
  input.slip.state = state;
  input.slip.stuck_fraction = state == PadState::gross ? 0.0 : state == PadState::incipient ? 0.5 : 1.0;
  input.frame = frame.at(time);
  input.gripper = {.time = time, .position = position, .moving = false, .stopped = false};
  return input;
}

// A self-locking gripper on a box that hangs between two equal pads, without masses, in whole
// milliseconds. F = per_count (position - contact), not below 0; each pad carries half the load.
// The box is held while load <= 2 mu F. The same statics give the state: gross beyond that,
// incipient beyond 0.9 of it.
class ToyPlant {
 public:
  double per_count = 1.2;  // N
  double contact = 10.0;   // counts
  int position = 10;       // counts
  double load = 0.0;       // N
  double mu = 0.4;
  int load_from = 0;      // update from which the load hangs on the pads
  int false_alarm = -1;   // update in which the state is incipient regardless of the statics
  int write = 10;         // ms from the read to the write
  int latency = 20;       // ms from the write until the motor obeys
  int ms_per_count = 19;  // of the motor; 0: at once

  struct Update {
    int measured = 0;    // counts, as read
    double force = 0.0;  // N, as read
    int command = 0;     // counts
  };

  // Runs `updates` periods of the loop with `controller`.
  std::vector<Update> run(Controller& controller, int updates) {
    std::vector<Update> history;
    for (int tick = 0; tick < updates; ++tick) {
      const double force = grip();
      const double carried = tick < load_from ? 0.0 : load;
      const PillarFrame frame = PillarFrame::of_forces(force, std::min(0.5 * carried, mu * force));
      const GripCommand command =
          controller.update(input_of(frame, position, tick == false_alarm ? PadState::incipient : state(force, carried), tick));
      history.push_back({position, force, command.position});
      written_.emplace_back(20 * tick + write + latency, command.position);
      for (int ms = 20 * tick; ms < 20 * (tick + 1); ++ms) move(ms);
    }
    return history;
  }

  [[nodiscard]] double grip() const { return std::max(0.0, per_count * (position - contact)); }
  [[nodiscard]] bool holds() const { return load <= 2.0 * mu * grip(); }

 private:
  [[nodiscard]] PadState state(double force, double carried) const {
    if (force == 0.0) return PadState::no_contact;
    if (carried > 2.0 * mu * force) return PadState::gross;
    return carried > 0.9 * 2.0 * mu * force ? PadState::incipient : PadState::non_slip;
  }

  void move(int ms) {
    while (!written_.empty() && written_.front().first <= ms) {
      target_ = written_.front().second;
      written_.pop_front();
    }
    if (target_ < 0 || target_ == position) {
      under_way_ = 0;
    } else if (ms_per_count == 0) {
      position = target_;
    } else {
      const int direction = target_ > position ? 1 : -1;
      under_way_ = direction == direction_ ? under_way_ + 1 : 1;
      direction_ = direction;
      if (under_way_ == ms_per_count) {
        position += direction;
        under_way_ = 0;
      }
    }
  }

  std::deque<std::pair<int, int>> written_;  // ms at which the motor obeys, position
  int target_ = -1;                          // -1: no command yet
  int under_way_ = 0;                        // ms spent on the count under way
  int direction_ = 1;
};

}  // namespace slipbench::controllers

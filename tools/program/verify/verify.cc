#include "tools/program/verify/verify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/contact_frame.h"
#include "sim/core/error.h"
#include "sim/scene/scene.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/dataset/shard_set.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/catalogue/sensor_catalogue.h"
#include "tools/program/run/recorded_scene.h"

namespace slipbench {
namespace {

enum class Check : std::size_t { digests, order, times, values, events, cone };

// Where something does not hold.
struct Where {
  std::optional<std::size_t> trial = {};
  std::string array = {};                  // inside the trial: "labels/pad/margin"
  std::optional<std::size_t> sample = {};  // row of the array
};

class Verification {
 public:
  // Of each check so many failures are listed, the others counted.
  static constexpr std::size_t listed = 5;

  // `count` more of what the check looks at: trials for digests and order, values or samples of units for the others.
  void count(Check check, std::size_t count) { of(check).checked += count; }
  // What was left out, and why. Said once.
  void leave_out(Check check, const std::string& why);
  void fail(Check check, const Where& where, const std::string& what);

  [[nodiscard]] bool holds() const;
  // {"holds", "checks": [{"check", "checked", "of", "failed", "left_out": [...]}], "failures": [{"check", "trial", "array", "sample", "what"}]}
  [[nodiscard]] Json json() const;

 private:
  struct Entry {
    std::size_t checked = 0, failed = 0;
    std::vector<std::string> left_out;
    Json failures = Json::array();
  };
  Entry& of(Check check) { return entries_[static_cast<std::size_t>(check)]; }

  std::array<Entry, 6> entries_;
};

// Which parts of Coulomb's law the labels of one sensor keep (README.md).
struct ConeLaw {
  bool margin = true;                      // stick and partial: margin >= 0
  bool stick = true;                       // stick and partial: f_t <= mu_static f_n
  bool margin_value = true;                // touching: margin = 1 - f_t/(mu_static f_n)
  bool slip_most = true;                   // slip: f_t <= mu_kinetic f_n
  bool slip_least = true;                  // slip: f_t >= mu_kinetic f_n
  std::vector<std::string> left_out = {};  // which parts do not hold, and why
};

struct About {
  const char* name;
  const char* of;  // what is counted
};
constexpr std::array<About, 6> about{{{"digests", "trials"},
                                      {"order", "trials"},
                                      {"times", "samples"},
                                      {"values", "values"},
                                      {"events", "samples of units"},
                                      {"cone", "samples of units"}}};

// An event at the instant of a sample may stand on either side of it [s].
constexpr double same_instant = 1e-9;
constexpr double of_a_sample = 1e-6;

void check_rising(const std::vector<double>& times, std::optional<double> rate, const Where& where, Verification& verification) {
  verification.count(Check::times, times.size());
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step = times[i] - times[i - 1];
    const Where here{where.trial, where.array, i};
    if (!(step > 0.0)) {
      verification.fail(Check::times, here, fmt::format("{} s after {} s", times[i], times[i - 1]));
    } else if (rate && std::abs(step * *rate - 1.0) > of_a_sample) {
      verification.fail(Check::times, here, fmt::format("{} s after the last one; rate_hz says {} s", step, 1.0 / *rate));
    }
  }
}

// Values of a column, of which row i may be NaN where `nan(i)`, and is NaN there where `always`.
template <class T, class Nan>
void check_finite(const std::vector<T>& values, std::size_t rows, const Where& where, Verification& verification, const Nan& nan,
                  bool always = false) {
  verification.count(Check::values, values.size());
  const std::size_t width = rows == 0 ? 1 : std::max<std::size_t>(1, values.size() / rows);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && !(always && nan(i))) continue;
    if (std::isnan(values[i]) && nan(i)) continue;
    verification.fail(Check::values, {where.trial, where.array, i / width},
                      fmt::format("value {} of the row is {}", i % width, static_cast<double>(values[i])));
  }
}

constexpr auto never = [](std::size_t) { return false; };

// State of a unit after an event of each kind.
constexpr std::array<UnitState, 6> state_after{UnitState::stick,    UnitState::slip,    UnitState::stick,
                                               UnitState::detached, UnitState::partial, UnitState::partial};

// The first time of each unit of events whose kind `counts`.
template <class Counts>
std::vector<double> first_times(const LabelRecord& labels, const Counts& counts) {
  std::vector<double> first(labels.units(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t e = 0; e < labels.event_time.size(); ++e) {
    if (counts(static_cast<EventKind>(labels.event_kind[e])))
      first[labels.event_unit[e]] = std::fmin(first[labels.event_unit[e]], labels.event_time[e]);
  }
  return first;
}

PadState judged(std::size_t touching, std::size_t slipping) {
  if (touching == 0) return PadState::no_contact;
  if (slipping == 0) return PadState::non_slip;
  return slipping < touching ? PadState::incipient : PadState::gross;
}

class EventCheck {
 public:
  EventCheck(const SensorRecord& sensor, std::size_t trial, Verification& verification)
      : labels_(sensor.labels),
        time_(sensor.time),
        group_(label_group(sensor.name) + "/"),
        trial_(trial),
        verification_(verification) {}

  void run() {
    if (!events_are_sound()) return;
    check_onsets("onset_time_s", labels_.onset_time,
                 first_times(labels_, [](EventKind kind) { return kind == EventKind::slip; }));
    check_onsets("micro_onset_time_s", labels_.micro_onset_time,
                 first_times(labels_, [](EventKind kind) { return kind == EventKind::slip || kind == EventKind::micro; }));
    for (std::size_t unit = 0; unit < labels_.units(); ++unit) check_unit(unit);
    check_pad();
  }

 private:
  void fail(const char* array, std::optional<std::size_t> sample, const std::string& what) {
    verification_.fail(Check::events, {trial_, group_ + array, sample}, what);
  }

  bool events_are_sound() {
    bool sound = true;
    const auto refuse = [&](const char* array, std::size_t event, const std::string& what) {
      fail(array, event, what);
      sound = false;
    };
    for (std::size_t e = 0; e < labels_.event_time.size(); ++e) {
      if (labels_.event_kind[e] >= state_after.size())
        refuse("events/kind", e, fmt::format("{} is no kind of event", labels_.event_kind[e]));
      if (labels_.event_unit[e] >= labels_.units()) refuse("events/unit", e, fmt::format("{} is no unit", labels_.event_unit[e]));
      if (!std::isfinite(labels_.event_time[e])) refuse("events/t", e, fmt::format("{} is no time", labels_.event_time[e]));
      if (e > 0 && labels_.event_time[e] < labels_.event_time[e - 1])
        refuse("events/t", e, fmt::format("{} s after {} s", labels_.event_time[e], labels_.event_time[e - 1]));
    }
    return sound;
  }

  void check_onsets(const char* name, const std::vector<double>& written, const std::vector<double>& first) {
    for (std::size_t unit = 0; unit < first.size(); ++unit) {
      if (written[unit] == first[unit] || (std::isnan(written[unit]) && std::isnan(first[unit]))) continue;
      fail("events/t", std::nullopt,
           fmt::format("unit {}: {} is {} s, its first such event is at {} s", unit, name, written[unit], first[unit]));
    }
  }

  // The state of each sample is that after the last event before it.
  void check_unit(std::size_t unit) {
    std::vector<std::size_t> events;
    for (std::size_t e = 0; e < labels_.event_time.size(); ++e) {
      if (labels_.event_unit[e] == unit) events.push_back(e);
    }
    std::size_t before = 0, until = 0;  // events surely before the sample, and those that may be
    for (std::size_t row = 0; row < time_.size(); ++row) {
      while (before < events.size() && labels_.event_time[events[before]] <= time_[row] - same_instant) ++before;
      while (until < events.size() && labels_.event_time[events[until]] <= time_[row] + same_instant) ++until;
      const auto state = labels_.unit_state[row * labels_.units() + unit];
      bool fits = false;
      for (std::size_t k = before; k <= until && !fits; ++k) {
        const UnitState left = k == 0 ? UnitState::detached : state_after[labels_.event_kind[events[k - 1]]];
        fits = state == static_cast<std::uint8_t>(left);
      }
      if (!fits)
        fail("unit_state", row,
             fmt::format("unit {}: is {} at {} s, which its events do not leave behind", unit, state, time_[row]));
    }
    verification_.count(Check::events, time_.size());
  }

  void check_pad() {
    const std::size_t units = labels_.units();
    for (std::size_t row = 0; row < time_.size(); ++row) {
      const std::span<const std::uint8_t> states(labels_.unit_state.data() + row * units, units);
      const auto at_least = [&](UnitState state) {
        return static_cast<std::size_t>(
            std::ranges::count_if(states, [state](std::uint8_t value) { return value >= static_cast<std::uint8_t>(state); }));
      };
      const std::size_t touching = at_least(UnitState::stick), micro = at_least(UnitState::slip);
      const auto whole = static_cast<std::size_t>(std::ranges::count(states, static_cast<std::uint8_t>(UnitState::slip)));
      // A pad of a single unit has none that could be told apart: strict is micro there.
      const auto expected = static_cast<std::uint8_t>(judged(touching, micro));
      if (units > 1 && labels_.state[row] != static_cast<std::uint8_t>(judged(touching, whole)))
        fail("state", row, fmt::format("is {}, by unit_state {}", labels_.state[row], static_cast<int>(judged(touching, whole))));
      if (units == 1 && labels_.state[row] != labels_.state_micro[row])
        fail("state", row,
             fmt::format("is {}, of a single unit, whose state_micro is {}", labels_.state[row], labels_.state_micro[row]));
      if (units > 1 && labels_.state_micro[row] != expected)
        fail("state_micro", row, fmt::format("is {}, by unit_state {}", labels_.state_micro[row], expected));
    }
  }

  const LabelRecord& labels_;
  const std::vector<double>& time_;
  std::string group_;
  std::size_t trial_;
  Verification& verification_;
};

void check_label_values(const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  const LabelRecord& labels = sensor.labels;
  const std::size_t units = labels.units(), rows = sensor.time.size();
  const auto at = [&](const char* name) { return Where{trial, label_group(sensor.name) + "/" + name}; };
  const auto touches = [&](std::size_t row) { return labels.state[row] != static_cast<std::uint8_t>(PadState::no_contact); };
  const auto slips = [&](std::size_t row) { return labels.state_micro[row] > static_cast<std::uint8_t>(PadState::non_slip); };
  check_finite(labels.slip_velocity, rows, at("slip_velocity"), verification, never);
  check_finite(labels.slip_distance, rows, at("slip_distance"), verification, never);
  check_finite(labels.force, rows, at("force"), verification, never);
  check_finite(labels.slip_angle, rows, at("slip_angle"), verification, never);
  check_finite(
      labels.margin, rows, at("margin"), verification,
      [&](std::size_t i) { return labels.unit_state[i] == static_cast<std::uint8_t>(UnitState::detached); }, true);
  check_finite(
      labels.stuck_fraction, rows, at("stuck_fraction"), verification, [&](std::size_t row) { return !touches(row); }, true);
  check_finite(
      labels.slip_direction, rows, at("slip_direction"), verification, [&](std::size_t row) { return !slips(row); }, true);
  // Its NaN says besides that the slip does not turn.
  check_finite(labels.slip_centre, rows, at("slip_centre"), verification, [](std::size_t) { return true; });
  for (const auto& [name, values] : {std::pair{"unit_positions", &labels.unit_positions},
                                     {"unit_heights", &labels.unit_heights},
                                     {"k_normal", &labels.k_normal},
                                     {"k_tangential", &labels.k_tangential},
                                     {"mu_static", &labels.mu_static},
                                     {"mu_kinetic", &labels.mu_kinetic}})
    check_finite(*values, units, at(name), verification, never);
  for (std::size_t i = 0; i < labels.unit_state.size(); ++i) {
    if (labels.unit_state[i] > static_cast<std::uint8_t>(UnitState::partial))
      verification.fail(Check::values, {trial, at("unit_state").array, i / units},
                        fmt::format("{} is no state of a unit", labels.unit_state[i]));
  }
}

// Labels are float32, so that both sides of the law are rounded at 6e-8 of the force.
constexpr double relative = 1e-6;
constexpr double least_force = 1e-9;  // N
constexpr double of_margin = 1e-5;

// Whether the elements of a pad look in several directions, as those of a fingertip do.
bool is_curved(const PadLayout& layout) {
  return std::ranges::any_of(layout.elements,
                             [&](const Element& element) { return element.axis != layout.elements.front().axis; });
}

bool has_sums(const PadLayout& layout) {
  return std::ranges::any_of(layout.units, [](const UnitRange& unit) { return unit.count > 1; });
}

void Verification::leave_out(Check check, const std::string& why) {
  std::vector<std::string>& said = of(check).left_out;
  if (std::ranges::find(said, why) == said.end()) said.push_back(why);
}

void Verification::fail(Check check, const Where& where, const std::string& what) {
  Entry& entry = of(check);
  if (entry.failed++ >= listed) return;
  entry.failures.push_back({{"check", about[static_cast<std::size_t>(check)].name},
                            {"trial", or_null(where.trial)},
                            {"array", where.array.empty() ? Json(nullptr) : Json(where.array)},
                            {"sample", or_null(where.sample)},
                            {"what", what}});
}

bool Verification::holds() const {
  return std::ranges::all_of(entries_, [](const Entry& entry) { return entry.failed == 0; });
}

Json Verification::json() const {
  Json checks = Json::array(), failures = Json::array();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    checks.push_back({{"check", about[i].name},
                      {"checked", entry.checked},
                      {"of", about[i].of},
                      {"failed", entry.failed},
                      {"left_out", entry.left_out}});
    for (const Json& failure : entry.failures) failures.push_back(failure);
  }
  return {{"holds", holds()}, {"checks", std::move(checks)}, {"failures", std::move(failures)}};
}

// Times rise strictly, those of a sensor at its rate to 1e-6 of a sample.
void check_times(const TrialRecord& record, Verification& verification) {
  for (const SensorRecord& sensor : record.sensors) {
    // What was recorded elsewhere has the steps that were recorded.
    const auto rate = sensor.labels.truth ? std::optional(sensor.rate) : std::nullopt;
    check_rising(sensor.time, rate, {record.trial, sensor_group(sensor.name) + "/t"}, verification);
    for (const SensorColumn& channel : sensor.channels) {
      if (channel.time)
        check_rising(*channel.time, std::nullopt, {record.trial, sensor_group(sensor.name) + "/" + own_time_path(channel.name)},
                     verification);
    }
  }
  if (!record.bodies.empty())
    check_rising(record.body_time, std::nullopt, {record.trial, body_group(record.bodies.front().name) + "/t"}, verification);
}

// Finite, but for what README.md of tools/base/dataset allows NaN: where nothing touches or slips.
void check_values(const TrialRecord& record, Verification& verification) {
  for (const SensorRecord& sensor : record.sensors) {
    for (const SensorColumn& channel : sensor.channels) {
      const std::size_t rows = channel.time ? channel.time->size() : sensor.time.size();
      check_finite(channel.values, rows, {record.trial, sensor_group(sensor.name) + "/" + channel.name}, verification, never);
    }
    if (sensor.labels.truth) check_label_values(sensor, record.trial, verification);
  }
  for (const BodyRecord& body : record.bodies) {
    check_finite(body.pose, record.body_time.size(), {record.trial, body_group(body.name) + "/pose"}, verification, never);
    check_finite(body.velocity, record.body_time.size(), {record.trial, body_group(body.name) + "/velocity"}, verification,
                 never);
  }
  if (record.control) {
    const std::size_t rows = record.control->time.size();
    check_finite(record.control->grip.grip_force, rows, {record.trial, "control/grip_force"}, verification, never);
    check_finite(record.control->grip.arm, rows, {record.trial, "control/arm_speed"}, verification, never);
  }
}

// Events in order, onset times the first events, unit_state what the events leave behind, the pad's states what the units' are.
void check_events(const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  EventCheck(sensor, trial, verification).run();
}

// Of the sensor `index` of a trial's scene.
ConeLaw cone_law(const Scene& scene, std::size_t index) {
  ConeLaw law;
  const auto leave_out = [&law](const std::vector<bool ConeLaw::*>& parts, const std::string& why) {
    for (const auto part : parts) law.*part = false;
    law.left_out.push_back(why);
  };
  if (scene.fidelity != "field") {
    leave_out({&ConeLaw::margin, &ConeLaw::stick, &ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
              fmt::format("all: fidelity {} keeps the cone to the solver's tolerance", scene.fidelity));
    return law;
  }
  for (const Named& effect : scene.effects) {
    const std::string& name = effect.name;
    if (name == "ageing" || name == "anisotropic_friction" || name == "load_dependent_friction" || name == "patchy_friction") {
      leave_out({&ConeLaw::stick, &ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
                fmt::format("all but margin >= 0: {} changes the friction, mu_static and mu_kinetic are the scene's", name));
    } else if (name == "viscous_friction") {
      leave_out({&ConeLaw::slip_most, &ConeLaw::slip_least}, "slip: viscous_friction adds to mu_kinetic");
    } else if (name == "stribeck") {
      leave_out({&ConeLaw::slip_least}, "slip from below: stribeck takes from mu_kinetic");
    } else if (name == "inertia" || name == "asperities") {
      leave_out({&ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
                fmt::format("slip and margin's value: with {} a tip's force is also that of its mass", name));
    }
  }
  const std::unique_ptr<Sensor> sensor = make_sensor(scene.sensors.at(index), scene.seed, 0);
  if (has_sums(sensor->layout())) {
    if (scene.surface.name != "plane" || (is_curved(sensor->layout()) && scene.dynamic())) {
      leave_out({&ConeLaw::stick, &ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
                "all but margin >= 0: elements of one unit meet faces of several directions");
    } else {
      leave_out({&ConeLaw::slip_least}, "slip from below: a unit is the sum of elements whose directions differ");
    }
  }
  return law;
}

void check_cone(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  const LabelRecord& labels = sensor.labels;
  const std::size_t units = labels.units();
  for (const std::string& why : law.left_out) verification.leave_out(Check::cone, why);
  for (std::size_t i = 0; i < labels.unit_state.size(); ++i) {
    const std::size_t unit = i % units;
    const auto state = static_cast<UnitState>(labels.unit_state[i]);
    const float* force = labels.force.data() + 3 * i;
    const double tangential = std::hypot(static_cast<double>(force[0]), static_cast<double>(force[1]));
    const double normal = force[2];
    const double margin = labels.margin[i];
    const auto fail = [&](const char* array, const std::string& what) {
      verification.fail(Check::cone, {trial, fmt::format("labels/{}/{}", sensor.name, array), i / units},
                        fmt::format("unit {}: {}", unit, what));
    };
    if (state == UnitState::detached) {
      if (tangential != 0.0 || normal != 0.0)
        fail("force", fmt::format("is detached and bears {} N", std::hypot(tangential, normal)));
      continue;
    }
    verification.count(Check::cone, 1);
    const double slack = least_force + relative * std::abs(normal);
    const double most_stuck = labels.mu_static[unit] * normal, slipping = labels.mu_kinetic[unit] * normal;
    if (normal < -slack) fail("force", fmt::format("touches and is pulled with {} N", -normal));
    if (state == UnitState::slip) {
      if (law.slip_most && tangential > slipping + slack)
        fail("force", fmt::format("slips at f_t = {} N, more than mu_kinetic f_n = {} N", tangential, slipping));
      if (law.slip_least && tangential < slipping - slack)
        fail("force", fmt::format("slips at f_t = {} N, less than mu_kinetic f_n = {} N", tangential, slipping));
    } else {
      if (law.margin && margin < -of_margin) fail("margin", fmt::format("sticks with the margin {}, below 0", margin));
      if (law.stick && tangential > most_stuck + slack)
        fail("force", fmt::format("sticks at f_t = {} N, more than mu_static f_n = {} N", tangential, most_stuck));
    }
    if (law.margin_value && most_stuck > 0.0 &&
        std::abs(margin - (1.0 - tangential / most_stuck)) > of_margin * std::max(1.0, std::abs(margin))) {
      fail("margin", fmt::format("is {}, and 1 - f_t/(mu_static f_n) is {}", margin, 1.0 - tangential / most_stuck));
    }
  }
}

class DatasetCheck {
 public:
  explicit DatasetCheck(const std::string& path)
      : reader_(path), catalogues_(program_catalogues()), digests_(reader_.files().size()) {}

  Json run() {
    check_order();
    for (const std::size_t trial : reader_.trials()) {
      check_digest(trial);
      check_content(trial);
    }
    check_file_digests();
    Json result{{"files", reader_.files()},
                {"schema", reader_.schema(0)},
                {"complete", reader_.complete()},
                {"trials", reader_.trials().size()}};
    if (const auto& part = reader_.header().part) result["shard"] = shard_text(*part);
    result.update(verification_.json());
    return result;
  }

 private:
  // What reading refuses does not hold.
  template <class Action>
  void hold(Check check, std::optional<std::size_t> trial, const Action& action) {
    try {
      action();
    } catch (const std::runtime_error& error) {
      verification_.fail(check, {trial}, error.what());
    }
  }

  void check_digest(std::size_t trial) {
    hold(Check::digests, trial, [&] {
      const std::size_t file = reader_.file_of(trial);
      const Digest found = reader_.stored_digest(trial);
      digests_[file].emplace_back(trial, found);
      const std::string written = reader_.trial_sha256(trial);
      if (!written.empty() && written != hexadecimal(found)) {
        verification_.fail(
            Check::digests, {trial},
            fmt::format("its content has the SHA-256 {}, its attribute sha256 says {}", hexadecimal(found), written));
      }
      verification_.count(Check::digests, 1);
    });
  }

  void check_file_digests() {
    for (std::size_t file = 0; file < digests_.size(); ++file) {
      const std::string name = reader_.files()[file];
      if (reader_.schema(file) == 1) {
        verification_.leave_out(Check::digests, "attributes: the dataset has schema 1, whose digest covers arrays alone");
      }
      const std::string& written = reader_.content_sha256()[file];
      if (written.empty()) {
        verification_.leave_out(Check::digests,
                                reader_.schema(file) == 1
                                    ? "arrays: the run was killed before it wrote content_sha256"
                                    : "the file's own attributes: the run was killed before it wrote content_sha256");
        continue;
      }
      hold(Check::digests, std::nullopt, [&] {
        const std::string found = reader_.stored_sha256(file, digests_[file]);
        if (found == written) return;
        verification_.fail(Check::digests, {},
                           fmt::format("{}: its content has the SHA-256 {}, content_sha256 says {}", name, found, written));
      });
    }
  }

  void check_order() {
    const std::vector<std::size_t>& trials = reader_.trials();
    verification_.count(Check::order, trials.size());
    const std::vector<FailedTrial>& failed = reader_.failed();
    for (const FailedTrial& trial : failed) {
      if (std::ranges::binary_search(trials, trial.trial))
        verification_.fail(Check::order, {trial.trial}, "is there, and listed as failed");
    }
    for (std::size_t i = 1; i < trials.size(); ++i) {
      const auto between = std::ranges::count_if(
          failed, [&](const FailedTrial& trial) { return trial.trial > trials[i - 1] && trial.trial < trials[i]; });
      const std::size_t next = trials[i - 1] + 1 + static_cast<std::size_t>(between);
      if (reader_.header().part) {
        verification_.leave_out(
            Check::order, "missing trials: the dataset is a shard of a sweep, which is held against the others that are named");
      } else if (trials[i] > next && reader_.content_sha256().front().empty()) {
        verification_.leave_out(Check::order, "missing trials: the run was killed before it wrote which failed");
      } else if (trials[i] > next) {
        verification_.fail(Check::order, {trials[i]},
                           fmt::format("comes after trial {}: those between them are missing", trials[i - 1]));
      }
      if (reader_.file_of(trials[i]) < reader_.file_of(trials[i - 1])) {
        verification_.fail(Check::order, {trials[i]}, fmt::format("lies in a file before that of trial {}", trials[i - 1]));
      }
    }
    hold(Check::order, std::nullopt, [&] { check_masks(); });
  }

  void check_masks() {
    std::vector<std::size_t> listed;
    for (const char* part : {"train", "valid", "test"}) {
      const std::vector<std::size_t> members = reader_.mask(part);
      if (!std::ranges::is_sorted(members))
        verification_.fail(Check::order, {{}, fmt::format("mask/{}", part)}, "is not in order");
      listed.insert(listed.end(), members.begin(), members.end());
    }
    if (listed.empty() && !reader_.complete()) {
      verification_.leave_out(Check::order, "masks: the run did not come to its end and wrote none");
      return;
    }
    std::ranges::sort(listed);
    for (std::size_t i = 1; i < listed.size(); ++i) {
      if (listed[i] == listed[i - 1]) verification_.fail(Check::order, {listed[i], "mask"}, "is listed twice");
    }
    for (const std::size_t trial : listed) {
      if (!std::ranges::binary_search(reader_.trials(), trial))
        verification_.fail(Check::order, {trial, "mask"}, "is listed and not there");
    }
    for (const std::size_t trial : reader_.trials()) {
      if (!std::ranges::binary_search(listed, trial)) verification_.fail(Check::order, {trial, "mask"}, "is in no part");
    }
  }

  void check_content(std::size_t trial) {
    hold(Check::values, trial, [&] {
      const TrialRecord record = reader_.read_trial(trial);
      if (record.seed != reader_.header().seed) {
        verification_.fail(Check::order, {trial},
                           fmt::format("has the seed {}, its file {}", record.seed, reader_.header().seed));
      }
      if (record.sensors.empty()) {
        for (const Check check : {Check::times, Check::values, Check::events, Check::cone}) {
          verification_.leave_out(check, "trials without arrays (--record outcome)");
        }
        return;
      }
      check_times(record, verification_);
      check_values(record, verification_);
      check_samples(trial, record);
      if (const std::string& truth = reader_.header().truth; !truth.empty()) {
        for (const Check check : {Check::events, Check::cone})
          verification_.leave_out(check, fmt::format("all: there is no truth to check ({})", truth));
        verification_.leave_out(Check::times, "steps against rate_hz: an imported recording has those that were recorded");
        return;
      }
      for (const SensorRecord& sensor : record.sensors) check_events(sensor, trial, verification_);
      check_cones(record);
    });
  }

  // A sensor's labels have its times, and num_samples is the bodies' count.
  void check_samples(std::size_t trial, const TrialRecord& record) {
    for (const SensorRecord& sensor : record.sensors) {
      if (!has_labels(sensor.labels)) continue;
      const std::string path = "labels/" + sensor.name + "/t";
      if (reader_.read<double>(trial, path) != sensor.time)
        verification_.fail(Check::times, {trial, path}, "are not the times of the sensor");
    }
    if (const std::size_t samples = reader_.info(trial).num_samples; samples != record.body_time.size()) {
      verification_.fail(Check::times, {trial, "truth"},
                         fmt::format("has {} rows, num_samples says {}", record.body_time.size(), samples));
    }
  }

  void check_cones(const TrialRecord& record) {
    std::optional<Scene> scene;
    try {
      scene = recorded_scene(reader_, record, catalogues_);
    } catch (const std::exception& error) {
      verification_.leave_out(Check::cone, fmt::format("all: this program does not know the scene ({})", error.what()));
      return;
    }
    for (const SensorRecord& sensor : record.sensors) {
      const auto found = std::ranges::find(scene->sensors, sensor.name, &SensorScene::name);
      if (found == scene->sensors.end()) {
        verification_.fail(Check::cone, {record.trial, "sensors/" + sensor.name}, "is no sensor of the scene");
        continue;
      }
      check_cone(cone_law(*scene, static_cast<std::size_t>(found - scene->sensors.begin())), sensor, record.trial, verification_);
    }
  }

  DatasetReader reader_;
  Catalogues catalogues_;
  std::vector<std::vector<std::pair<std::size_t, Digest>>> digests_;  // by file
  Verification verification_;
};

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// Which file of its dataset it is.
std::uint64_t shard_of(const std::string& path) {
  const std::string shard = guarded(path, [&] {
    const std::optional<FileAbout> about = file_about(path);
    if (!about) throw InputError(path + ": is no dataset");
    return std::to_string(about->shard);
  });
  return std::stoull(shard);
}

// Several shards against each other.
Json shards_result(const std::vector<std::string>& paths) {
  const auto action = [&] {
    Json result{{"shards", paths.size()}, {"trials", nullptr}, {"duplicates", nullptr}};
    std::vector<std::string> failures;
    try {
      ShardSet set(paths);
      failures = set.gaps();
      result["trials"] = set.size();
      result["duplicates"] = set.check_duplicates();
    } catch (const InputError& error) {
      failures.emplace_back(error.what());
    }
    result["holds"] = failures.empty();
    result["failures"] = failures;
    return dumped(result);
  };
  return Json::parse(guarded("one of the shards", reading_limits(paths), action));
}

}  // namespace

Verified verify_datasets(const std::vector<std::string>& paths) {
  Verified verified;
  std::set<std::string> seen;  // files of datasets that are verified
  std::vector<std::string> further;
  std::vector<std::string> shards;
  const auto run = [&](const std::string& path, const auto& action) {
    try {
      action();
    } catch (const std::runtime_error& error) {
      verified.readable = false;
      verified.datasets.push_back({{"file", path}, {"error", error.what()}});
    }
  };
  for (const std::string& path : paths) {
    run(path, [&] {
      if (shard_of(path) != 0) {
        further.push_back(path);
        return;
      }
      Json result = Json::parse(guarded(path, [&] { return dumped(DatasetCheck(path).run()); }));
      for (const Json& file : result["files"])
        seen.insert(std::filesystem::path(file.get<std::string>()).lexically_normal().string());
      verified.holds = verified.holds && result["holds"].get<bool>();
      if (result.contains("shard")) shards.push_back(path);
      Json dataset{{"file", path}};
      dataset.update(result);
      verified.datasets.push_back(std::move(dataset));
    });
  }
  for (const std::string& path : further) {
    run(path, [&] {
      if (!seen.contains(std::filesystem::path(path).lexically_normal().string())) {
        throw InputError(path + ": is a further file of a dataset; allowed: its first file, with which it is verified");
      }
      verified.datasets.push_back({{"file", path}, {"part_of", "a dataset above"}});
    });
  }
  if (shards.size() > 1) {
    run(fmt::format("{}", fmt::join(shards, ", ")), [&] {
      verified.sweep = shards_result(shards);
      verified.holds = verified.holds && verified.sweep["holds"].get<bool>();
    });
  }
  return verified;
}

}  // namespace slipbench

// The readings of a pad: labels, samples of the sensor, and MuJoCo's sensordata.
//
// sensordata of one instance: the values of the sensor, in the order of its channels. With
// truth="true" these follow, with N units:
//   unit_state [N] (0 detached, 1 stick, 2 slip, 3 partial), slip_velocity [N,2] m/s,
//   slip_distance [N] m, margin [N], contact_force [N,3] N,
//   state and state_micro (0 none, 1 non-slip, 2 incipient, 3 gross), stuck_fraction
// The margin of a separated unit and stuck_fraction without contact are 1, or NaN with
// unloaded="nan". The values are those of the state before the step, like all of MuJoCo's
// sensordata.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/sensor.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/pads/plugin_state.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// The labels and the sensor of one pad. Holds the readings of the last measured trial; commit()
// stores those that the next step needs in the PluginState.
class PadReadout {
 public:
  // Has a reader if a sensor of the model refers to plugin instance `instance`.
  PadReadout(ModelView model, int instance, const PadConfig& config, const PadCatalogue& catalogue);

  // Adds a reader of truth() and sensor().
  void watch() { reader_ = Reader::sensor; }
  // From here on, only truth() is read.
  void stop_sampling();

  // True if anything is read.
  [[nodiscard]] bool watched() const { return reader_ != Reader::none; }
  // True if sensordata of the model has the readings.
  [[nodiscard]] bool has_outputs() const { return !outputs_.empty(); }
  // True if the readings of a pad without contact change with time: the sensor has memory.
  [[nodiscard]] bool has_memory() const { return !first_memory_.empty(); }
  // Throws InputError if a step of `step` [s] is too long for a multiplexed sensor. `name`: of the
  // instance.
  void check_step(double step, const std::string& name) const;

  // Reads the fields after a trial that ends at `time` and began `dt` before [s]. A trial without
  // elapsed time is labelled as one of `step` [s].
  void measure(std::span<Field> fields, const PluginState& state, double time, double dt, double step);
  // Stores the readings of the last measure(), which the step of `dt` [s] keeps.
  void commit(std::span<const Field> fields, const PluginState& state, double dt);
  // Commits a pad without contact at `time` [s], whose readings do not change.
  void commit_idle(const PluginState& state, double time) const;
  // True if the last measure() took a sample.
  [[nodiscard]] bool sampled() const { return sample_.has_value(); }

  // Writes sensordata: the readings of the last measure(), or those of the last commit.
  void write(DataView data, const PluginState& state) const;
  void write_committed(DataView data, const PluginState& state) const;

  [[nodiscard]] const ContactFrame& truth(std::span<Field> fields, FramePart part) { return labels_.fill(fields, part); }
  void disable_slip_angle() { labels_.disable_slip_angle(); }
  [[nodiscard]] Sensor& sensor() { return *sensor_; }
  [[nodiscard]] const Sensor& sensor() const { return *sensor_; }

 private:
  enum class Reader : std::uint8_t { none, labels, sensor };

  [[nodiscard]] bool sample_is_due(double time, double next) const;
  [[nodiscard]] double sample_after(double time) const;

  Reader reader_ = Reader::none;
  std::unique_ptr<Sensor> sensor_;
  std::vector<std::span<double>> sensor_memory_;
  std::vector<double> first_memory_;  // of a new sensor: meaning of a state of zeros
  bool feels_every_tick_;             // the sensor also uses the contact at steps without a sample
  double sample_time_;                // s, 0: every step
  ContactLabels labels_;
  bool writes_truth_;
  double unloaded_;           // margin without contact
  std::vector<int> outputs_;  // addresses in sensordata

  // The sample of the last measure(), valid until the next one. Empty: none was due, and the sensor's
  // values are in the state.
  std::optional<std::span<const float>> sample_;
  double next_sample_ = 0.0;  // number of the sample after the last measure()
};

}  // namespace slipbench

// A pad's share of mjData's plugin_state: all that outlives a step.
//
// All zero means never stepped. Its parts, in this order:
//   header    time of the last commit [s], number of the sensor's next sample, slip angle [rad]
//   start     all that a trial starts from: the states of the fields; the poses of the pad and of
//             each touched geom when the pad was last committed idle; the Separation
//   implicit  memory of the implicit solver
//   memory    memory of the sensor
//   held      last sample of the sensor
//   truth     truth of the last commit (pad_readout.h)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/api/sensor.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// Steps of a pad since its last contact. It may be idle only after two steps without contact and a
// sample: a step that ends without contact may have slipped, and a sensor may have read the one
// before. The value is stored as a number.
enum class Separation : std::uint8_t {
  touching,   // or never stepped
  just_left,  // the last step may have slipped, or no sample has been taken since
  left,       // labels and readings no longer change
  idle,       // since then only the poses are those of the last step
};

// Number of values of each part.
struct PluginStateLayout {
  // Number of values of the header, and of a stored pose: position and rotation in MuJoCo's format.
  static constexpr std::size_t header_size = 3;
  static constexpr std::size_t pose_size = 12;

  std::size_t fields = 0;  // states of all fields
  std::size_t geoms = 0;   // touched geoms
  std::size_t implicit = 0;
  std::size_t memory = 0;
  std::size_t held = 0;
  std::size_t truth = 0;

  // `sensor`: of the pad; `field_values`: sum of Field::state_size().
  PluginStateLayout(const PadConfig& config, Sensor& sensor, std::size_t field_values);

  [[nodiscard]] std::size_t poses() const { return pose_size * (1 + geoms); }  // values of the stored poses
  [[nodiscard]] std::size_t start() const { return fields + poses() + 1; }
  [[nodiscard]] std::size_t total() const { return header_size + start() + implicit + memory + held + truth; }
};

// Number of values of an instance in plugin_state, and in sensordata. MuJoCo asks for them before
// the model has its meshes. pad_state_size() throws InputError if an effect does not fit a geom.
std::size_t pad_state_size(ModelView model, const PadConfig& config, const PadCatalogue& catalogue);
std::size_t pad_sensor_size(const PadConfig& config, const PadCatalogue& catalogue);

// Gives access to the state of one instance in one mjData, while that and the layout exist.
class PluginState {
 public:
  // `values`: PluginStateLayout::total() of them.
  PluginState(double* values, const PluginStateLayout& layout) : values_(values), layout_(layout) {}

  // True if a step has been committed since the last reset (Field::save_state).
  [[nodiscard]] bool placed() const { return values_[layout_.header_size] != 0.0; }
  // Marks the state as placed, for a pad whose fields are not stored.
  void set_placed() const { values_[layout_.header_size] = 1.0; }

  [[nodiscard]] double& committed_time() const { return values_[0]; }  // s
  [[nodiscard]] double& next_sample() const { return values_[1]; }
  [[nodiscard]] double& slip_angle() const { return values_[2]; }  // rad

  [[nodiscard]] std::span<double> start() const { return {values_ + layout_.header_size, layout_.start()}; }
  [[nodiscard]] std::span<double> poses() const { return start().subspan(layout_.fields, layout_.poses()); }
  [[nodiscard]] Separation separation() const { return static_cast<Separation>(start().back()); }
  void set_separation(Separation separation) const { start().back() = static_cast<double>(separation); }

  [[nodiscard]] std::span<double> implicit() const { return {start().data() + layout_.start(), layout_.implicit}; }
  [[nodiscard]] std::span<double> memory() const { return {implicit().data() + layout_.implicit, layout_.memory}; }
  [[nodiscard]] std::span<double> held() const { return {memory().data() + layout_.memory, layout_.held}; }
  [[nodiscard]] std::span<double> truth() const { return {held().data() + layout_.held, layout_.truth}; }

 private:
  double* values_;
  const PluginStateLayout& layout_;
};

}  // namespace slipbench

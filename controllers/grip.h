// What several controllers share: the grip force read from a frame, and the position that brings it to a target.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "controllers/controller_kinds.h"
#include "sim/core/controller.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor_frame.h"

namespace slipbench::controllers {

// Three axes (x, y, z of the pad frame) of one unit.
using UnitVector = std::span<const float, 3>;

// A channel with three axes for each of its units, found in the frames of a sensor.
class VectorChannel {
 public:
  // The channel `name` of `channels`. Throws SceneValueError at controller.type, with `controller` as who asks, where the sensor has no
  // such channel of extents {N, 3}.
  VectorChannel(const std::vector<Channel>& channels, const std::string& name, const std::string& controller);

  [[nodiscard]] std::size_t units() const { return units_; }

  // Unit `i` in `frame`. Throws std::logic_error for a frame that does not hold the channels that were announced.
  [[nodiscard]] UnitVector unit(const SensorFrame& frame, std::size_t i) const;

 private:
  std::size_t first_ = 0;       // index into SensorFrame::values
  std::size_t units_ = 0;       // N
  std::size_t frame_size_ = 0;  // values of a whole frame
};

// The forces that a sensor reports.
class GripForce {
 public:
  // Reads the channel "force" {N, 3} [N], z into the sensor. Throws as VectorChannel.
  GripForce(const std::vector<Channel>& channels, const std::string& controller)
      : force_(channels, "force", controller), controller_(controller) {}

  [[nodiscard]] std::size_t units() const { return force_.units(); }
  [[nodiscard]] double normal(const SensorFrame& frame, std::size_t unit) const;      // N, z of one unit
  [[nodiscard]] double tangential(const SensorFrame& frame, std::size_t unit) const;  // N, length of x and y of one unit

  // The measured grip force [N]: normal forces of all units, loaded or not, as the PapillArray's own global force. Throws InputError
  // when it is not finite: any comparison with it would read as "enough".
  [[nodiscard]] double total(const SensorFrame& frame) const;

 private:
  VectorChannel force_;
  std::string controller_;
};

// `position` moved by `counts` (inwards if positive) and kept within what a register holds: a gripper that is closed or open
// completely goes no further. NaN and infinite counts are a fault of the caller.
int moved(int position, double counts);

// From a wanted grip force to positions, in whole counts: n = ceil((target - grip)/force_per_count) beyond the measured position, as
// many as leave grip + n force_per_count <= ceiling. Because n counts from the position at which `grip` was measured, asking again
// while the fingers still move repeats the same position: the delay of the loop adds no counts. Without `loosen` the position never
// falls; with it, it opens by floor((grip - target)/force_per_count) counts and rests inside [target, target + force_per_count).
class ForceFollower {
 public:
  // Reads force_per_count, ceiling and loosen.
  explicit ForceFollower(const Parameters& parameters);

  // The position to command. `grip`, `target` in N, `measured` in counts.
  int toward(double grip, double target, int measured);

 private:
  double force_per_count_, ceiling_;
  bool loosen_;
  int position_ = -1;  // last command; before the first: none
};

// A controller that takes the box with the scene's preset force.
class GripController : public Controller {
 protected:
  // `name`: for messages. Throws as VectorChannel, and SceneValueError at controller.type where it waits for what a detector says in a scene
  // without one.
  GripController(const Parameters& parameters, const GripSource& source, const std::string& name,
                 bool waits_for_detector = false);

  GripForce force_;
  double preset_;  // N
  GripCommand command_;
};

// Declarations of parameters that several controllers have.
ParameterSpec force_per_count_spec();  // "force_per_count"
ParameterSpec ceiling_spec();          // "ceiling"
ParameterSpec loosen_spec();           // "loosen"
ParameterSpec touch_spec();            // "touch"

// `specs` and the two registers that go with each position: "speed_register" and "force_register".
std::vector<ParameterSpec> with_registers(std::vector<ParameterSpec> specs);

// A command without a position: the two registers of `parameters`.
GripCommand registers_of(const Parameters& parameters);

}  // namespace slipbench::controllers

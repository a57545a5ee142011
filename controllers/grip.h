// Shared by several controllers: the grip force read from a frame, and the position that brings it
// to a target.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "controllers/controller_kinds.h"
#include "sim/api/controller.h"
#include "sim/api/sensor_frame.h"
#include "sim/core/parameters.h"

namespace slipbench::controllers {

// x, y, z of one unit, in the pad frame.
using UnitVector = std::span<const float, 3>;

// A channel with three axes per unit, located in a sensor's frames.
class VectorChannel {
 public:
  // Finds the channel `name` of `channels` in the physical `unit`. Throws SceneValueError at
  // controller.type, naming `controller`, if the sensor has no such channel of extents {N, 3}, or
  // has it in another unit.
  VectorChannel(const std::vector<Channel>& channels, const std::string& name, const std::string& unit,
                const std::string& controller);

  [[nodiscard]] std::size_t units() const { return units_; }

  // Returns unit `i` in `frame`. Throws std::logic_error if the frame does not have the channels of
  // the constructor.
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
      : force_(channels, "force", "N", controller), controller_(controller) {}

  [[nodiscard]] std::size_t units() const { return force_.units(); }
  [[nodiscard]] double normal(const SensorFrame& frame, std::size_t unit) const;      // N, z of one unit
  [[nodiscard]] double tangential(const SensorFrame& frame, std::size_t unit) const;  // N, length of x and y of one unit

  // Returns the measured grip force [N]: the normal forces of all units, loaded or not, like the
  // PapillArray's own global force. Throws InputError if it is not finite, because comparisons with
  // it would read as "enough".
  [[nodiscard]] double total(const SensorFrame& frame) const;

 private:
  VectorChannel force_;
  std::string controller_;
};

// Returns `position` moved by `counts` (inwards if positive), clamped to the register's range: a
// fully closed or open gripper moves no further. `counts` must be finite.
int moved(int position, double counts);

// Turns a target grip force into positions in whole counts: n = ceil((target -
// grip)/force_per_count) beyond the measured position, at most as many as keep grip + n
// force_per_count <= ceiling. n is relative to the position at which `grip` was measured, so a call
// while the fingers still move returns the same position: the delay of the loop adds no counts.
// Without `loosen` the position never falls. With `loosen` the gripper opens by floor((grip -
// target)/force_per_count) counts and settles inside [target, target + force_per_count).
class ForceFollower {
 public:
  // Reads the parameters force_per_count, ceiling and loosen.
  explicit ForceFollower(const Parameters& parameters);

  // Returns the position to command. `grip`, `target` in N, `measured` in counts.
  int toward(double grip, double target, int measured);

 private:
  double force_per_count_, ceiling_;
  bool loosen_;
  int position_ = -1;  // last command; -1: none yet
};

// A controller that takes the box with the scene's preset force.
class GripController : public Controller {
 protected:
  // `name`: for messages. Throws as VectorChannel does, and SceneValueError at controller.type if
  // it waits for a detector in a scene without one.
  GripController(const Parameters& parameters, const GripSource& source, const std::string& name,
                 bool waits_for_detector = false);

  GripForce force_;
  double preset_;  // N
  GripCommand command_;
};

// Declarations of parameters common to several controllers.
ParameterSpec force_per_count_spec();  // "force_per_count"
ParameterSpec ceiling_spec();          // "ceiling"
ParameterSpec loosen_spec();           // "loosen"
ParameterSpec touch_spec();            // "touch"

// Returns `specs` with the two registers of each position, "speed_register" and "force_register".
std::vector<ParameterSpec> with_registers(std::vector<ParameterSpec> specs);

// Returns a command with the two registers of `parameters` and no position.
GripCommand registers_of(const Parameters& parameters);

}  // namespace slipbench::controllers

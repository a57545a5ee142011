// A controller computes the gripper's next command from a slip estimate, the sensor's frame and the
// gripper's status. Like a detector, it never sees the truth.
#pragma once

#include <optional>

#include "sim/api/detector.h"
#include "sim/api/sensor_frame.h"

namespace slipbench {

// Largest value of a register of a Robotiq 2F-85 (its manual): one byte each.
inline constexpr int max_register = 255;

// Speeds commanded to the arm that carries the gripper: horizontal, perpendicular to the fingers'
// closing direction, and upward.
struct ArmCommand {
  double sideways = 0.0;  // m/s
  double up = 0.0;        // m/s
};

// The gripper's status, as one read returns it.
struct GripperStatus {
  double time = 0.0;     // s, instant of the read
  int position = 0;      // gPO, counts: 0 open, growing as the fingers close
  bool moving = false;   // gOBJ = 0
  bool stopped = false;  // gOBJ = 1 or 2: stopped at the force limit before the commanded position
};

// The values of one write. A value that does not fit in a byte is an error of the controller: the
// gripper refuses it.
struct GripCommand {
  int position = 0;  // rPR, counts
  int speed = 0;     // rSP, 0 slowest
  int force = 0;     // rFR, 0 weakest
  // Command for the arm, where the scene's motion is guided. Empty: the arm keeps its last command.
  std::optional<ArmCommand> arm{};
};

// Input of a controller at one instant of the loop, as old as the loop's delays make it.
struct ControlInput {
  SlipEstimate slip;
  SensorFrame frame;  // of the detector's sensor
  GripperStatus gripper;
};

class Controller {
 public:
  virtual ~Controller() = default;

  // Returns the command that follows from `input`. Called once per period of the loop, in order of
  // time.
  virtual GripCommand update(const ControlInput& input) = 0;
  // See Detector::listener().
  [[nodiscard]] virtual SampleListener* listener() { return nullptr; }
  // See Detector::finish().
  virtual void finish() {}
};

}  // namespace slipbench

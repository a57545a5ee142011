// A controller: from a slip estimate, the sensor's frame and the gripper's status to the gripper's next command. As a detector it
// never sees the truth.
#pragma once

#include <optional>

#include "sim/core/detector.h"
#include "sim/core/sensor_frame.h"

namespace slipbench {

// What is read from a gripper and written to it: the registers of a Robotiq 2F-85 (shared SENSORS.md, section 5), one byte each.
inline constexpr int max_register = 255;

// How fast the arm that carries the gripper is to move on: horizontally, square to the fingers' closing direction, and up.
struct ArmCommand {
  double sideways = 0.0;  // m/s
  double up = 0.0;        // m/s
};

// What a read of the status returns.
struct GripperStatus {
  double time = 0.0;     // s, instant of the read
  int position = 0;      // gPO, counts: 0 open, growing as the fingers close
  bool moving = false;   // gOBJ = 0
  bool stopped = false;  // gOBJ = 1 or 2: stopped at the force limit before it was where it was told to be
};

// What a write sends. A value that is no byte is a fault of the controller: the gripper refuses it.
struct GripCommand {
  int position = 0;  // rPR, counts
  int speed = 0;     // rSP, 0 slowest
  int force = 0;     // rFR, 0 weakest
  // What goes to the arm with it, where the scene's motion is guided; empty: nothing is said to the arm, which goes on as told before.
  std::optional<ArmCommand> arm{};
};

// What a controller is handed at one instant of the loop: all of it as old as the loop's own delays made it.
struct ControlInput {
  SlipEstimate slip;
  SensorFrame frame;  // of the sensor that the detector listens to
  GripperStatus gripper;
};

class Controller {
 public:
  virtual ~Controller() = default;

  // The command that follows from what is known now. Called once a period of the loop, in order of time.
  virtual GripCommand update(const ControlInput& input) = 0;
  // As Detector::listener().
  [[nodiscard]] virtual SampleListener* listener() { return nullptr; }
  // As Detector::finish().
  virtual void finish() {}
};

}  // namespace slipbench

// A controller: from a slip estimate, the sensor's frame and the gripper's status to the gripper's next command. As a detector it
// never sees the truth.
#pragma once

#include "sim/core/detector.h"
#include "sim/core/gripper_registers.h"
#include "sim/core/sensor_frame.h"

namespace slipbench {

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

// The loop of a grasp: what is read from the gripper, what the controller makes of it, what is written to the gripper and to the arm.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

#include "sim/core/controller.h"
#include "sim/grasp/held_box.h"
#include "tools/program/run/detector_loop.h"

namespace slipbench {

class GripLoop {
 public:
  // `box` must outlive the loop. `controller`: null: nothing is read or written, and the fingers stay where they begin. `detector`: empty: the
  // controller sees the estimate of no contact.
  GripLoop(HeldBox& box, std::unique_ptr<Controller> controller, std::optional<DetectorLoop> detector);

  // A frame of any pad's sensor; the controller sees those of the first. Its values must stay until the next.
  void sample(std::size_t pad, const SensorFrame& frame) {
    if (pad == 0) frame_ = frame;
    if (detector_) detector_->sample(pad, frame);
  }

  // Once every tick, after its sample: does what is due at `time` [s]. At a read the controller is asked, with the latest frame and
  // what is there of the detector at that tick; its command goes with the next write, to a guided arm at the same instant. Throws what the controller and the gripper refuse.
  void act(double time);

  // The pad whose sensor the detector, else the controller reads.
  [[nodiscard]] std::size_t pad() const { return detector_ ? detector_->pad() : 0; }
  // Whether there is a detector or a controller.
  [[nodiscard]] bool closed() const { return detector_.has_value() || controller_ != nullptr; }
  // What the loop sees of the detector at the tick last acted at.
  [[nodiscard]] PadState seen() const { return input_.slip.state; }
  // Registers as written last; before the first write the position at which the fingers stand.
  [[nodiscard]] const GripCommand& written() const { return written_; }
  // What the arm was told last; at rest before it was told anything, and where its motion is prescribed.
  [[nodiscard]] const ArmCommand& told_arm() const { return told_arm_; }
  // The latest write that closed the fingers further than they were measured and told before.
  struct Tightening {
    double read = std::numeric_limits<double>::quiet_NaN();  // s, when what it follows from was read; NaN: there was none yet
    double acts = std::numeric_limits<double>::quiet_NaN();  // s, when it begins to act
  };
  [[nodiscard]] const Tightening& tightening() const { return tightening_; }
  // Counts, of the latest read; before the first where the fingers stand.
  [[nodiscard]] int measured_position() const { return input_.gripper.position; }

 private:
  void command_arm(double time, const ArmCommand& command);

  HeldBox& box_;
  std::unique_ptr<Controller> controller_;
  std::optional<DetectorLoop> detector_;
  SensorFrame frame_;
  ControlInput input_;
  GripCommand next_, written_;
  ArmCommand told_arm_;
  Tightening tightening_;
};

}  // namespace slipbench

#include "tools/program/run/grip_loop.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace slipbench {

GripLoop::GripLoop(HeldBox& box, std::unique_ptr<Controller> controller, std::optional<DetectorLoop> detector)
    : box_(box), controller_(std::move(controller)), detector_(std::move(detector)) {
  next_.position = written_.position = input_.gripper.position = box_.gripper().position(0.0);
}

void GripLoop::act(double time) {
  if (detector_) input_.slip = detector_->seen_at(time);
  if (!controller_) return;
  Gripper& gripper = box_.gripper();
  // A step may be longer than the loop's period.
  while (gripper.read_due(time) || gripper.write_due(time)) {
    if (gripper.read_due(time) && gripper.next_read() <= gripper.next_write()) {
      input_.frame = frame_;
      input_.gripper = gripper.read();
      next_ = controller_->update(input_);
    } else {
      if (next_.arm) command_arm(gripper.next_write(), *next_.arm);
      const double acts = gripper.next_write() + gripper.latency();
      const GripCommand before = std::exchange(written_, gripper.write(next_));
      if (written_.position > std::max(before.position, input_.gripper.position)) tightening_ = {input_.gripper.time, acts};
    }
  }
}

void GripLoop::command_arm(double time, const ArmCommand& command) {
  Guided* arm = box_.arm();
  if (arm == nullptr) throw std::logic_error("a controller commands an arm that moves as the scene prescribes");
  arm->write(time, command);
  told_arm_ = command;
}

}  // namespace slipbench

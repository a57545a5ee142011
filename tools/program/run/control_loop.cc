#include "tools/program/run/control_loop.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace slipbench {

ControlLoop::ControlLoop(std::optional<DelayedDetector> detector, std::size_t pad, std::unique_ptr<Controller> controller,
                         HeldBox* box)
    : detector_(std::move(detector)), pad_(pad), controller_(std::move(controller)), box_(box) {
  if (box != nullptr) command_.position = written_.position = input_.gripper.position = box->gripper().position(0.0);
  for (SampleListener* const listener :
       {detector_ ? detector_->listener() : nullptr, controller_ ? controller_->listener() : nullptr}) {
    if (listener != nullptr) listeners_.push_back(listener);
  }
}

void ControlLoop::finish() {
  if (detector_) detector_->finish();
  if (controller_) controller_->finish();
}

void ControlLoop::act_at(double time) {
  if (detector_) detector_->seen_at(time);
  if (!controller_) return;
  Gripper& gripper = box_->gripper();
  // A step may be longer than the loop's period.
  while (gripper.read_due(time) || gripper.write_due(time)) {
    if (gripper.read_due(time) && gripper.next_read() <= gripper.next_write()) {
      read();
      command_ = controller_->update(input_);
    } else {
      write();
    }
  }
}

bool ControlLoop::act_or_wait(std::span<const Tick> ticks) {
  Gripper& gripper = box_->gripper();
  for (; acted_ < ticks.size(); ++acted_) {
    if (ticks[acted_].pad != 0) continue;
    const double time = ticks[acted_].time;
    if (detector_) detector_->seen_at(time);
    while (gripper.read_due(time) || gripper.write_due(time)) {
      if (gripper.read_due(time) && gripper.next_read() <= gripper.next_write()) {
        read();
        return false;
      }
      write();
    }
  }
  acted_ = 0;
  return true;
}

void ControlLoop::read() {
  if (detector_) input_.slip = detector_->seen();
  input_.frame = frame_;
  input_.gripper = box_->gripper().read();
}

void ControlLoop::write() {
  Gripper& gripper = box_->gripper();
  if (command_.arm) command_arm(gripper.next_write(), *command_.arm);
  const double start = gripper.next_write() + gripper.latency();
  const GripCommand before = std::exchange(written_, gripper.write(command_));
  if (written_.position > std::max(before.position, input_.gripper.position)) tightening_ = {input_.gripper.time, start};
}

void ControlLoop::command_arm(double time, const ArmCommand& command) {
  Guided* arm = box_->arm();
  if (arm == nullptr) throw std::logic_error("a controller commands an arm that moves as the scene prescribes");
  arm->write(time, command);
  arm_command_ = command;
}

}  // namespace slipbench

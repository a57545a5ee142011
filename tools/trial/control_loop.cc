#include "tools/trial/control_loop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

// True if `due` has been reached at `time`. Ticks are multiples of a step and `due` is the sum of a
// tick and a latency, so a latency of whole ticks may miss its tick by a few units in the last
// place.
bool has_come(double due, double time) { return due <= time + 4.0 * std::numeric_limits<double>::epsilon() * std::abs(time); }

}  // namespace

ControlLoop::ControlLoop(std::optional<DelayedDetector> detector, std::size_t pad, std::unique_ptr<Controller> controller,
                         HeldBox* box, Answers answers)
    : detector_(std::move(detector)), pad_(pad), controller_(std::move(controller)), box_(box), answers_(answers) {
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
  // A step may span several periods of the loop.
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
  const bool answers = answers_ == Answers::by_own_rule || (answers_ == Answers::seen_slip && slips(input_.slip.state));
  if (answers && written_.position > std::max(before.position, input_.gripper.position))
    tightening_ = {input_.gripper.time, start};
}

void ControlLoop::command_arm(double time, const ArmCommand& command) {
  Guided* arm = box_->arm();
  if (arm == nullptr) throw std::logic_error("a controller commands an arm that moves as the scene prescribes");
  arm->write(time, command);
  arm_command_ = command;
}

void DelayedDetector::update(const SensorFrame& frame) {
  const SlipEstimate& estimate = detector_->update(frame);
  if (!(estimate.latency >= 0.0)) throw std::logic_error("a detector's latency is negative or no number");
  const SlipEstimate& last = under_way_.empty() ? seen_ : under_way_.back();
  if (estimate.time < last.time) throw std::logic_error("a detector's estimate is older than its last one");
  under_way_.push_back(estimate);
}

const SlipEstimate& DelayedDetector::seen_at(double time) {
  for (std::size_t i = under_way_.size(); i-- > 0;) {
    if (!has_come(under_way_[i].time + under_way_[i].latency, time)) continue;
    seen_ = under_way_[i];
    for (std::size_t come = 0; come <= i; ++come) under_way_.pop_front();
    break;
  }
  return seen_;
}

}  // namespace slipbench

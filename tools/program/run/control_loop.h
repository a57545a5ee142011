// What closes the loop around a simulation: a detector that reads a sensor, a controller that reads the gripper and commands it
// and the arm.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/core/controller.h"
#include "sim/grasp/held_box.h"
#include "tools/program/run/sampling.h"

namespace slipbench {

// Every part may be absent, and then costs nothing.
class ControlLoop {
 public:
  // `detector` reads the sensor of `pad`; empty: the estimate is that of no contact. `box`: the grasp's, which must outlive the
  // loop; null: the scene is none. `controller`, of a grasp alone; null: nothing is read or written, and the fingers stay where
  // they begin.
  explicit ControlLoop(std::optional<DelayedDetector> detector = {}, std::size_t pad = 0,
                       std::unique_ptr<Controller> controller = nullptr, HeldBox* box = nullptr);

  // Hands the samples that are complete to who listens to all sensors, then to the detector; the controller gets those of the
  // first pad, whose values must stay until the next.
  void update(std::span<const Tick> ticks) {
    if (!closed()) return;
    for (SampleListener* const listener : listeners_) {
      for (const Tick& tick : ticks) {
        if (tick.sample != nullptr) listener->hear(tick.pad, *tick.sample);
      }
    }
    for (const Tick& tick : ticks) {
      if (tick.sample == nullptr) continue;
      if (tick.pad == 0) frame_ = *tick.sample;
      if (detector_ && tick.pad == pad_) detector_->update(*tick.sample);
    }
  }

  // Once every instant, after update(): at a tick of the first pad in a grasp, else of the detector's, does what is due. At a
  // read of the gripper the controller is asked, with the latest frame and estimate of that tick; its command goes with the next
  // write, to a guided arm at the same instant. Throws what the controller and the gripper refuse.
  void act(std::span<const Tick> ticks) {
    if (!closed()) return;
    for (const Tick& tick : ticks) {
      if (tick.pad == (box_ != nullptr ? 0 : pad_)) act_at(tick.time);
    }
  }

  // In place of act() where what the controller would say comes from outside: false where a read of the gripper asks for it; then, after
  // command(), the same call goes on. True when all that is due is done.
  bool act_or_wait(std::span<const Tick> ticks);
  // What a controller would be handed at that read.
  [[nodiscard]] const ControlInput& awaiting() const { return input_; }
  void command(const GripCommand& command) { command_ = command; }

  // Once after the trial. Throws what the detector and the controller throw as they end.
  void finish();

  // The pad whose sensor the detector, else the controller reads.
  [[nodiscard]] std::size_t pad() const { return pad_; }
  [[nodiscard]] bool has_detector() const { return detector_.has_value(); }
  // The detector's class at the tick last acted at.
  [[nodiscard]] PadState seen() const { return detector_ ? detector_->seen().state : PadState::no_contact; }
  // Registers as written last; before the first write the position at which the fingers stand.
  [[nodiscard]] const GripCommand& written() const { return written_; }
  // The arm's latest command; at rest before the first, and where the arm's motion is prescribed.
  [[nodiscard]] const ArmCommand& arm_command() const { return arm_command_; }
  // Counts, of the latest read; before the first where the fingers stand.
  [[nodiscard]] int measured_position() const { return input_.gripper.position; }
  // The latest write that closes the fingers further than they were measured and commanded before.
  struct Tightening {
    double read_time = std::numeric_limits<double>::quiet_NaN();  // s, of the read from which it follows; NaN: there was none yet
    double start_time = std::numeric_limits<double>::quiet_NaN();  // s, when it begins to act
  };
  [[nodiscard]] const Tightening& tightening() const { return tightening_; }

 private:
  [[nodiscard]] bool closed() const { return detector_.has_value() || controller_ != nullptr; }
  void act_at(double time);
  // Reads the gripper at the read that is due.
  void read();
  // Writes the command with the write that is due.
  void write();
  void command_arm(double time, const ArmCommand& command);

  std::optional<DelayedDetector> detector_;
  std::size_t pad_;
  std::unique_ptr<Controller> controller_;
  HeldBox* box_;
  std::vector<SampleListener*> listeners_;  // of the detector and the controller; usually none
  SensorFrame frame_;
  ControlInput input_;
  GripCommand command_, written_;
  ArmCommand arm_command_;
  Tightening tightening_;
  std::size_t acted_ = 0;  // ticks of this instant that act_or_wait() has done
};

}  // namespace slipbench

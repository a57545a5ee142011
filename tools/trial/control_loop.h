// Closes the loop around a simulation: a detector reads a sensor; a controller reads the gripper
// and commands gripper and arm.
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "controllers/controller_kinds.h"
#include "sim/api/controller.h"
#include "sim/api/detector.h"
#include "sim/api/sensor_frame.h"
#include "sim/grasp/grasp.h"
#include "tools/trial/sampler.h"

namespace slipbench {

// A detector within a trial: estimates become visible after their latency.
class DelayedDetector {
 public:
  explicit DelayedDetector(std::unique_ptr<Detector> detector) : detector_(std::move(detector)) {}

  [[nodiscard]] const std::vector<Feature>& features() const { return detector_->features(); }
  [[nodiscard]] SampleListener* listener() { return detector_->listener(); }
  [[nodiscard]] std::string notice() const { return detector_->notice(); }
  void finish() { detector_->finish(); }

  // Passes the next frame of its sensor. Throws std::logic_error if the detector's estimate is
  // older than its previous one, or its latency is negative or NaN.
  void update(const SensorFrame& frame);

  // The estimate visible at the tick at `time` [s], after the tick's update(): the latest one with
  // estimate.time + estimate.latency <= time, to the rounding of a double. no_contact before the
  // first. Ticks come in ascending order.
  const SlipEstimate& seen_at(double time);
  // The estimate of the latest seen_at().
  [[nodiscard]] const SlipEstimate& seen() const { return seen_; }

 private:
  std::unique_ptr<Detector> detector_;
  std::deque<SlipEstimate> under_way_;  // not visible yet, in order of time
  SlipEstimate seen_;
};

// Control loop of a trial. Each part may be absent and then costs nothing.
class ControlLoop {
 public:
  // `detector` reads the sensor of `pad`; empty: the estimate is no contact. `box`: the grasp's,
  // which must outlive the loop. A null box: the scene is not a grasp. `controller` is for grasps
  // only; null: the gripper is neither read nor written, and the fingers keep their initial
  // position. `answers`: the closing commands of the controller that count as answers.
  explicit ControlLoop(std::optional<DelayedDetector> detector = {}, std::size_t pad = 0,
                       std::unique_ptr<Controller> controller = nullptr, HeldBox* box = nullptr,
                       Answers answers = Answers::by_own_rule);

  // Passes complete samples to listeners of all sensors, then to the detector; the controller gets
  // those of the first pad, whose values must stay valid until the next.
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

  // Call once per instant, after update(). At a tick of the first pad in a grasp, else of the
  // detector's pad, performs what is due. At a read of the gripper it calls the controller with the
  // latest frame and estimate of that tick; the command is sent with the next write, or to a guided
  // arm at the same instant. Throws as the controller and the gripper do.
  void act(std::span<const Tick> ticks) {
    if (!closed()) return;
    for (const Tick& tick : ticks) {
      if (tick.pad == (box_ != nullptr ? 0 : pad_)) act_at(tick.time);
    }
  }

  // Replaces act() if commands come from outside: returns false at a read of the gripper that needs
  // a command; after command(), the same call continues. Returns true when everything due is done.
  bool act_or_wait(std::span<const Tick> ticks);
  // Input of the controller at that read.
  [[nodiscard]] const ControlInput& awaiting() const { return input_; }
  void command(const GripCommand& command) { command_ = command; }

  // Call once after the trial. Throws as the detector's and the controller's finish() do.
  void finish();

  // The pad whose sensor the detector, else the controller reads.
  [[nodiscard]] std::size_t pad() const { return pad_; }
  // Detector::notice(); empty without a detector.
  [[nodiscard]] std::string notice() const { return detector_ ? detector_->notice() : std::string(); }
  [[nodiscard]] bool has_detector() const { return detector_.has_value(); }
  // The detector's class at the latest tick of act().
  [[nodiscard]] PadState seen() const { return detector_ ? detector_->seen().state : PadState::no_contact; }
  // Registers written last; before the first write the initial position of the fingers.
  [[nodiscard]] const GripCommand& written() const { return written_; }
  // The arm's latest command; at rest before the first, and if the arm's motion is prescribed.
  [[nodiscard]] const ArmCommand& arm_command() const { return arm_command_; }
  // Counts, of the latest read; before the first, the initial position of the fingers.
  [[nodiscard]] int measured_position() const { return input_.gripper.position; }
  // The latest write that closes the fingers further than measured and commanded before, and that
  // may answer a slip.
  struct Tightening {
    double read_time = std::numeric_limits<double>::quiet_NaN();   // s, of the read that led to it; NaN: no such write yet
    double start_time = std::numeric_limits<double>::quiet_NaN();  // s, at which it takes effect
  };
  [[nodiscard]] const Tightening& tightening() const { return tightening_; }

 private:
  [[nodiscard]] bool closed() const { return detector_.has_value() || controller_ != nullptr; }
  void act_at(double time);
  // Reads the gripper if a read is due.
  void read();
  // Writes the command if a write is due.
  void write();
  void command_arm(double time, const ArmCommand& command);

  std::optional<DelayedDetector> detector_;
  std::size_t pad_;
  std::unique_ptr<Controller> controller_;
  HeldBox* box_;
  Answers answers_;
  std::vector<SampleListener*> listeners_;  // of the detector and the controller; usually none
  SensorFrame frame_;
  ControlInput input_;
  GripCommand command_, written_;
  ArmCommand arm_command_;
  Tightening tightening_;
  std::size_t acted_ = 0;  // ticks of this instant that act_or_wait() has completed
};

}  // namespace slipbench

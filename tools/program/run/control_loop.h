// What closes the loop around a simulation: a detector that reads a sensor, a controller that reads the gripper and commands it
// and the arm.
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/core/controller.h"
#include "sim/core/detector.h"
#include "sim/core/sensor.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

namespace slipbench {

// When sensors are read and when a slow detector's estimates are there.

// What is sampled when.

// When a pad's sensor reads the contact, and when that completes a sample. Ticks are the pad's own (simulation.h).
struct Sampling {
  std::size_t stride = 1;  // ticks between two readings
  std::size_t scans = 1;   // readings a sample (Sensor::scans)

  [[nodiscard]] bool reads_at(std::size_t tick) const { return tick % stride == 0; }
  [[nodiscard]] bool completes_at(std::size_t tick) const { return tick % ticks() == (scans - 1) * stride; }
  // Ticks between two samples.
  [[nodiscard]] std::size_t ticks() const { return stride * scans; }
  // Samples that are complete in a trial of so many ticks.
  [[nodiscard]] std::size_t samples(std::size_t trial_ticks) const { return ((trial_ticks + stride - 1) / stride) / scans; }
};

// A pad's tick as the loop may see it: without the truth.
struct Tick {
  std::size_t pad = 0;
  double time = 0.0;                    // s
  const SensorFrame* sample = nullptr;  // that the tick completes; null: none. Stays until the sensor is read again
};

// Reads a trial's sensors when their time has come.
class Sampler {
 public:
  // All must outlive the sampler. Throws SceneValueError when the trial ends before a sensor's first sample is complete; std::logic_error
  // when a sensor asks for element_truth and the simulation's frames do not carry it.
  Sampler(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation);

  // Whether every pad has had its ticks.
  [[nodiscard]] bool finished() const { return remaining_ == 0; }
  // Once after every step: the ticks at that instant, in the order of pads, for which every sensor that is due has been read. Stays until
  // the next call.
  std::span<const Tick> measure() {
    std::size_t ticks = 0;
    for (const std::size_t pad : simulation_.stepped()) {
      const ContactFrame& truth = simulation_.contact(pad);
      ticks_[ticks++] = {pad, truth.time, pads_[pad].measure(truth)};
    }
    remaining_ -= ticks;
    return {ticks_.data(), ticks};
  }

  // Samples of the pad's sensor in the whole trial.
  [[nodiscard]] std::size_t samples(std::size_t pad) const { return pads_[pad].sampling.samples(simulation_.ticks(pad)); }
  // The latest sample of the pad's sensor, after the first; of a next one that has begun, what has been read of it too.
  [[nodiscard]] const SensorFrame& latest(std::size_t pad) const { return *pads_[pad].latest; }

 private:
  struct Pad {
    Sensor* sensor;
    Sampling sampling;
    std::size_t tick = 0;                 // the next one
    const SensorFrame* latest = nullptr;  // the sensor's own

    // The sample that the next tick completes; null: none.
    const SensorFrame* measure(const ContactFrame& truth) {
      const std::size_t now = tick++;
      if (!sampling.reads_at(now)) return nullptr;
      const SensorFrame& frame = sensor->measure(truth);
      if (!sampling.completes_at(now)) return nullptr;
      return latest = &frame;
    }
  };

  const Simulation& simulation_;
  std::vector<Pad> pads_;
  std::vector<Tick> ticks_;    // room for one of each pad
  std::size_t remaining_ = 0;  // ticks to come, of all pads
};

// A detector inside a trial: an estimate is seen once its latency is over.
class DelayedDetector {
 public:
  explicit DelayedDetector(std::unique_ptr<Detector> detector) : detector_(std::move(detector)) {}

  [[nodiscard]] const std::vector<Feature>& features() const { return detector_->features(); }
  [[nodiscard]] SampleListener* listener() { return detector_->listener(); }
  void finish() { detector_->finish(); }

  // The next frame of its sensor. Throws std::logic_error when the detector's estimate is older than its last one, or has a
  // latency that is negative or no number.
  void update(const SensorFrame& frame);

  // What is seen at the tick at `time` [s], after the tick's update(): the latest estimate with estimate.time + estimate.latency
  // <= time, to the rounding of a double. no_contact before the first. Ticks come in ascending order.
  const SlipEstimate& seen_at(double time);
  // What was seen at the tick last asked for.
  [[nodiscard]] const SlipEstimate& seen() const { return seen_; }

 private:
  std::unique_ptr<Detector> detector_;
  std::deque<SlipEstimate> under_way_;  // in order of time
  SlipEstimate seen_;
};

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

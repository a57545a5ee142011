// A trial in steps, for whoever closes its loop from outside, and its parts: sampler, delayed detector, control loop, recorder, judge.
// run_trial() is all of it at once.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "controllers/controller_kinds.h"
#include "sim/core/contact_frame.h"
#include "sim/core/controller.h"
#include "sim/core/detector.h"
#include "sim/core/sensor.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

// What closes the loop around a simulation: a detector that reads a sensor, a controller that reads the gripper and commands it
// and the arm.

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
      const FramePart part = pads_[pad].reads() ? FramePart::felt : FramePart::states;
      const ContactFrame& truth = simulation_.contact_part(pad, part);
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
    std::size_t felt_stride;              // ticks between two that the sensor reads or feels
    std::size_t tick = 0;                 // the next one
    const SensorFrame* latest = nullptr;  // the sensor's own

    // Whether the sensor reads or feels the next tick, and the sample that this completes; null: none.
    [[nodiscard]] bool reads() const { return tick % felt_stride == 0; }
    const SensorFrame* measure(const ContactFrame& truth) {
      const bool due = reads();
      const std::size_t now = tick++;
      if (!due) return nullptr;
      if (sampling.completes_at(now)) return latest = &sensor->measure(truth);
      if (felt_stride == sampling.stride || sampling.reads_at(now)) {
        sensor->measure(truth);
      } else {
        sensor->feel(truth);
      }
      return nullptr;
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
  // they begin. `answers`: which of the controller's tightenings count.
  explicit ControlLoop(std::optional<DelayedDetector> detector = {}, std::size_t pad = 0,
                       std::unique_ptr<Controller> controller = nullptr, HeldBox* box = nullptr,
                       Answers answers = Answers::by_own_rule);

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
  // The latest write that closes the fingers further than they were measured and commanded before,
  // and that may answer a slip.
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
  Answers answers_;
  std::vector<SampleListener*> listeners_;  // of the detector and the controller; usually none
  SensorFrame frame_;
  ControlInput input_;
  GripCommand command_, written_;
  ArmCommand arm_command_;
  Tightening tightening_;
  std::size_t acted_ = 0;  // ticks of this instant that act_or_wait() has done
};

// Writes a trial's columns. It listens and never speaks: nothing it does can reach the run.

// Bytes that the columns of a trial's whole record take in memory. Its events, whose number the trial decides, come on top.
double record_bytes(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                    const Sampler& sampler);

// A trial is recorded in memory before it is written. Throws SceneValueError when `bytes` are more than `max_bytes`.
void check_record_size(const Scene& scene, double bytes, double max_bytes);

// A record without columns: what is known of the trial before its first step.
TrialRecord new_record(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                       std::uint64_t trial);

// Columns are allocated whole before the run; a sample is written in place. Bodies are recorded with the samples of the fastest sensor that
// follows no other one's pad.
class Recorder {
 public:
  // Columns go into `record`, which must be that of new_record(). `box`: the grasp's; null: the scene is none. All must outlive the
  // recorder. Throws SceneValueError when the record would take more than `max_bytes`.
  Recorder(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation, const HeldBox* box,
           const Sampler& sampler, double max_bytes, TrialRecord& record);

  // Once every instant, after the loop has acted: the ticks at it. Throws SceneValueError when the events outgrow `max_bytes`.
  void record(std::span<const Tick> ticks, const ControlLoop& loop);

 private:
  void write_events(std::size_t pad, const std::vector<ContactEvent>& events);
  void write_sample(std::size_t pad, std::size_t row, const SensorFrame& frame);
  void write_labels(std::size_t pad, std::size_t row, const ContactFrame& truth);
  void write_bodies(std::size_t row, double time);
  void write_control(double time, const ControlLoop& loop);

  const Scene& scene_;
  std::span<const std::unique_ptr<Sensor>> sensors_;
  const Simulation& simulation_;
  const HeldBox* box_;
  double max_bytes_;
  double bytes_;                   // that the record takes so far
  std::size_t body_pad_;           // with whose samples bodies are recorded
  std::vector<std::size_t> rows_;  // samples written so far, by pad
  TrialRecord& record_;
};

// Whether a trial stayed within what a double, and the float of a dataset, can hold.
// Each throws InputError that names what is not finite and when. A margin must be finite while its unit touches; directions and
// centres of slip may be undefined at any time.

// Every column of a whole record: the earliest row that is not finite.
void check_finite(const TrialRecord& record);
// One tick of the pad of the sensor called `sensor`.
void check_finite(const std::string& sensor, const ContactFrame& truth);
// One sample of it.
void check_finite(const std::string& sensor, const std::vector<Channel>& channels, const SensorFrame& frame);
// The bodies at `time` [s].
void check_finite(double time, const std::vector<NamedBody>& bodies);

// The bodies of a scene's `hold`, as indices into Simulation::bodies().
struct HoldBodies {
  std::size_t body, against;
};

// Empty where the scene has no `hold`. Throws SceneValueError at hold.body and hold.against for a name that no body has, which a dataset
// would record, and at hold.from where fewer than two ticks are left from then on.
std::optional<HoldBodies> hold_bodies(const Scene& scene, const Simulation& simulation);

// A sensor that follows another one's pad has figures of its units, and none in the outcome.
class Judge {
 public:
  // Figures go into `result`: outcome, units, state counts, confusion and onset times; its record must be that of new_record().
  // `box`: the grasp's; null: the scene is none. All must outlive the judge.
  Judge(const Scene& scene, const Simulation& simulation, const HeldBox* box, TrialResult& result);

  // Once every instant, after the loop has acted: the ticks at it.
  void observe(std::span<const Tick> ticks, const ControlLoop& loop) {
    for (const Tick& tick : ticks) {
      const ContactFrame& truth = simulation_.contact_part(tick.pad, FramePart::states);
      const bool detected = loop.has_detector() && tick.pad == loop.pad();
      if (watches_ && tick.pad == 0) watch(truth, loop);
      if (!truth.events.empty()) note_events(tick.pad, truth, detected);
      if (truth.state == PadState::gross && !(outcome_.gross_slip_time <= truth.time)) note_gross_slip(tick.pad, truth);
      if (tick.sample != nullptr) count_states(result_.record.sensors[tick.pad].labels, truth);
      if (detected) judge_detection(tick, truth, loop.seen());
    }
  }
  // At the trial's end: what only the last tick tells.
  void finish(std::span<const std::unique_ptr<Sensor>> sensors);

 private:
  [[nodiscard]] bool follows(std::size_t pad) const { return !scene_.sensors[pad].follows.empty(); }
  [[nodiscard]] bool has_one_unit(std::size_t pad) const { return result_.units[pad].size() == 1; }
  // s, from when on slip is what the loop is judged by.
  [[nodiscard]] double judged_from() const {
    return box_ != nullptr ? box_->lift_start() : -std::numeric_limits<double>::infinity();
  }
  static void count_states(LabelRecord& labels, const ContactFrame& truth) {
    ++labels.state_count[static_cast<std::size_t>(truth.state)];
    ++labels.state_micro_count[static_cast<std::size_t>(truth.state_micro)];
  }
  void note_events(std::size_t pad, const ContactFrame& truth, bool detected);
  void note_gross_slip(std::size_t pad, const ContactFrame& truth);
  void judge_detection(const Tick& tick, const ContactFrame& truth, PadState seen);
  void watch(const ContactFrame& truth, const ControlLoop& loop);
  void judge_grasp(const ContactFrame& truth, const ControlLoop::Tightening& tightening);
  void judge_turn();
  // The origin of the body of `hold` in the frame of what holds it [m]: a hand that turns with what it holds does not move it.
  [[nodiscard]] Eigen::Vector3d held_at() const;

  const Scene& scene_;
  const Simulation& simulation_;
  const HeldBox* box_;
  std::optional<HoldBodies> hold_;
  bool watches_;                              // whether bodies are looked at in each tick
  std::optional<Eigen::Vector3d> held_from_;  // m, held_at() at the first tick of which `hold` asks
  TrialResult& result_;
  TrialOutcome& outcome_;
  double slip_tick_ =
      std::numeric_limits<double>::quiet_NaN();  // s, first tick of a grasp's lift at which a unit of its pad slips
  double any_slip_onset_ = std::numeric_limits<
      double>::quiet_NaN();  // s, when a first unit of the detector's pad slips as a whole, also before a lift
};

class TrialRun {
 public:
  // As run_trial(). `controller`, of a grasp alone: makes the one that stands in the place of the scene's.
  using ControllerInPlace = std::function<std::unique_ptr<Controller>(const GripSource& source)>;
  TrialRun(Scene scene, std::uint64_t trial, Recording recording, double max_bytes, const std::atomic<bool>* interrupt,
           const ControllerInPlace& controller = {});
  ~TrialRun() = default;
  TrialRun(const TrialRun&) = delete;
  TrialRun& operator=(const TrialRun&) = delete;

  [[nodiscard]] bool finished() const { return sampler_.finished(); }
  // Goes to the next instant at which a pad has a tick, lets the loop act and records. Returns the ticks at that instant, in the order of
  // pads, which stay until the next call. Throws as run_trial().
  std::span<const Tick> step();
  // All of it. Throws as run_trial().
  void run() {
    while (!finished()) step();
  }
  // For a grasp whose commands come from outside: to the next instant at which a pad has a tick; true where loop().awaiting() asks for a command
  // at that instant. Then loop().command() is to be called, and this again, which goes on at the same instant. Throws as run_trial().
  bool step_or_wait();
  // Once, at the end, or before it where nobody wants the rest.
  TrialResult finish();

  [[nodiscard]] ControlLoop& loop() { return loop_; }
  [[nodiscard]] const Simulation& simulation() const { return *simulation_; }
  [[nodiscard]] HeldBox* box() { return simulation_->held_box(); }  // null: the scene is no grasp
  [[nodiscard]] std::span<const std::unique_ptr<Sensor>> sensors() const { return sensors_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  // To the next instant; what is at it is handed to the loop.
  std::span<const Tick> advance();
  void observe(std::span<const Tick> ticks);

  Scene scene_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::unique_ptr<Simulation> simulation_;
  TrialResult result_;
  Sampler sampler_;
  Judge judge_;
  std::optional<Recorder> recorder_;
  ControlLoop loop_;
  const std::atomic<bool>* interrupt_;
  std::size_t steps_ = 0;
  std::span<const Tick> ticks_;  // at which a command is waited for
  bool waits_ = false;
};

}  // namespace slipbench

// Runs a trial step by step, for callers that close its loop themselves, and its parts: sampler,
// delayed detector, control loop, recorder, judge. run_trial() runs it at once.
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
#include "sim/api/contact_frame.h"
#include "sim/api/controller.h"
#include "sim/api/detector.h"
#include "sim/api/sensor.h"
#include "sim/api/simulation.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/trial/run_trial.h"

namespace slipbench {

// Closes the loop around a simulation: a detector reads a sensor; a controller reads the gripper
// and commands gripper and arm.

// Ticks at which a pad's sensor reads the contact, and at which a sample is complete. Ticks are the
// pad's own (simulation.h).
struct Sampling {
  std::size_t stride = 1;  // ticks between two readings
  std::size_t scans = 1;   // readings per sample (Sensor::scans)

  [[nodiscard]] bool reads_at(std::size_t tick) const { return tick % stride == 0; }
  [[nodiscard]] bool completes_at(std::size_t tick) const { return tick % ticks() == (scans - 1) * stride; }
  // Ticks between successive samples.
  [[nodiscard]] std::size_t ticks() const { return stride * scans; }
  // Complete samples in a trial of `trial_ticks` ticks.
  [[nodiscard]] std::size_t samples(std::size_t trial_ticks) const { return ((trial_ticks + stride - 1) / stride) / scans; }
};

// A pad's tick as seen by the loop, without the truth.
struct Tick {
  std::size_t pad = 0;
  double time = 0.0;                    // s
  const SensorFrame* sample = nullptr;  // completed by the tick; null: none. Valid until the sensor is read again
};

// Reads a trial's sensors at their times.
class Sampler {
 public:
  // All arguments must outlive the sampler. Throws SceneValueError if the trial ends before a
  // sensor's first sample is complete; std::logic_error if a sensor needs element_truth that the
  // simulation's frames lack.
  Sampler(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation);

  // True after the last tick of every pad.
  [[nodiscard]] bool finished() const { return remaining_ == 0; }
  // Call once after every step. Returns the ticks at that instant, in the order of pads, after
  // reading every sensor that is due. Valid until the next call.
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

  // Number of samples of the pad's sensor in the trial.
  [[nodiscard]] std::size_t samples(std::size_t pad) const { return pads_[pad].sampling.samples(simulation_.ticks(pad)); }
  // The latest sample of the pad's sensor, valid after the first; includes partial readings of the
  // next sample.
  [[nodiscard]] const SensorFrame& latest(std::size_t pad) const { return *pads_[pad].latest; }

 private:
  struct Pad {
    Sensor* sensor;
    Sampling sampling;
    std::size_t felt_stride;              // ticks between reads or feels of the sensor
    std::size_t tick = 0;                 // index of the next tick
    const SensorFrame* latest = nullptr;  // owned by the sensor

    // reads(): true if the sensor reads or feels the next tick. measure() returns the sample that
    // the tick completes; null: none.
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
  std::vector<Tick> ticks_;    // one per pad
  std::size_t remaining_ = 0;  // remaining ticks of all pads
};

// A detector within a trial: estimates become visible after their latency.
class DelayedDetector {
 public:
  explicit DelayedDetector(std::unique_ptr<Detector> detector) : detector_(std::move(detector)) {}

  [[nodiscard]] const std::vector<Feature>& features() const { return detector_->features(); }
  [[nodiscard]] SampleListener* listener() { return detector_->listener(); }
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
  // which must outlive the loop; null: the scene is not a grasp. `controller`, for grasps
  // only; null: the gripper is neither read nor written, and the fingers keep their initial position.
  // `answers`: the closing commands of the controller that count as answers.
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

// Records a trial's columns. It only observes and cannot affect the run.

// Memory of the columns of a trial's full record [bytes], without its events, whose number depends
// on the trial.
double record_bytes(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                    const Sampler& sampler);

// Throws SceneValueError if `bytes` exceed `max_bytes`: a trial is recorded in memory before it is
// written.
void check_record_size(const Scene& scene, double bytes, double max_bytes);

// A record without columns, with all that is known before the first step.
TrialRecord new_record(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                       std::uint64_t trial);

// Allocates all columns before the run and writes samples in place. Bodies are recorded at the
// samples of the fastest sensor with its own pad.
class Recorder {
 public:
  // Writes columns to `record`, which must come from new_record(). `box`: the grasp's; null: the
  // scene is not a grasp. All arguments must outlive the recorder. Throws SceneValueError if the
  // record would exceed `max_bytes`.
  Recorder(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation, const HeldBox* box,
           const Sampler& sampler, double max_bytes, TrialRecord& record);

  // Call once per instant, after the loop has acted, with its ticks. Throws SceneValueError if the
  // events exceed `max_bytes`.
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
  double bytes_;                   // size of the record so far
  std::size_t body_pad_;           // pad whose samples determine the bodies' times
  std::vector<std::size_t> rows_;  // samples written so far, by pad
  TrialRecord& record_;
};

// Checks that a trial's values are finite as doubles and as a dataset's floats. Each function
// throws InputError that names the value and its time. A margin must be finite in
// contact; directions and centres of slip may be undefined at any time.

// Checks every column of a full record and reports the earliest row that is not finite.
void check_finite(const TrialRecord& record);
// Checks one tick of the pad of sensor `sensor`.
void check_finite(const std::string& sensor, const ContactFrame& truth);
// Checks one of its samples.
void check_finite(const std::string& sensor, const std::vector<Channel>& channels, const SensorFrame& frame);
// Checks the bodies at `time` [s].
void check_finite(double time, const std::vector<NamedBody>& bodies);

// The bodies of a scene's `hold`, as indices into Simulation::bodies().
struct HoldBodies {
  std::size_t body, against;
};

// Empty if the scene has no `hold`. Throws SceneValueError at hold.body and hold.against for an
// unknown body name, and at hold.from if fewer than two ticks remain from then on.
std::optional<HoldBodies> hold_bodies(const Scene& scene, const Simulation& simulation);

// Computes the outcome of a trial. A sensor that follows another's pad has unit outcomes but does
// not count in the trial's outcome.
class Judge {
 public:
  // Writes outcome, units, state counts, confusion and onset times to `result`, whose record must
  // come from new_record(). `box`: the grasp's; null: the scene is not a grasp. All arguments must
  // outlive the judge.
  Judge(const Scene& scene, const Simulation& simulation, const HeldBox* box, TrialResult& result);

  // Call once per instant, after the loop has acted, with its ticks.
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
  // Call at the trial's end; evaluates the last tick.
  void finish(std::span<const std::unique_ptr<Sensor>> sensors);

 private:
  [[nodiscard]] bool follows(std::size_t pad) const { return !scene_.sensors[pad].follows.empty(); }
  [[nodiscard]] bool has_one_unit(std::size_t pad) const { return result_.units[pad].size() == 1; }
  // s, from which slip counts for the loop.
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
  // Position of the body of `hold` in the frame of its holder [m], so that a turning hand does not
  // move it.
  [[nodiscard]] Eigen::Vector3d held_at() const;

  const Scene& scene_;
  const Simulation& simulation_;
  const HeldBox* box_;
  std::optional<HoldBodies> hold_;
  bool watches_;                              // bodies are evaluated at each tick
  std::optional<Eigen::Vector3d> held_from_;  // m, held_at() at the first tick from hold.from on
  TrialResult& result_;
  TrialOutcome& outcome_;
  double slip_tick_ =
      std::numeric_limits<double>::quiet_NaN();  // s, first tick of a grasp's lift with a slipping unit of its pad
  double any_slip_onset_ = std::numeric_limits<
      double>::quiet_NaN();  // s, when a first unit of the detector's pad slips as a whole, also before a lift
};

class TrialRun {
 public:
  // Arguments as for run_trial(). `controller`, for grasps only: creates a replacement of the
  // scene's controller.
  using ControllerInPlace = std::function<std::unique_ptr<Controller>(const GripSource& source)>;
  TrialRun(Scene scene, std::uint64_t trial, Recording recording, double max_bytes, const std::atomic<bool>* interrupt,
           const ControllerInPlace& controller = {});
  ~TrialRun() = default;
  TrialRun(const TrialRun&) = delete;
  TrialRun& operator=(const TrialRun&) = delete;

  [[nodiscard]] bool finished() const { return sampler_.finished(); }
  // Advances to the next instant at which a pad has a tick, lets the loop act and records. Returns
  // the ticks at that instant, in the order of pads, valid until the next call. Throws as
  // run_trial().
  std::span<const Tick> step();
  // Runs the whole trial. Throws as run_trial().
  void run();
  // For a grasp commanded from outside: advances to the next instant at which a pad has a tick.
  // Returns true if loop().awaiting() needs a command at that instant: then call loop().command()
  // and this function again, which continues at the same instant. Throws as run_trial().
  bool step_or_wait();
  // Call once, at the end or earlier to skip the rest.
  TrialResult finish();

  [[nodiscard]] ControlLoop& loop() { return loop_; }
  [[nodiscard]] const Simulation& simulation() const { return *simulation_; }
  // The gripper and its box; null if the simulation has none.
  [[nodiscard]] HeldBox* box() { return dynamic_cast<HeldBox*>(simulation_.get()); }
  [[nodiscard]] std::span<const std::unique_ptr<Sensor>> sensors() const { return sensors_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  // Advances to the next instant and passes its ticks to the loop.
  std::span<const Tick> advance();
  void observe(std::span<const Tick> ticks);
  // Body of step(), inlined into run().
  std::span<const Tick> next();

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
  std::span<const Tick> ticks_;  // ticks that wait for a command
  bool waits_ = false;
};

}  // namespace slipbench

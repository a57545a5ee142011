// A trial in steps, for whoever closes its loop from outside. run_trial() is all of it at once.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "controllers/controller_kinds.h"
#include "sim/core/contact_frame.h"
#include "sim/core/controller.h"
#include "sim/core/sensor.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/run/control_loop.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

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

// What became of a trial: its outcome figures, from the truth and from what the loop did.

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
      const ContactFrame& truth = simulation_.contact(tick.pad);
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
  // All of it. Throws as run_trial().
  void run();
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

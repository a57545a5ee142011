// Listens to a trial and keeps what a dataset needs. It never speaks: nothing it does can reach the run.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/core/sensor.h"
#include "sim/grasp/held_box.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tools/base/dataset/trial_record.h"
#include "tools/program/run/grip_loop.h"
#include "tools/program/run/run_trial.h"
#include "tools/program/run/sampling.h"

namespace slipbench {

// Bytes that the columns of a trial's whole record take in memory. Its events, whose number the trial decides, come on top.
double record_bytes(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation);

// A trial is recorded in memory before it is written. Throws SceneValueError when `bytes` are more than `max_bytes`.
void check_record_size(const Scene& scene, double bytes, double max_bytes);

// Columns are allocated whole before the run; a sample is written in place. A sensor that follows another one's pad says nothing of the
// outcome, nor how often bodies are recorded.
class TrialRecorder {
 public:
  // All must outlive the recorder. Throws SceneValueError when the record would take more than `max_bytes`, or the trial ends before a
  // sensor's first sample is complete; std::logic_error when a sensor asks for element_truth and the bench's frames do not carry it.
  TrialRecorder(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation,
                std::uint64_t trial, Recording recording, double max_bytes);

  // When the pad's sensor reads and samples.
  [[nodiscard]] const Sampling& sampling(std::size_t pad) const { return sampling_[pad]; }

  // Called at every tick of a pad, in order of time: events and onsets. Throws SceneValueError when the events outgrow the record's limit.
  void observe(std::size_t pad, const ContactFrame& truth) {
    if (!truth.events.empty()) note_events(pad, truth);
    if (truth.state == PadState::gross && !all_slipped_[pad]) note_gross_slip(pad, truth);
  }
  // Called when a sample of the pad's sensor is complete.
  void sample(std::size_t pad, const ContactFrame& truth, const SensorFrame& frame) {
    LabelRecord& labels = record_.sensors[pad].labels;
    ++labels.state_count[static_cast<std::size_t>(truth.state)];
    ++labels.state_micro_count[static_cast<std::size_t>(truth.state_micro)];
    last_[pad] = frame;
    if (recording_ == Recording::full) write_sample(pad, truth, frame);
  }
  // Called at every tick of the pad whose sensor the scene's detector or controller reads, after its sample: its truth, and what the loop
  // sees.
  void loop(std::size_t tick, const ContactFrame& truth, PadState seen);
  // Called at every tick of the first sensor's pad in a grasp, before loop(): its truth, the box, and what the loop has done.
  void grip(const ContactFrame& truth, const HeldBox& box, const GripLoop& loop);
  // Called with loop() in a grasp.
  void grip_row(std::size_t tick, const HeldBox& box, const GripLoop& loop);
  // Called at every tick of a pad.
  void bodies(std::size_t pad, std::size_t tick, double time, const std::vector<NamedBody>& bodies) {
    if (pad != body_pad_ || recording_ != Recording::full) return;
    if (sampling_[pad].completes_at(tick)) write_bodies(time, bodies);
  }

  // The result; the recorder is spent. Throws InputError as run_trial does.
  TrialResult finish();

 private:
  [[nodiscard]] bool follows(std::size_t pad) const { return !scene_.sensors[pad].follows.empty(); }
  void allocate();
  void note_events(std::size_t pad, const ContactFrame& truth);
  void note_gross_slip(std::size_t pad, const ContactFrame& truth);
  void write_sample(std::size_t pad, const ContactFrame& truth, const SensorFrame& frame);
  static void note_turn(const GraspTruth& now, GraspOutcome& grasp);
  void write_bodies(double time, const std::vector<NamedBody>& bodies);

  const Scene& scene_;
  std::span<const std::unique_ptr<Sensor>> sensors_;
  const Simulation& simulation_;
  Recording recording_;
  double max_bytes_;
  double bytes_ = 0.0;              // that the record takes so far
  std::vector<Sampling> sampling_;  // by pad
  std::size_t body_pad_ = 0;        // with whose samples bodies are recorded
  std::size_t body_row_ = 0;
  double lift_start_ = -std::numeric_limits<double>::infinity();  // s, of a grasp
  double true_slip_ =
      std::numeric_limits<double>::quiet_NaN();  // s, first tick of a grasp's lift at which a unit of its pad slips
  double slip_began_ = std::numeric_limits<double>::quiet_NaN();  // s, a first unit of the detector's pad slips as a whole
  std::vector<std::uint8_t> all_slipped_;                         // by pad: all of its touching units have slipped
  std::vector<std::size_t> rows_;                                 // samples written so far, by pad
  TrialRecord record_;
  std::vector<std::vector<UnitOutcome>> units_;
  std::vector<SensorFrame> last_;  // by pad; the values are the sensor's own
};

}  // namespace slipbench

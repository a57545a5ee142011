// Records a trial's columns. It only observes and cannot affect the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/sensor.h"
#include "sim/api/sensor_frame.h"
#include "sim/api/simulation.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/trial/control_loop.h"
#include "tools/trial/sampler.h"

namespace slipbench {

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

}  // namespace slipbench

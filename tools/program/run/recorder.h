// Writes a trial's columns. It listens and never speaks: nothing it does can reach the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/core/sensor.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/run/control_loop.h"

namespace slipbench {

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

}  // namespace slipbench

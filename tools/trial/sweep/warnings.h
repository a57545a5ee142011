// Warnings about scenes that are valid but hardly intended, and about misleading figures; shown
// with the results, on the terminal, in the JSON and in the report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/dataset/record/json.h"
#include "tools/statistics/confusion.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

struct Warning {
  std::string about;  // a key of the scene ("motion.start"), or a sensor's converter ("sensors.pad.electronics")
  std::string text;   // for users, with the position if known: "stage.yaml:14: motion.start 5 s is not before ..."

  friend bool operator==(const Warning&, const Warning&) = default;
};

// Warnings about the trials `numbers` of the plan, from an evenly spaced subset. There is one
// warning per key; if later trials share it, its text counts them. A trial that cannot be read or
// built causes no warning: running it reports the reason. Warns of:
// - a motion that starts at or after the end of the trial
// - a unit of a pad on a stage whose compression exceeds its height
// - a texture that the points of a unit cancel, so that the unit reads a harmonic, or that they do
//   not resolve (unit_sampling.h)
// - a speed of more than 1 m/s without a unit
// - a mass below 1 mg or above 1 t; a length below 1 um or above 10 m of a body, the surface, the
//   box, the grip or the motion
// - a material from --set together with coefficients of friction in the scene, which override it
// - with `build`, which reads the files that the scene names: a step of `time_step: auto` so short
//   that a trial would take more than ten minutes
std::vector<Warning> scene_warnings(const TrialPlan& plan, std::span<const std::size_t> numbers, bool build);
// Warns if a dataset of these trials would have an empty part that should not be empty: too few
// materials, or other groups of its `split`. Examines an evenly spaced subset of many trials.
std::vector<Warning> split_warnings(const TrialPlan& plan, std::span<const std::size_t> numbers);

// All warnings of the trials that `sweep` would run, built; split warnings if it writes a dataset.
// `read`: its read_sweep().
std::vector<Warning> scene_warnings(const ReadSweep& read, const SweepOptions& sweep);

// Number of samples in which a sensor had a value beyond its range.
struct ConverterUse {
  std::uint64_t at_an_end = 0;  // samples
  std::uint64_t samples = 0;
};

// Adds those of a recorded trial, by the sensor's name.
void count_converters(const TrialRecord& record, std::map<std::string, ConverterUse>& sensors);

// One warning for each sensor, by name, whose converter is at a limit in more than half of all
// samples.
std::vector<Warning> converter_warnings(const std::map<std::string, ConverterUse>& sensors);

// Those of finished trials, and one for each notice of their detectors (DetectorSummary::notice).
std::vector<Warning> trial_warnings(const std::vector<TrialSummary>& trials);

// [{"about": ..., "text": ...}]
Json warnings_json(const std::vector<Warning>& warnings);

// A trial as an element of `trials` in the JSON object of `--json`, and the rest of that object.
std::string trial_json(const TrialSummary& trial);
std::string summary_json(const SweepSummary& summary);

// Scores of one type of detector over all its trials. `seen`, `early` and the like as in Detection.
struct DetectorScore {
  std::string type;  // "force_ratio"
  std::size_t trials = 0;
  std::size_t slipping = 0;      // trials with slip to be detected: seen + early + missed
  std::size_t early = 0;         // of these, with an alarm before the slip
  std::size_t missed = 0;        // of these, without an alarm
  std::size_t false_alarms = 0;  // trials without slip that have an alarm
  std::vector<double> delays;    // s, of the seen trials, in order
  Confusion confusion{};         // samples of all trials

  [[nodiscard]] std::size_t seen() const { return delays.size(); }
};

// In order of each type's first trial; omits trials without a detector and failed trials.
std::vector<DetectorScore> detector_scores(const std::vector<TrialSummary>& trials);

}  // namespace slipbench

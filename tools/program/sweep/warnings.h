// What a scene may say and is hardly meant, and figures that mislead: told beside the results, on the terminal, in the JSON and in
// the report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/base/record/json.h"
#include "tools/base/statistics/confusion.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

struct Warning {
  std::string about;  // a key of the scene ("motion.start"), or a sensor's converter ("sensors.pad.electronics")
  std::string text;   // for a person, with its place where it has one: "stage.yaml:14: motion.start 5 s is not before ..."

  friend bool operator==(const Warning&, const Warning&) = default;
};

// Of what the trials `numbers` of the plan say, some of which are looked at, spread evenly. One for each key; where a later trial has
// it too, its text counts them. A trial that cannot be read or built warns of nothing: running it says why.
//   a motion that starts at or after the end of the trial
//   a unit of a pad on a stage that is pressed farther than it is high
// a texture that the points of a unit cancel, so that the unit reads a harmonic, or that they do
// not resolve (unit_sampling.h)
//   a speed of more than 1 m/s without a unit
//   a mass below 1 mg or above 1 t; a length below 1 um or above 10 m of a body, the surface, the box, the grip or the motion
//   a material that --set gives beside coefficients of friction in the scene, which replace it
//   with `build`, which reads the files that the scene names: a step that `time_step: auto` makes so short that a trial would take
//   more than ten minutes
std::vector<Warning> scene_warnings(const TrialPlan& plan, std::span<const std::size_t> numbers, bool build);
// Where a dataset of these trials has a part without a trial that should have some: too few materials, or what else its `split`
// names. Of many trials some are looked at, spread evenly.
std::vector<Warning> split_warnings(const TrialPlan& plan, std::span<const std::size_t> numbers);

// All of these of the trials that `sweep` would run, built; those of the split where it writes a dataset. `read`: its read_sweep().
std::vector<Warning> scene_warnings(const ReadSweep& read, const SweepOptions& sweep);

// How often a sensor had a value beyond its range.
struct ConverterUse {
  std::uint64_t at_an_end = 0;  // samples
  std::uint64_t samples = 0;
};

// Adds a recorded trial's, by the sensor's name.
void count_converters(const TrialRecord& record, std::map<std::string, ConverterUse>& sensors);

// A warning for each sensor, by name, whose converter is at an end in more than half of all samples.
std::vector<Warning> converter_warnings(const std::map<std::string, ConverterUse>& sensors);

// The same of finished trials.
std::vector<Warning> converter_warnings(const std::vector<TrialSummary>& trials);

// [{"about": ..., "text": ...}]
Json warnings_json(const std::vector<Warning>& warnings);

// A trial as an element of `trials` in the one JSON object of `--json`, and the rest of that object.
std::string trial_json(const TrialSummary& trial);
std::string summary_json(const SweepSummary& summary);

// Of all trials with one type of detector. What `seen`, `early` and the like are: Detection.
struct DetectorScore {
  std::string type;  // "force_ratio"
  std::size_t trials = 0;
  std::size_t slipping = 0;      // trials with slip to be judged by: seen + early + missed
  std::size_t early = 0;         // of these, an alarm came before the slip
  std::size_t missed = 0;        // of these, none came
  std::size_t false_alarms = 0;  // of the trials without slip
  std::vector<double> delays;    // s, of those seen, in order of the trials
  Confusion confusion{};         // of the samples of all

  [[nodiscard]] std::size_t seen() const { return delays.size(); }
};

// In order of each type's first trial; none of trials that have no detector or failed.
std::vector<DetectorScore> detector_scores(const std::vector<TrialSummary>& trials);

}  // namespace slipbench

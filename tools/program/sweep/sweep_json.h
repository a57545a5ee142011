// A sweep as numbers for programs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/statistics/confusion.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

// A trial as an element of `trials` in the one JSON object of `--json`, and the rest of that object.
std::string trial_json(const TrialSummary& trial);
std::string summary_json(const SweepSummary& summary);

// How the detectors of a run did over its trials.

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

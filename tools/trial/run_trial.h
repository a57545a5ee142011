// Runs one trial: the inner loop of all commands.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// Recorded part of a trial.
enum class Recording {
  outcome,  // the outcome and the onset times alone
  full,     // every column of a dataset
};

// Outcome of one unit. Times in s, of the first such event; NaN: never.
struct UnitOutcome {
  double touch_time = std::numeric_limits<double>::quiet_NaN();
  double micro_onset_time = std::numeric_limits<double>::quiet_NaN();  // event micro or slip
  double onset_time = std::numeric_limits<double>::quiet_NaN();        // event slip
  // At the last tick:
  float slip_distance = 0.0F;                              // m
  float load = 0.0F;                                       // N, normal, compression positive
  float margin = std::numeric_limits<float>::quiet_NaN();  // NaN while detached
};

// Result of a trial: the record, and the outcome of each unit, which is kept in every recording
// mode.
struct TrialResult {
  TrialRecord record;
  std::vector<std::vector<UnitOutcome>> units;  // [sensor][N]
  // s, shortest step of any pad with its own contact; for bodies that move by forces, their step.
  double time_step = 0.0;
  std::string notice = {};  // Detector::notice(); empty without a detector
};

// Total memory of the trials that are recorded at the same time [bytes].
inline constexpr double max_record_bytes = 4e9;

// Runs trial number `trial` of a dataset whose seed is `scene.seed`. Leaves `params` of the record
// to the caller, who knows the sweep. Throws InputError if the scene cannot be simulated
// (StageSimulation, make_sensor, make_detector), if its full record would exceed `max_bytes`, or if
// a value in the record (without a record: in the last tick) must be finite and is not. Throws
// Interrupted within a few steps after `interrupt`, which may be null, becomes true. Stores the
// simulated share of the trial in `share`, which may be null, every few steps.
TrialResult run_trial(const Scene& scene, std::uint64_t trial, Recording recording, double max_bytes = max_record_bytes,
                      const std::atomic<bool>* interrupt = nullptr, std::atomic<double>* share = nullptr);

// Builds what run_trial() would step, and throws the exceptions that run_trial() would throw before
// the first step, except for the record limit. Returns the size of a full record without its events
// [bytes].
double check_trial(const Scene& scene, std::uint64_t trial);

// The steps of a trial.
struct PlannedSteps {
  double shortest = 0.0;  // s, of any pad
  double count = 0.0;     // of all pads with their own steps
  double seconds = 0.0;   // least total duration, by the step durations on the machine of docs/results/README.md
};

// Builds the trial to count its steps. Throws as check_trial().
PlannedSteps planned_steps(const Scene& scene, std::uint64_t trial);

}  // namespace slipbench

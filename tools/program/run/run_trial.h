// One trial: the loop that everything else serves.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// What is kept of a trial.
enum class Recording {
  outcome,  // the outcome and the onset times alone
  full,     // every column of a dataset
};

// What became of one unit. Times in s are those of the first such event, NaN: never.
struct UnitOutcome {
  double touch_time = std::numeric_limits<double>::quiet_NaN();
  double micro_onset_time = std::numeric_limits<double>::quiet_NaN();  // event micro or slip
  double onset_time = std::numeric_limits<double>::quiet_NaN();        // event slip
  // At the last tick:
  float slip_distance = 0.0F;                              // m
  float load = 0.0F;                                       // N, normal, compression positive
  float margin = std::numeric_limits<float>::quiet_NaN();  // NaN while detached
};

// A trial: the record, and what became of each unit, which is kept in every mode of recording.
struct TrialResult {
  TrialRecord record;
  std::vector<std::vector<UnitOutcome>> units;  // [sensor][N]
  // s, the shortest of any pad that follows no other; of bodies that forces move, theirs.
  double time_step = 0.0;
};

// Memory for all trials that are recorded at a time [bytes].
inline constexpr double max_record_bytes = 4e9;

// Runs trial number `trial` of a dataset whose seed is `scene.seed`. `params` of the record is left to the caller, who knows the
// sweep. Throws InputError when the scene cannot be simulated as it says (StageSimulation, make_sensor, make_detector), when its
// full record would take more than `max_bytes`, or when something in the record (without one: in the last tick) is not finite
// that must be. Throws Interrupted within a few steps once `interrupt` is true; it may be null.
TrialResult run_trial(const Scene& scene, std::uint64_t trial, Recording recording, double max_bytes = max_record_bytes,
                      const std::atomic<bool>* interrupt = nullptr);

// The share of its trial that the run which has looked for an interrupt last has simulated: of the only one, where there is one at a time.
double simulated_share();

// Builds what run_trial would step, and throws what it would throw before the first step, but for a record over the limit:
// returns the bytes that a full one would take, its events aside.
double check_trial(const Scene& scene, std::uint64_t trial);

// The steps of a trial.
struct PlannedSteps {
  double shortest = 0.0;  // s, of any pad's
  double count = 0.0;     // of all pads that step by themselves
  double seconds = 0.0;   // what they take at the least, by what a step took on the machine of RESULTS.md
};

// Builds the trial to see. Throws as check_trial.
PlannedSteps planned_steps(const Scene& scene, std::uint64_t trial);

}  // namespace slipbench

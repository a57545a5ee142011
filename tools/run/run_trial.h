// One trial: the loop that everything else serves.
#pragma once

#include <cstdint>

#include "sim/scene/scene.h"
#include "tools/dataset/trial_record.h"

namespace slipbench {

// What is kept of a trial.
enum class Recording {
  outcome,  // the outcome and the onset times alone
  full,     // every column of a dataset
};

// Runs trial number `trial` of a dataset whose seed is `scene.seed`. `params` of the record is left to the caller, who knows the
// sweep. Throws InputError when the scene cannot be simulated as it says (Testbench, make_sensor).
TrialRecord run_trial(const Scene& scene, std::uint64_t trial, Recording recording);

// Builds what run_trial would step, and throws what it would throw before the first step.
void check_trial(const Scene& scene, std::uint64_t trial);

}  // namespace slipbench

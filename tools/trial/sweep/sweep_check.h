// Checks the trials of a sweep before the first one runs.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

// Number of workers, and memory limit of each one's record.
struct WorkerLimits {
  std::size_t workers = 1;
  double max_bytes = max_record_bytes;
};

// Builds the first trial of every grid cell (of a shard, of every cell in which it has trials; other
// machines check the others), or the only trial, so that a contradictory scene, or one whose records
// exceed the memory, is rejected before anything is written. Throws InputError for such a scene.
// Adds the files that these trials name to `files`. `trials`: numbers of the trials to run; `requested`:
// trials of the whole sweep.
//
// Returns as many workers as `options` ask for. By default one per hardware thread, but only as many
// as have memory for twice their record, to allow for events.
WorkerLimits check_cells(const TrialPlan& plan, const SweepOptions& options, const std::vector<std::size_t>& trials,
                         std::size_t requested, const Catalogues& catalogues, std::set<std::string>& files);

}  // namespace slipbench

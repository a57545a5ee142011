#include "tools/trial/sweep/sweep_check.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "sim/core/error.h"
#include "tools/dataset/record/json.h"
#include "tools/trial/sweep/sweep_shard.h"
#include "tools/trial/sweep/trial_workers.h"
#include "tools/trial/trial_run.h"

namespace slipbench {
namespace {

// Further grid cells are checked only when they run.
constexpr std::size_t max_checked_cells = 10'000;

// `bytes`: size of the largest record; 0: nothing is recorded.
WorkerLimits worker_limits(const SweepOptions& options, std::size_t trials, double bytes) {
  double threads = static_cast<double>(std::max(1U, std::thread::hardware_concurrency()));
  if (options.jobs != 0) {
    threads = static_cast<double>(options.jobs);
  } else if (bytes > 0.0) {
    threads = std::clamp(std::floor(max_record_bytes / (2.0 * bytes)), 1.0, threads);
  }
  threads = std::min(threads, static_cast<double>(std::max<std::size_t>(1, trials)));
  return {static_cast<std::size_t>(threads), max_record_bytes / threads};
}

// The trials to check before a run of `trials`: the first of every grid cell, or the only one. For
// a shard, the first of each cell in which it has trials; other machines check the others.
std::vector<std::size_t> checked_trials(const TrialPlan& plan, const SweepOptions& options,
                                        const std::vector<std::size_t>& trials) {
  if (options.only) return {*options.only};
  std::vector<std::size_t> checked;
  if (!options.shard) {
    for (std::size_t index = 0; index < std::min(plan.size(), max_checked_cells * plan.draws()); index += plan.draws())
      checked.push_back(index);
    return checked;
  }
  for (const std::size_t trial : trials) {
    const std::size_t first = trial / plan.draws() * plan.draws();
    if (checked.size() < max_checked_cells && (checked.empty() || checked.back() != first)) checked.push_back(first);
  }
  return checked;
}

// Properties of a trial known before the run.
struct CheckedTrial {
  double bytes = 0.0;              // size of its record
  std::vector<std::string> files;  // files that it names
};

CheckedTrial check_one(const TrialPlan& plan, std::size_t index, std::size_t requested, const Catalogues& catalogues) {
  try {
    const Scene scene = plan.trial(index).scene;
    if (scene.detector) check_run(*scene.detector, requested);
    std::set<std::string> files;
    add_named_files(scene, catalogues, files);
    return {check_trial(scene, index), {files.begin(), files.end()}};
  } catch (const SceneValueError& error) {
    throw InputError(plan.where(index, error.path()) + ": " + error.what());
  } catch (const FailedRun& error) {
    throw InputError(plan.where(index, "time_step") + ": " + error.what());
  }
}

}  // namespace

WorkerLimits check_cells(const TrialPlan& plan, const SweepOptions& options, const std::vector<std::size_t>& trials,
                         std::size_t requested, const Catalogues& catalogues, std::set<std::string>& files) {
  const std::vector<std::size_t> numbers = checked_trials(plan, options, trials);
  const auto check_all = [&] {
    std::set<std::string> named;
    double bytes = 0.0;
    std::size_t largest = numbers.front();
    for (const std::size_t trial : numbers) {
      if (options.interrupt != nullptr && *options.interrupt) break;
      const CheckedTrial checked = check_one(plan, trial, options.only ? trial + 1 : requested, catalogues);
      named.insert(checked.files.begin(), checked.files.end());
      if (recording_of(options) == Recording::outcome || checked.bytes <= bytes) continue;
      largest = trial;
      bytes = checked.bytes;
    }
    return Json{bytes, largest, named}.dump();
  };
  const Json found = Json::parse(run_before_trials(options, numbers.size(), check_all));
  const double bytes = found.at(0);
  const std::size_t largest = found.at(1);
  for (const Json& file : found.at(2)) files.insert(file.get<std::string>());
  const WorkerLimits limits = worker_limits(options, trials.size(), bytes);
  try {
    check_record_size(plan.trial(largest).scene, bytes, limits.max_bytes);
  } catch (const SceneValueError& error) {
    throw InputError(plan.where(largest, error.path()) + ": " + error.what());
  }
  return limits;
}

}  // namespace slipbench

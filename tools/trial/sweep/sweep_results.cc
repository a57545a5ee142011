#include "tools/trial/sweep/sweep_results.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

#include "tools/trial/run_trial.h"

namespace slipbench {
namespace {

// Command that repeats one trial of a sweep.
std::string repeating_command(const SweepOptions& options, std::uint64_t seed, std::size_t trial) {
  SweepOptions run = options;
  run.verb = "run";
  run.recording = Recording::full;
  run.seed = seed;
  run.only = trial;
  run.shard.reset();
  // `run` numbers trials by the scene's own sweep, so their number is set there.
  if (options.trials > 0) run.overrides.push_back({"sweep.trials", std::to_string(std::exchange(run.trials, 0))});
  return canonical_command(run);
}

}  // namespace

SweepResults::SweepResults(const ReadSweep& read, const SweepOptions& options, const SweepQueue& queue,
                           const ProgressCallback& progress)
    : options_(options), progress_(progress) {
  const TrialPlan& plan = read.planned.plan;
  summary_.seed = read.seed;
  summary_.command = canonical_command(options);
  summary_.planned = queue.trials().size();
  summary_.trials.reserve(summary_.planned);  // avoids reallocations, which would fragment the heap
  if (options.shard) summary_.shard = SweepShard{options.shard->number, options.shard->count, read.planned.requested};
  summary_.scene = plan.trial(queue.trials().front()).scene;
  summary_.available = plan.size();
}

const FailedTrial& SweepResults::add_failed(FinishedTrial& trial) {
  const std::size_t number = trial.summary.trial;
  summary_.failed.push_back({number, std::move(trial.failure), repeating_command(options_, summary_.seed, number)});
  return summary_.failed.back();
}

void SweepResults::add(FinishedTrial& trial) {
  summary_.simulated += trial.duration;
  summary_.computed += trial.computed;
  summary_.shortest_step = summary_.longest_step == 0.0 ? trial.time_step : std::min(summary_.shortest_step, trial.time_step);
  summary_.longest_step = std::max(summary_.longest_step, trial.time_step);
  add_summary(trial.summary);
}

void SweepResults::add_summary(TrialSummary& summary) {
  if (summary.resumed) ++summary_.resumed;
  if (options_.on_trial) options_.on_trial(summary);
  if (!options_.keep_units && summary_.planned > 1) {
    for (SensorSummary& sensor : summary.sensors) sensor.units.clear();
  }
  // A copy: memory allocated by a worker would keep the memory around it, ten times as much,
  // allocated.
  summary_.trials.push_back(std::as_const(summary));
}

bool SweepResults::close() {
  summary_.interrupted = done() < summary_.planned;
  // A shard reports failed trials even if it has no others: merging counts them.
  return !summary_.interrupted && (!summary_.trials.empty() || summary_.shard);
}

void SweepResults::report() {
  if (progress_ && done() > reported_) progress_({done(), summary_.planned, summary_.simulated});
  reported_ = done();
}

void SweepResults::report_share(TrialWorkers& workers, const std::atomic<double>& share) const {
  constexpr std::chrono::milliseconds a_while{100};
  while (progress_ && summary_.planned == 1 && !workers.ready_until(std::chrono::steady_clock::now() + a_while))
    progress_({.total = 1, .share = share});
}

}  // namespace slipbench

#include "tools/trial/sweep/sweep_queue.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <numeric>

#include "tools/dataset/record/json.h"
#include "tools/trial/sweep/sweep_shard.h"

namespace slipbench {
namespace {

// Numbers of the trials to run.
std::vector<std::size_t> chosen_trials(const PlannedTrials& planned, const SweepOptions& options, std::uint64_t seed) {
  if (options.shard) {
    const auto chosen = [&] {
      return Json(trials_of_shard(planned.plan, planned.requested, seed, options.shard->number, options.shard->count)).dump();
    };
    return Json::parse(run_before_trials(options, planned.requested, chosen)).get<std::vector<std::size_t>>();
  }
  if (options.only) return {*options.only};
  std::vector<std::size_t> all(planned.requested);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

}  // namespace

SweepQueue::SweepQueue(const ReadSweep& read, const SweepOptions& options)
    : trials_(chosen_trials(read.planned, options, read.seed)) {}

std::vector<std::size_t> SweepQueue::missing() const {
  std::vector<std::size_t> missing;
  std::ranges::copy_if(trials_, std::back_inserter(missing), [&](std::size_t trial) { return !finished_.contains(trial); });
  return missing;
}

std::optional<FinishedTrial> SweepQueue::finished(std::size_t trial) const {
  const auto found = finished_.find(trial);
  return found == finished_.end() ? std::nullopt : std::optional(from_message(found->second));
}

}  // namespace slipbench

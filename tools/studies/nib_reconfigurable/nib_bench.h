// Runs of a scene on the nib pad's lever bench, many at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tools/base/project/project_file.h"
#include "tools/base/workers/interrupt.h"
#include "tools/base/workers/ordered_workers.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/run/run_trial.h"
#include "tools/studies/nib_reconfigurable/nib_trace.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

// What a reproduction changes in a scene beyond its sweep.
using SceneChange = std::function<void(Scene&)>;

// All trials of the project's scene `path`, `draws` of each cell of its sweep, in order: what `reduce` makes of the scene, the full record and
// the trial's number. `what`: named in progress and in errors. Throws InputError of a trial, Interrupted.
template <class Outcome, class Reduce>
std::vector<Outcome> run_lever_scene(const std::string& path, const SceneChange& change, std::size_t draws, std::uint64_t seed,
                                     const ReproduceOptions& options, const std::string& what, Reduce&& reduce) {
  const InterruptGuard guard("ending after the trials at hand");
  const Catalogues catalogues = program_catalogues();
  const SceneFile file = SceneFile::load(project_file(path));
  const TrialPlan plan(file, catalogues, draws, seed);
  const auto one = [&](std::size_t trial) {
    try {
      Scene scene = plan.trial(trial).scene;
      scene.seed = seed;
      change(scene);
      return reduce(scene, run_trial(scene, trial, Recording::full).record, trial);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}, {}, trial {}: {}", path, what, trial, error.what()));
    }
  };
  const std::size_t threads = options.jobs != 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
  OrderedWorkers<Outcome> workers(
      plan.size(), std::min(threads, plan.size()), [&] { return one; }, &InterruptGuard::flag());
  std::vector<Outcome> outcomes;
  for (std::size_t k = 0; k < plan.size(); ++k) {
    if (options.say && k % 50 == 0) options.say(fmt::format("{} ({} of {} trials done)", what, k, plan.size()));
    std::optional<Outcome> outcome = workers.next();
    if (!outcome) throw Interrupted();
    outcomes.push_back(std::move(*outcome));
  }
  return outcomes;
}

}  // namespace slipbench::reproduce

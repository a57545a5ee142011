#include "tools/trial/sweep/run_sweep.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/core/process/interrupted.h"
#include "sim/plugins/plugin_library.h"
#include "sim/scene/scene_reader.h"
#include "tools/dataset/record/json.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/recorded_scene.h"
#include "tools/trial/sweep/sweep_check.h"
#include "tools/trial/sweep/sweep_output.h"
#include "tools/trial/sweep/sweep_queue.h"
#include "tools/trial/sweep/sweep_results.h"
#include "tools/trial/sweep/sweep_shard.h"
#include "tools/trial/sweep/trial_workers.h"
#include "tools/workers/child_process.h"

namespace slipbench {
namespace {

// True if a value for `path` replaces an earlier value for `earlier`. Below `sweep` the rest of a
// path is one key.
bool replaces(const std::string& path, const std::string& earlier) {
  return earlier == path || (earlier.starts_with(path + '.') && !path.starts_with("sweep."));
}

// The effective overrides, in an order in which they can be applied again. A JSON object has each
// key once, so a repeated path is kept at its last position, and earlier values at or below that
// path are removed.
std::string overrides_json(const std::vector<Override>& overrides) {
  std::vector<Override> kept;
  for (const Override& change : overrides) {
    std::erase_if(kept, [&](const Override& earlier) { return replaces(change.path, earlier.path); });
    kept.push_back(change);
  }
  Json json = Json::object();
  for (const Override& change : kept) json[change.path] = change.value;
  return json.dump();
}

// The scene's sweep, with repeated cells until there are at least options.limit trials.
TrialPlan long_enough_plan(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed) {
  TrialPlan plan(file, catalogues, options.trials, seed);
  if (plan.size() >= options.limit) return plan;
  const std::size_t cells = TrialPlan(file, catalogues, 1, seed).size();
  return {file, catalogues, (options.limit + cells - 1) / cells, seed};
}

DatasetHeader header_of(const ReadSweep& read, const SweepOptions& options, const SweepSummary& summary, const HeldFiles& files) {
  return {.version = SLIPBENCH_VERSION,
          .scene = read.file.text(),
          .overrides = overrides_json(options.overrides),
          .seed = read.seed,
          .command = summary.command,
          .split = split_rule(summary.scene),
          .files = files.digests(),
          .part = summary.shard};
}

// Takes the trials in order, from an earlier run or from the workers, to the output and the results.
void run_trials(const SweepQueue& queue, const SweepOptions& options, TrialWorkers& workers, SweepOutput& output,
                SweepResults& results, const std::atomic<double>& share) {
  for (const std::size_t trial : queue.trials()) {
    end_if(options.interrupt);
    if (std::optional<FinishedTrial> resumed = queue.finished(trial)) {
      results.add_resumed(std::move(*resumed));
      results.report();
      continue;
    }
    output.finish_due_batch(workers);
    results.report_share(workers, share);
    std::optional<FinishedTrial> finished = workers.next();
    if (!finished) break;
    if (!finished->failure.empty()) {
      output.add_failed(results.add_failed(*finished));
    } else {
      output.append(*finished);
      results.add(*finished);
    }
    workers.give_back(std::move(*finished));
    results.report();
  }
}

}  // namespace

std::string run_before_trials(const SweepOptions& options, std::size_t trials, const std::function<std::string()>& action) {
  if (!options.isolation.on) return action();
  const double limit = static_cast<double>(trials) * options.isolation.limit;
  const auto check = [&action] {
    keep_plugin_objects();
    return action();
  };
  return run_in_child("before the first trial", check, options.interrupt, limit, options.isolation.fork);
}

void keep_outcome(TrialRecord& record) {
  record.sensors.clear();
  record.body_time.clear();
  record.bodies.clear();
}

std::string params_json(const std::vector<std::pair<std::string, std::string>>& drawn) {
  std::string text = "{";
  for (const auto& [path, value] : drawn) {
    if (text.size() > 1) text += ", ";
    text += Json(path).dump() + ": " + value;  // values are JSON already
  }
  return text + "}";
}

PlannedTrials plan_trials(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed) {
  PlannedTrials planned{long_enough_plan(file, catalogues, options, seed), options.limit};
  if (planned.requested == 0) planned.requested = planned.plan.size();
  if (options.only && *options.only >= planned.requested) {
    reject("{}: no trial {}; allowed: 0 to {}", file.name(), *options.only, planned.requested - 1);
  }
  return planned;
}

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-./=:,+%@").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string canonical_command(const SweepOptions& options) {
  std::string command = fmt::format("slipbench {} {}", options.verb, shell_word(options.scene_path));
  for (const Override& change : options.overrides) command += " --set " + shell_word(change.path + "=" + change.value);
  if (options.seed) command += fmt::format(" --seed {}", *options.seed);
  if (options.trials > 0) command += fmt::format(" --trials {}", options.trials);
  if (options.limit > 1) command += fmt::format(" --trials {}", options.limit);
  if (options.only) command += fmt::format(" --trial {}", *options.only);
  if (options.recording == Recording::outcome) command += " --record outcome";
  if (options.shard) command += shard_words(*options.shard);
  return command;
}

SceneFile scene_file(const SweepOptions& options) {
  SceneFile file =
      options.scene_text ? SceneFile::from_text(*options.scene_text, "<stdin>") : SceneFile::load(options.scene_path);
  for (const Override& change : options.overrides) file.apply(change);
  return file;
}

ReadSweep read_sweep(const SweepOptions& options, const Catalogues& catalogues) {
  SceneFile file = scene_file(options);
  const std::uint64_t seed = options.seed ? *options.seed : read_seed(file.root());
  PlannedTrials planned = plan_trials(file, catalogues, options, seed);
  return {std::move(file), seed, std::move(planned)};
}

SweepSummary run_sweep(const SweepOptions& options, const Catalogues& catalogues, const ProgressCallback& progress) {
  return run_sweep(read_sweep(options, catalogues), options, catalogues, progress);
}

SweepSummary run_sweep(const ReadSweep& read, const SweepOptions& options, const Catalogues& catalogues,
                       const ProgressCallback& progress) {
  const TrialPlan& plan = read.planned.plan;
  SweepQueue queue(read, options);
  SweepResults results(read, options, queue, progress);
  std::set<std::string> named;
  const WorkerLimits limits = check_cells(plan, options, queue.trials(), read.planned.requested, catalogues, named);
  if (options.on_start) options.on_start();
  const HeldFiles files(named);
  SweepOutput output(options, header_of(read, options, results.summary(), files));
  if (!output.open(queue, results.summary())) return results.take_summary();
  try {
    std::atomic<double> share{0.0};  // of a sweep's only trial
    const WorkPlan work{.trials = plan,
                        .seed = read.seed,
                        .recording = recording_of(options),
                        .max_bytes = limits.max_bytes,
                        .interrupt = options.interrupt,
                        .share = queue.missing().size() == 1 ? &share : nullptr};
    try {
      const auto workers = make_workers(queue.missing(), limits.workers, work, options, files);
      run_trials(queue, options, *workers, output, results, share);
    } catch (const Interrupted&) {  // in the first running trial; earlier trials are complete
    }
    const bool whole = results.close();
    output.finish(whole, results.summary());
    results.report();
  } catch (const std::exception& error) {
    output.fail(error, queue.trials().size());
  }
  return results.take_summary();
}

}  // namespace slipbench

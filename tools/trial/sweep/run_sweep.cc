#include "tools/trial/sweep/run_sweep.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/process/interrupted.h"
#include "sim/scene/scene_reader.h"
#include "tools/dataset/finished_dataset.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/json.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/recorded_scene.h"
#include "tools/trial/sweep/finished_trial.h"
#include "tools/trial/sweep/sweep_shard.h"
#include "tools/trial/trial_run.h"
#include "tools/workers/child_process.h"
#include "tools/workers/ordered_children.h"
#include "tools/workers/ordered_workers.h"

namespace slipbench {
namespace {

// Recorded part of a trial; without a dataset, the outcome.
Recording recording_of(const SweepOptions& options) { return options.output.empty() ? Recording::outcome : options.recording; }

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

FinishedTrial failed_trial(std::size_t trial, std::string why) {
  FinishedTrial failed;
  failed.summary.trial = trial;
  failed.failure = std::move(why);
  return failed;
}

TrialSummary summary_of(TrialResult& result) {
  const TrialRecord& record = result.record;
  TrialSummary summary{.trial = record.trial, .params = record.params, .outcome = record.outcome, .sensors = {}, .detector = {}};
  for (std::size_t i = 0; i < record.sensors.size(); ++i) {
    const SensorRecord& sensor = record.sensors[i];
    summary.sensors.push_back(
        {sensor.name, std::move(result.units[i]), sensor.labels.state_count, sensor.labels.state_micro_count});
  }
  if (record.control) summary.controller = record.control->controller;
  if (record.control && !record.control->detector.empty()) {
    summary.detector = {record.control->detector, record.control->sensor, record.control->confusion};
  }
  return summary;
}

// Parameters for running and recording the trials.
struct WorkPlan {
  const TrialPlan& trials;
  std::uint64_t seed = 0;
  Recording recording = Recording::full;
  double max_bytes = max_record_bytes;  // of a trial's record
  const std::atomic<bool>* interrupt = nullptr;
};

FinishedTrial run_one(const WorkPlan& plan, std::size_t index, TrialEncoder* encoder) {
  const InterruptScope scope(plan.interrupt);
  TrialPlan::Trial trial = plan.trials.trial(index);
  trial.scene.seed = plan.seed;
  const auto start = std::chrono::steady_clock::now();
  TrialResult result = run_trial(trial.scene, index, plan.recording, plan.max_bytes, plan.interrupt);
  const std::chrono::duration<double> computed = std::chrono::steady_clock::now() - start;
  result.record.params = params_json(trial.drawn);
  FinishedTrial finished{summary_of(result), trial.scene.duration, computed.count(), result.time_step, std::nullopt};
  if (plan.recording == Recording::outcome) keep_outcome(result.record);
  if (encoder != nullptr) finished.encoded = encoder->encode(result.record);
  return finished;
}

// Further grid cells are checked only when they run.
constexpr std::size_t max_checked_cells = 10'000;

// Number of worker threads, and memory limit of each one's record.
struct Workforce {
  std::size_t threads = 1;
  double max_bytes = max_record_bytes;
};

// As many threads as `options` ask for. By default one per hardware thread, but only as many as
// have memory for twice a record of `bytes` each (0: nothing is recorded), to allow for events.
Workforce workforce_for(const SweepOptions& options, std::size_t trials, double bytes) {
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

CheckedTrial check_one(const TrialPlan& plan, std::size_t index, std::size_t asked, const Catalogues& catalogues) {
  try {
    const Scene scene = plan.trial(index).scene;
    if (scene.detector) check_run(*scene.detector, asked);
    std::set<std::string> files;
    add_named_files(scene, catalogues, files);
    return {check_trial(scene, index), {files.begin(), files.end()}};
  } catch (const SceneValueError& error) {
    throw InputError(plan.where(index, error.path()) + ": " + error.what());
  }
}

// Builds checked_trials(), so that a contradictory scene, or one whose records exceed the memory,
// is rejected before anything is written. Adds the files that they name to `files`. `asked`: trials
// of the whole sweep.
Workforce check_cells(const TrialPlan& plan, const SweepOptions& options, const std::vector<std::size_t>& trials,
                      std::size_t asked, const Catalogues& catalogues, std::set<std::string>& files) {
  const std::vector<std::size_t> numbers = checked_trials(plan, options, trials);
  const auto check_all = [&] {
    std::set<std::string> named;
    double bytes = 0.0;
    std::size_t largest = numbers.front();
    for (const std::size_t trial : numbers) {
      if (options.interrupt != nullptr && *options.interrupt) break;
      const CheckedTrial checked = check_one(plan, trial, options.only ? trial + 1 : asked, catalogues);
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
  const Workforce workforce = workforce_for(options, trials.size(), bytes);
  try {
    check_record_size(plan.trial(largest).scene, bytes, workforce.max_bytes);
  } catch (const SceneValueError& error) {
    throw InputError(plan.where(largest, error.path()) + ": " + error.what());
  }
  return workforce;
}

// As run_one(), with the trial's number in errors, and the scene's line if a scene value is the
// cause.
FinishedTrial run_numbered(const WorkPlan& plan, std::size_t index, TrialEncoder* encoder) {
  try {
    return run_one(plan, index, encoder);
  } catch (const Interrupted&) {
    throw;
  } catch (const SceneValueError& error) {
    reject("trial {}: {}: {}", index, plan.trials.where(index, error.path()), error.what());
  } catch (const FailedRun& error) {
    reject("trial {}: {}: {}", index, plan.trials.where(index, "time_step"), error.what());
  } catch (const InputError& error) {
    reject("trial {}: {}", index, error.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("trial {}: {}", index, error.what()));
  }
}

// Simulates the trial of a given number.
using Simulate = std::function<FinishedTrial(std::size_t)>;

Simulate simulation(const WorkPlan& plan, const SweepOptions& options) {
  std::shared_ptr<TrialEncoder> encoder = options.output.empty() ? nullptr : std::make_shared<TrialEncoder>();
  return [plan, encoder](std::size_t trial) {
    try {
      return run_numbered(plan, trial, encoder.get());
    } catch (const InputError& error) {
      return failed_trial(trial, error.what());
    }
  };
}

// Simulates trials and returns them in order.
class TrialWorkers {
 public:
  TrialWorkers() = default;
  virtual ~TrialWorkers() = default;
  TrialWorkers(const TrialWorkers&) = delete;
  TrialWorkers& operator=(const TrialWorkers&) = delete;

  // True if next() would return at once; waits for that until `deadline`.
  virtual bool ready_until(std::chrono::steady_clock::time_point deadline) = 0;
  // Empty after the last trial, and once interrupted.
  virtual std::optional<FinishedTrial> next() = 0;
  // Takes back a trial that is no longer needed.
  virtual void give_back(FinishedTrial trial) = 0;
};

class WorkerThreads final : public TrialWorkers {
 public:
  WorkerThreads(std::vector<std::size_t> trials, std::size_t threads, const WorkPlan& plan, const SweepOptions& options,
                const HeldFiles& files)
      : trials_(std::move(trials)),
        workers_(
            trials_.size(), threads,
            [this, plan, &options, &files]() -> OrderedWorkers<FinishedTrial>::Work {
              return [this, &files, simulate = simulation(plan, options)](std::size_t index) {
                FinishedTrial finished = simulate(trials_[index]);
                files.check();  // the trial must have read the same files as all others
                return finished;
              };
            },
            options.interrupt) {}

  bool ready_until(std::chrono::steady_clock::time_point deadline) override { return workers_.ready_until(deadline); }
  std::optional<FinishedTrial> next() override { return workers_.next(); }
  void give_back(FinishedTrial trial) override { workers_.give_back(std::move(trial)); }

 private:
  std::vector<std::size_t> trials_;
  OrderedWorkers<FinishedTrial> workers_;
};

// One child process per trial, so that a crash fails only that trial.
class WorkerProcesses final : public TrialWorkers {
 public:
  WorkerProcesses(std::vector<std::size_t> trials, std::size_t jobs, const WorkPlan& plan, const SweepOptions& options,
                  const HeldFiles& files)
      : trials_(std::move(trials)),
        limit_(options.isolation.limit),
        files_(&files),
        children_(
            trials_.size(), jobs,
            [this, simulate = simulation(plan, options)](std::size_t index) { return to_message(simulate(trials_[index])); },
            options.interrupt, limit_, options.isolation.fork) {}

  bool ready_until(std::chrono::steady_clock::time_point deadline) override { return children_.ready_until(deadline); }
  std::optional<FinishedTrial> next() override {
    std::optional<ChildEnd> end = children_.next();
    if (!end) return std::nullopt;
    files_->check();
    return finished(trials_[delivered_++], std::move(*end));
  }
  void give_back(FinishedTrial) override {}

 private:
  [[nodiscard]] FinishedTrial finished(std::size_t trial, ChildEnd end) const {
    if (end.kind == ChildEnd::Kind::lost)
      return failed_trial(trial, fmt::format("trial {}: its worker process {}", trial, end.loss(limit_)));
    if (end.kind != ChildEnd::Kind::result) return failed_trial(trial, fmt::format("trial {}: {}", trial, end.text));
    try {
      return from_message(end.text);
    } catch (const std::exception&) {  // user code may write to any descriptor
      return failed_trial(trial, fmt::format("trial {}: its worker process returned an invalid result", trial));
    }
  }

  std::vector<std::size_t> trials_;
  std::size_t delivered_ = 0;
  double limit_;
  const HeldFiles* files_;
  OrderedChildren children_;
};

std::unique_ptr<TrialWorkers> make_workers(std::vector<std::size_t> trials, std::size_t jobs, const WorkPlan& plan,
                                           const SweepOptions& options, const HeldFiles& files) {
  if (options.isolation.on) return std::make_unique<WorkerProcesses>(std::move(trials), jobs, plan, options, files);
  return std::make_unique<WorkerThreads>(std::move(trials), jobs, plan, options, files);
}

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

// Keeps the finished trials of a failed run and returns a message with their folder; empty if there
// are none.
std::string keep_finished(SweepWriter& writer, std::size_t planned) {
  try {
    writer.keep();
  } catch (const InputError&) {
    // The disk may still be full. Batches finished earlier exist.
  }
  if (writer.finished() == 0) return "";
  return fmt::format("; {} contains {} of {}; continue by the same command with --resume", writer.folder(), writer.finished(),
                     counted(planned, "trial"));
}

// Summary of a trial that an earlier run finished. A dataset does not contain the outcome of each
// unit.
std::string summary_of_stored(const TrialRecord& record) {
  TrialResult result;
  result.record = record;
  result.units.resize(record.sensors.size());
  FinishedTrial finished;
  finished.summary = summary_of(result);
  finished.summary.resumed = true;
  return to_message(finished);
}

// The scene's sweep, with repeated cells until there are at least options.limit trials.
TrialPlan long_enough_plan(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed) {
  TrialPlan plan(file, catalogues, options.trials, seed);
  if (plan.size() >= options.limit) return plan;
  const std::size_t cells = TrialPlan(file, catalogues, 1, seed).size();
  return {file, catalogues, (options.limit + cells - 1) / cells, seed};
}

// Numbers of the trials to run.
std::vector<std::size_t> chosen_trials(const PlannedTrials& planned, const SweepOptions& options, std::uint64_t seed) {
  if (options.shard) {
    const auto chosen = [&] {
      return Json(trials_of_shard(planned.plan, planned.asked, seed, options.shard->number, options.shard->count)).dump();
    };
    return Json::parse(run_before_trials(options, planned.asked, chosen)).get<std::vector<std::size_t>>();
  }
  if (options.only) return {*options.only};
  std::vector<std::size_t> all(planned.asked);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// A running sweep: its trials, their destination, and the results so far.
class RunningSweep {
 public:
  RunningSweep(const ReadSweep& read, const SweepOptions& options, const ProgressCallback& progress);

  // Throws InputError for anything that cannot run, before anything is written.
  void check(const Catalogues& catalogues);
  // Creates the folder for finished work and reads what an earlier run left there. Returns false if
  // that run was complete, so that nothing is left to do.
  bool open();
  // Runs the missing trials and finishes the dataset; a failed run keeps its finished trials.
  void run();

  SweepSummary take_summary() { return std::move(summary_); }

 private:
  void run_trials();
  void take(FinishedTrial& trial);
  void add_summary(TrialSummary& summary);
  void finish();
  void report();

  [[nodiscard]] WorkPlan work() const {
    return {plan_, summary_.seed, recording_of(options_), workforce_.max_bytes, options_.interrupt};
  }

  const ReadSweep& read_;
  const SweepOptions& options_;
  const ProgressCallback& progress_;
  const TrialPlan& plan_;
  std::vector<std::size_t> trials_;  // numbers of the trials to run
  Workforce workforce_;
  std::optional<HeldFiles> files_;  // files that the trials name
  DatasetHeader header_;
  std::unique_ptr<SweepWriter> writer_;         // null: no output
  std::map<std::size_t, std::string> resumed_;  // trials that an earlier run finished, as messages (finished_trial.h)
  SweepSummary summary_;
  std::size_t reported_ = 0;  // number of finished trials at the last report
};

RunningSweep::RunningSweep(const ReadSweep& read, const SweepOptions& options, const ProgressCallback& progress)
    : read_(read),
      options_(options),
      progress_(progress),
      plan_(read.planned.plan),
      trials_(chosen_trials(read.planned, options, read.seed)) {
  summary_.seed = read.seed;
  summary_.command = canonical_command(options);
  summary_.planned = trials_.size();
  if (options.shard) summary_.shard = SweepShard{options.shard->number, options.shard->count, read.planned.asked};
  summary_.scene = plan_.trial(trials_.front()).scene;
  summary_.available = plan_.size();
}

void RunningSweep::check(const Catalogues& catalogues) {
  if (summary_.scene.accuracy)
    throw std::logic_error("run_sweep: the accuracy of the scene has not been resolved to a time step");
  std::set<std::string> files;
  workforce_ = check_cells(plan_, options_, trials_, read_.planned.asked, catalogues, files);
  if (options_.on_start) options_.on_start();
  files_.emplace(files);
  header_ = {SLIPBENCH_VERSION,
             read_.file.text(),
             overrides_json(options_.overrides),
             summary_.seed,
             summary_.command,
             split_rule(summary_.scene),
             files_->digests(),
             {},
             summary_.shard};
}

bool RunningSweep::open() {
  writer_ = std::make_unique<SweepWriter>(options_.output, header_, options_.shard_limit);
  if (!options_.resume) {
    writer_->refuse_left();
    return true;
  }
  if (std::optional<FinishedDataset> whole = finished_dataset(options_.output, header_)) {
    writer_->drop_batches();  // left by a run that was killed after finishing its dataset
    summary_.was_complete = true;
    summary_.resumed = whole->trials;
    summary_.failed = std::move(whole->failed);
    summary_.files = std::move(whole->files);
    return false;
  }
  try {
    resumed_ = writer_->resume(&summary_of_stored);
  } catch (const Interrupted&) {
    throw Interrupted("all batches in " + writer_->folder() + " are kept");
  }
  summary_.damaged = writer_->damaged();
  return true;
}

void RunningSweep::run() {
  try {
    try {
      run_trials();
    } catch (const Interrupted&) {  // in the first running trial; earlier trials are complete
    }
    finish();
  } catch (const std::exception& error) {
    if (!writer_) throw;
    const std::string left = keep_finished(*writer_, summary_.planned);
    if (dynamic_cast<const InputError*>(&error) != nullptr) throw InputError(error.what() + left);
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) throw InputError("out of memory" + left);
    throw std::runtime_error(error.what() + left);
  }
}

void RunningSweep::run_trials() {
  summary_.trials.reserve(summary_.planned);  // avoids reallocations, which would fragment the heap
  std::vector<std::size_t> missing;
  std::ranges::copy_if(trials_, std::back_inserter(missing), [&](std::size_t trial) { return !resumed_.contains(trial); });
  const std::unique_ptr<TrialWorkers> workers = make_workers(missing, workforce_.threads, work(), options_, *files_);
  for (const std::size_t trial : trials_) {
    end_if(options_.interrupt);
    if (const auto resumed = resumed_.find(trial); resumed != resumed_.end()) {
      FinishedTrial finished = from_message(resumed->second);
      add_summary(finished.summary);
      report();
      continue;
    }
    const auto due = writer_ ? writer_->due() : std::nullopt;
    if (due && (std::chrono::steady_clock::now() >= *due || !workers->ready_until(*due))) writer_->finish_batch();
    constexpr std::chrono::milliseconds a_while{100};
    while (progress_ && trials_.size() == 1 && !workers->ready_until(std::chrono::steady_clock::now() + a_while))
      progress_({.total = 1, .share = simulated_share()});
    std::optional<FinishedTrial> finished = workers->next();
    if (!finished) break;
    take(*finished);
    workers->give_back(std::move(*finished));
    report();
  }
}

void RunningSweep::take(FinishedTrial& trial) {
  if (!trial.failure.empty()) {
    const std::size_t number = trial.summary.trial;
    summary_.failed.push_back({number, std::move(trial.failure), repeating_command(options_, summary_.seed, number)});
    if (writer_) writer_->add_failed(summary_.failed.back());
    return;
  }
  if (writer_) writer_->append(*trial.encoded);
  summary_.simulated += trial.duration;
  summary_.computed += trial.computed;
  summary_.shortest_step = summary_.longest_step == 0.0 ? trial.time_step : std::min(summary_.shortest_step, trial.time_step);
  summary_.longest_step = std::max(summary_.longest_step, trial.time_step);
  add_summary(trial.summary);
}

void RunningSweep::add_summary(TrialSummary& summary) {
  if (summary.resumed) ++summary_.resumed;
  if (options_.on_trial) options_.on_trial(summary);
  if (!options_.keep_units && summary_.planned > 1) {
    for (SensorSummary& sensor : summary.sensors) sensor.units.clear();
  }
  // A copy: memory allocated by a worker would keep the memory around it, ten times as much,
  // allocated.
  summary_.trials.push_back(std::as_const(summary));
}

void RunningSweep::finish() {
  summary_.interrupted = summary_.trials.size() + summary_.failed.size() < summary_.planned;
  // A shard reports failed trials even if it has no others: merging counts them.
  const bool whole = !summary_.interrupted && (!summary_.trials.empty() || summary_.shard);
  if (writer_) summary_.files = whole ? writer_->commit() : writer_->keep();
  if (writer_) summary_.kept = whole ? summary_.trials.size() : writer_->finished();
  report();
}

void RunningSweep::report() {
  const std::size_t done = summary_.trials.size() + summary_.failed.size();
  if (progress_ && done > reported_) progress_({done, summary_.planned, summary_.simulated});
  reported_ = done;
}

}  // namespace

std::string run_before_trials(const SweepOptions& options, std::size_t trials, const std::function<std::string()>& action) {
  if (!options.isolation.on) return action();
  const double limit = static_cast<double>(trials) * options.isolation.limit;
  return run_in_child("before the first trial", action, options.interrupt, limit, options.isolation.fork);
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
  if (planned.asked == 0) planned.asked = planned.plan.size();
  if (options.only && *options.only >= planned.asked) {
    reject("{}: no trial {}; allowed: 0 to {}", file.name(), *options.only, planned.asked - 1);
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
  RunningSweep sweep(read, options, progress);
  sweep.check(catalogues);
  if (options.output.empty() || sweep.open()) sweep.run();
  return sweep.take_summary();
}

}  // namespace slipbench

#include "tools/program/run/run_sweep.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/dataset/encoder.h"
#include "tools/base/workers/interrupt.h"
#include "tools/base/workers/ordered_workers.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/run/recorder.h"
#include "tools/program/run/run_trial.h"
#include "tools/program/run/split.h"

namespace slipbench {
namespace {

using Json = nlohmann::ordered_json;

// What is kept of a trial; without a dataset nothing has to be.
Recording recording_of(const SweepOptions& options) { return options.output.empty() ? Recording::outcome : options.recording; }

// Whether a value given for `path` replaces all that was given for `earlier`. Below `sweep` the rest of a path is one key.
bool replaces(const std::string& path, const std::string& earlier) {
  return earlier == path || (earlier.starts_with(path + '.') && !path.starts_with("sweep."));
}

// The overrides that count, in an order in which they can be applied again. An object has each key once, so a repeated path stands
// where it was given last; what it replaces must go with its first value, since it may be below it.
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

// The swept values of a trial. They come as JSON already.
std::string params_json(const std::vector<std::pair<std::string, std::string>>& drawn) {
  std::string text = "{";
  for (const auto& [path, value] : drawn) {
    if (text.size() > 1) text += ", ";
    text += Json(path).dump() + ": " + value;
  }
  return text + "}";
}

// A trial as a worker hands it over.
struct FinishedTrial {
  TrialSummary summary;
  double duration = 0.0;  // s, simulated
  double computed = 0.0;  // s, on the clock
  std::optional<EncodedTrial> encoded;
};

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

// Takes away what is not there without a recording: empty columns.
void keep_outcome(TrialRecord& record) {
  record.sensors.clear();
  record.body_time.clear();
  record.bodies.clear();
}

// How the trials are run and kept.
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
  FinishedTrial finished{summary_of(result), trial.scene.duration, computed.count(), std::nullopt};
  if (plan.recording == Recording::outcome) keep_outcome(result.record);
  if (encoder != nullptr) finished.encoded = encoder->encode(result.record);
  return finished;
}

// Grid cells beyond this many are checked when they run.
constexpr std::size_t max_checked_cells = 10'000;

// Worker threads, and what the record of each may take.
struct Workforce {
  std::size_t threads = 1;
  double max_bytes = max_record_bytes;
};

// As many threads as `options` ask for. Where they ask for none, one a hardware thread, but no more than have room for twice a
// record of `bytes` (0: nothing is recorded) each: its events come on top.
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

// Builds the first trial of every grid cell, or the only one that runs, so that a scene that contradicts itself, or whose records
// would not fit into memory, is refused before anything is written.
Workforce check_cells(const TrialPlan& plan, const SweepOptions& options, std::size_t trials) {
  const std::size_t end = options.only ? *options.only + 1 : std::min(plan.size(), max_checked_cells * plan.draws());
  std::size_t index = options.only.value_or(0);
  std::size_t largest = index;  // trial of the largest record
  double bytes = 0.0;
  try {
    for (; index < end && !(options.interrupt != nullptr && *options.interrupt); index += plan.draws()) {
      const Scene scene = plan.trial(index).scene;
      if (scene.detector) check_run(*scene.detector, options.only ? end : trials);
      const double size = check_trial(scene, index);
      if (recording_of(options) == Recording::outcome || size <= bytes) continue;
      largest = index;
      bytes = size;
    }
    index = largest;
    const Workforce workforce = workforce_for(options, trials, bytes);
    check_record_size(plan.trial(index).scene, bytes, workforce.max_bytes);
    return workforce;
  } catch (const SceneValueError& error) {
    throw InputError(plan.where(index, error.path()) + ": " + error.what());
  }
}

// As run_one; what went wrong is told with the trial's number, and with the line of the scene where one is to blame.
FinishedTrial run_numbered(const WorkPlan& plan, std::size_t index, TrialEncoder* encoder) {
  try {
    return run_one(plan, index, encoder);
  } catch (const Interrupted&) {
    throw;
  } catch (const SceneValueError& error) {
    throw InputError(fmt::format("trial {}: {}: {}", index, plan.trials.where(index, error.path()), error.what()));
  } catch (const InputError& error) {
    throw InputError(fmt::format("trial {}: {}", index, error.what()));
  } catch (const std::bad_alloc&) {
    throw InputError(fmt::format("trial {}: out of memory; a shorter trial, slower sensors or fewer --jobs need less", index));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("trial {}: {}", index, error.what()));
  }
}

OrderedWorkers<FinishedTrial>::Work make_work(const WorkPlan& plan, const SweepOptions& options) {
  std::shared_ptr<TrialEncoder> encoder = options.output.empty() ? nullptr : std::make_shared<TrialEncoder>();
  return [plan, encoder, first = options.only.value_or(0), keep = options.keep_failed](std::size_t index) {
    const std::size_t trial = first + index;
    try {
      return run_numbered(plan, trial, encoder.get());
    } catch (const InputError& error) {
      if (!keep) throw;
      FinishedTrial failed;
      failed.summary.trial = trial;
      failed.summary.failure = error.what();
      return failed;
    }
  };
}

// Keeps the finished trials of a run that failed, and says where; empty when there are none.
std::string keep_finished(DatasetWriter& writer, std::size_t planned) {
  const std::size_t finished = writer.size();
  const std::vector<std::string> files = writer.keep_partial();
  if (files.empty()) return "";
  return fmt::format("; {} {} {} of {} trials", fmt::join(files, ", "), files.size() == 1 ? "holds" : "hold", finished, planned);
}

// One number of every unit; nlohmann writes NaN as null.
template <class Number>
Json column(const std::vector<UnitOutcome>& units, Number UnitOutcome::*member) {
  Json values = Json::array();
  for (const UnitOutcome& unit : units) values.push_back(unit.*member);
  return values;
}

// The scene's sweep, its cells repeated until there are at least options.limit trials.
TrialPlan long_enough_plan(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed) {
  TrialPlan plan(file, catalogues, options.trials, seed);
  if (plan.size() >= options.limit) return plan;
  const std::size_t cells = TrialPlan(file, catalogues, 1, seed).size();
  return {file, catalogues, (options.limit + cells - 1) / cells, seed};
}

}  // namespace

PlannedTrials plan_trials(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed) {
  PlannedTrials planned{long_enough_plan(file, catalogues, options, seed), options.limit};
  if (planned.asked == 0) planned.asked = planned.plan.size();
  if (options.only && *options.only >= planned.asked) {
    throw InputError(fmt::format("{}: there is no trial {}; allowed: 0 to {}", file.name(), *options.only, planned.asked - 1));
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
  return command;
}

SweepSummary run_sweep(const SweepOptions& options, const Catalogues& catalogues, const ProgressCallback& progress) {
  SceneFile file = SceneFile::load(options.scene_path);
  for (const Override& change : options.overrides) file.apply(change);

  SweepSummary summary;
  summary.seed = options.seed ? *options.seed : parse_scene(file, catalogues).seed;
  summary.command = canonical_command(options);
  const PlannedTrials chosen = plan_trials(file, catalogues, options, summary.seed);
  const TrialPlan& plan = chosen.plan;
  summary.planned = options.only ? 1 : chosen.asked;
  summary.scene = plan.trial(options.only.value_or(0)).scene;
  if (summary.scene.accuracy) throw std::logic_error("run_sweep: a scene whose wish for accuracy has not been settled");
  summary.available = plan.size();
  const Workforce workforce = check_cells(plan, options, summary.planned);
  if (options.on_start) options.on_start();

  std::unique_ptr<DatasetWriter> writer;
  if (!options.output.empty()) {
    writer = std::make_unique<DatasetWriter>(options.output,
                                             DatasetHeader{SLIPBENCH_VERSION, file.text(), overrides_json(options.overrides),
                                                           summary.seed, summary.command, split_rule(summary.scene)},
                                             plan.size(), options.shard_limit);
  }

  // OpenSSL crashes where there is no memory to set itself up, which many workers may leave none for: it does so before them.
  if (writer) static_cast<void>(content_digest({}));

  const auto run_all = [&] {
    const WorkPlan work{plan, summary.seed, recording_of(options), workforce.max_bytes, options.interrupt};
    OrderedWorkers<FinishedTrial> workers(
        summary.planned, workforce.threads, [&] { return make_work(work, options); }, options.interrupt);
    while (std::optional<FinishedTrial> trial = workers.next()) {
      if (writer) writer->append(*trial->encoded);
      summary.simulated += trial->duration;
      summary.computed += trial->computed;
      summary.trials.push_back(std::move(trial->summary));
      if (progress) progress({summary.trials.size(), summary.planned, summary.simulated});
    }
  };

  try {
    try {
      run_all();
    } catch (const Interrupted&) {  // in the first of the trials that were running: those before it are in
    }
    summary.interrupted = summary.trials.size() < summary.planned;
    if (writer) summary.files = summary.interrupted ? writer->keep_partial() : writer->commit();
  } catch (const std::exception& error) {
    if (!writer) throw;
    const std::string kept = keep_finished(*writer, summary.planned);
    if (dynamic_cast<const InputError*>(&error) != nullptr) throw InputError(error.what() + kept);
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) throw InputError("out of memory" + kept);
    throw std::runtime_error(error.what() + kept);
  }
  return summary;
}

std::string summary_json(const SweepSummary& summary) {
  Json trials = Json::array();
  for (const TrialSummary& trial : summary.trials) {
    Json sensors = Json::object();
    for (const SensorSummary& sensor : trial.sensors) {
      sensors[sensor.name] = {{"touch_time_s", column(sensor.units, &UnitOutcome::touch_time)},
                              {"onset_time_s", column(sensor.units, &UnitOutcome::onset_time)},
                              {"micro_onset_time_s", column(sensor.units, &UnitOutcome::micro_onset_time)},
                              {"slip_distance_m", column(sensor.units, &UnitOutcome::slip_distance)},
                              {"load_N", column(sensor.units, &UnitOutcome::load)},
                              {"margin", column(sensor.units, &UnitOutcome::margin)},
                              {"state_count", sensor.state_count},
                              {"state_micro_count", sensor.state_micro_count}};
    }
    Json json = {{"trial", trial.trial},
                 {"params", Json::parse(trial.params)},
                 {"outcome", Json::parse(outcome_json(trial.outcome))},
                 {"sensors", std::move(sensors)}};
    if (trial.detector) {
      json["detector"] = {{"type", trial.detector->type},
                          {"oracle", trial.detector->type == oracle_type},
                          {"sensor", trial.detector->sensor},
                          {"confusion", trial.detector->confusion}};
    }
    if (!trial.controller.empty()) json["controller"] = trial.controller;
    trials.push_back(std::move(json));
  }
  const Json json = {{"command", summary.command},       {"seed", summary.seed},
                     {"planned", summary.planned},       {"finished", summary.trials.size()},
                     {"simulated_s", summary.simulated}, {"interrupted", summary.interrupted},
                     {"files", summary.files},           {"trials", std::move(trials)}};
  return json.dump(2);
}

}  // namespace slipbench

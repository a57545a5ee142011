#include "tools/run/run_sweep.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/dataset/encoder.h"
#include "tools/run/ordered_workers.h"
#include "tools/run/run_trial.h"

namespace slipbench {
namespace {

using Json = nlohmann::ordered_json;

// A word as a shell would have to be given it.
std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-./=:,+%@").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

// What decides the bytes of a dataset, and nothing else: no --jobs, no -o.
std::string canonical_command(const SweepOptions& options) {
  std::string command = fmt::format("slipbench {} {}", options.verb, quoted(options.scene_path));
  for (const Override& change : options.overrides) command += " --set " + quoted(change.path + "=" + change.value);
  if (options.seed) command += fmt::format(" --seed {}", *options.seed);
  if (options.trials > 0) command += fmt::format(" --trials {}", options.trials);
  if (options.limit > 1) command += fmt::format(" --trials {}", options.limit);
  return command;
}

std::string overrides_json(const std::vector<Override>& overrides) {
  Json json = Json::object();
  for (const Override& change : overrides) json[change.path] = change.value;
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
  TrialSummary summary{record.trial, record.params, record.outcome, {}};
  for (std::size_t i = 0; i < record.sensors.size(); ++i) {
    const SensorRecord& sensor = record.sensors[i];
    summary.sensors.push_back(
        {sensor.name, std::move(result.units[i]), sensor.labels.state_count, sensor.labels.state_micro_count});
  }
  return summary;
}

FinishedTrial run_one(const TrialPlan& plan, std::uint64_t seed, std::size_t index, TrialEncoder* encoder) {
  TrialPlan::Trial trial = plan.trial(index);
  trial.scene.seed = seed;
  const auto start = std::chrono::steady_clock::now();
  TrialResult result = run_trial(trial.scene, index, encoder != nullptr ? Recording::full : Recording::outcome);
  const std::chrono::duration<double> computed = std::chrono::steady_clock::now() - start;
  result.record.params = params_json(trial.drawn);
  FinishedTrial finished{summary_of(result), trial.scene.duration, computed.count(), std::nullopt};
  if (encoder != nullptr) finished.encoded = encoder->encode(result.record);
  return finished;
}

// The trials to choose from: the scene's sweep, its cells repeated until there are at least options.limit.
TrialPlan make_plan(const SceneFile& file, const Catalogues& catalogues, const SweepOptions& options, std::uint64_t seed) {
  TrialPlan plan(file, catalogues, options.trials, seed);
  if (plan.size() >= options.limit) return plan;
  const std::size_t cells = TrialPlan(file, catalogues, 1, seed).size();
  return {file, catalogues, (options.limit + cells - 1) / cells, seed};
}

// Adds the trial's number, and the line of the scene where one is to blame, to what went wrong.
[[noreturn]] void rethrow_of_trial(const TrialPlan& plan, std::size_t index) {
  try {
    throw;
  } catch (const SceneValueError& error) {
    throw InputError(fmt::format("trial {}: {}: {}", index, plan.where(index, error.path()), error.what()));
  } catch (const InputError& error) {
    throw InputError(fmt::format("trial {}: {}", index, error.what()));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("trial {}: {}", index, error.what()));
  }
}

// Grid cells beyond this many are checked when they run.
constexpr std::size_t max_checked_cells = 10'000;

// Builds the first trial of every grid cell, so that a scene that contradicts itself is refused before anything is written.
void check_cells(const TrialPlan& plan) {
  const std::size_t checked = std::min(plan.size(), max_checked_cells * plan.draws());
  for (std::size_t index = 0; index < checked; index += plan.draws()) {
    try {
      check_trial(plan.trial(index).scene, index);
    } catch (const SceneValueError& error) {
      throw InputError(plan.where(index, error.path()) + ": " + error.what());
    }
  }
}

OrderedWorkers<FinishedTrial>::Work make_work(const TrialPlan& plan, std::uint64_t seed, bool encode) {
  std::shared_ptr<TrialEncoder> encoder = encode ? std::make_shared<TrialEncoder>() : nullptr;
  return [&plan, seed, encoder](std::size_t index) {
    try {
      return run_one(plan, seed, index, encoder.get());
    } catch (...) {
      rethrow_of_trial(plan, index);
    }
  };
}

// What became of the finished trials of a run that failed; empty when there are none.
std::string kept_text(const std::vector<std::string>& files, std::size_t held, std::size_t planned) {
  if (files.empty()) return "";
  return fmt::format("; {} {} {} of {} trials", fmt::join(files, ", "), files.size() == 1 ? "holds" : "hold", held, planned);
}

// One number of every unit; nlohmann writes NaN as null.
template <class Number>
Json column(const std::vector<UnitOutcome>& units, Number UnitOutcome::*member) {
  Json values = Json::array();
  for (const UnitOutcome& unit : units) values.push_back(unit.*member);
  return values;
}

std::size_t thread_count(std::size_t jobs, std::size_t trials) {
  if (jobs == 0) jobs = std::max(1U, std::thread::hardware_concurrency());
  return std::min(jobs, std::max<std::size_t>(1, trials));
}

}  // namespace

SweepSummary run_sweep(const SweepOptions& options, const Catalogues& catalogues, const ProgressCallback& progress) {
  SceneFile file = SceneFile::load(options.scene_path);
  for (const Override& change : options.overrides) file.apply(change);

  SweepSummary summary;
  summary.seed = options.seed ? *options.seed : parse_scene(file, catalogues).seed;
  summary.command = canonical_command(options);
  const TrialPlan plan = make_plan(file, catalogues, options, summary.seed);
  summary.planned = options.limit == 0 ? plan.size() : options.limit;
  summary.scene = plan.trial(0).scene;
  summary.available = plan.size();
  check_cells(plan);
  if (options.on_start) options.on_start();

  std::unique_ptr<DatasetWriter> writer;
  if (!options.output.empty()) {
    writer = std::make_unique<DatasetWriter>(
        options.output,
        DatasetHeader{SLIPBENCH_VERSION, file.text(), overrides_json(options.overrides), summary.seed, summary.command},
        plan.size(), options.shard_limit);
  }

  const auto run_all = [&] {
    OrderedWorkers<FinishedTrial> workers(
        summary.planned, thread_count(options.jobs, summary.planned),
        [&] { return make_work(plan, summary.seed, writer != nullptr); }, options.interrupt);
    while (std::optional<FinishedTrial> trial = workers.next()) {
      if (writer) writer->append(*trial->encoded);
      summary.simulated += trial->duration;
      summary.computed += trial->computed;
      summary.trials.push_back(std::move(trial->summary));
      if (progress) progress({summary.trials.size(), summary.planned, summary.simulated});
    }
  };

  try {
    run_all();
    summary.interrupted = summary.trials.size() < summary.planned;
    if (writer) summary.files = summary.interrupted ? writer->keep_partial() : writer->commit();
  } catch (const InputError& error) {
    if (!writer) throw;
    const std::size_t held = writer->size();
    throw InputError(error.what() + kept_text(writer->keep_partial(), held, summary.planned));
  } catch (const std::exception& error) {
    if (!writer) throw;
    const std::size_t held = writer->size();
    throw std::runtime_error(error.what() + kept_text(writer->keep_partial(), held, summary.planned));
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
    trials.push_back({{"trial", trial.trial},
                      {"params", Json::parse(trial.params)},
                      {"outcome", Json::parse(outcome_json(trial.outcome))},
                      {"sensors", std::move(sensors)}});
  }
  const Json json = {{"command", summary.command},       {"seed", summary.seed},
                     {"planned", summary.planned},       {"finished", summary.trials.size()},
                     {"simulated_s", summary.simulated}, {"interrupted", summary.interrupted},
                     {"files", summary.files},           {"trials", std::move(trials)}};
  return json.dump(2);
}

}  // namespace slipbench

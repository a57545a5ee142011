#include "tools/cli/commands/simulation/simulation_commands.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "tools/cli/arguments.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/shard_set.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/warnings.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench {
namespace {

// A sweep's summary and its wall-clock time.
struct Finished {
  SweepSummary summary;
  double elapsed = 0.0;  // s
};

// The trials in the JSON output. They are kept on disk because they may exceed the memory.
class TrialsJson {
 public:
  TrialsJson() : file_(std::tmpfile(), &std::fclose) {
    if (!file_) reject("cannot create a temporary file: {}", std::strerror(errno));
  }
  void add(const TrialSummary& trial) {
    fmt::print(file_.get(), "{}{}", empty_ ? "" : ",", trial_json(trial));
    empty_ = false;
  }
  // Appends the trials to the object `head` and prints it. Prints nothing if some trial could not
  // be stored.
  void print(const std::string& head) {
    if (std::fflush(file_.get()) != 0 || std::ferror(file_.get()) != 0) {
      reject("cannot write a temporary file: {}", std::strerror(errno));
    }
    std::rewind(file_.get());
    take_stdout_back();
    fmt::print("{},\"trials\":[", head.substr(0, head.size() - 1));
    std::array<char, 65536> block{};
    while (const std::size_t count = std::fread(block.data(), 1, block.size(), file_.get()))
      std::fwrite(block.data(), 1, count, stdout);
    if (std::ferror(file_.get()) != 0) throw InputError("cannot read a temporary file");
    fmt::print("]}}\n");
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  bool empty_ = true;
};

Finished simulate(const ReadSweep& read, SweepOptions sweep, const Catalogues& catalogues, bool silent,
                  std::optional<PreparationNotice>& preparing) {
  // Until the scene is checked there is nothing to keep, so a signal ends the program as usual.
  std::optional<InterruptGuard> guard;
  sweep.on_start = [&] {
    preparing.reset();
    guard.emplace();
  };
  sweep.interrupt = &InterruptGuard::flag();
  sweep.keep_units = false;
  Progress progress = Progress::for_stream(stderr, silent);
  const auto start = std::chrono::steady_clock::now();
  SweepSummary summary = run_sweep(read, sweep, catalogues, [&progress](const SweepProgress& state) {
    state.done == 0 && state.total == 1 ? progress.part(state.share) : progress.update(state.done, state.total, state.simulated);
  });
  return {std::move(summary), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}

void print_json(const Finished& finished, const std::vector<Warning>& warnings, TrialsJson& trials) {
  Json json = Json::parse(summary_json(finished.summary));
  json["elapsed_s"] = finished.elapsed;
  json["computed_s"] = finished.summary.computed;
  json["times_real_time"] = finished.summary.simulated / finished.elapsed;
  json["times_real_time_per_core"] = finished.summary.simulated / finished.summary.computed;
  json["warnings"] = warnings_json(warnings);
  if (const std::vector<DetectorScore> scores = detector_scores(finished.summary.trials); !scores.empty()) {
    json["detectors"] = detectors_json(scores);
  }
  if (std::vector<GraspRow> rows = grasp_rows(finished.summary); !rows.empty()) json["grasps"] = grasp_json(rows);
  trials.print(printed_json(json));
}

// Reads the scene that is piped to the command `verb`.
std::string standard_input(const std::string& verb) {
  if (isatty(STDIN_FILENO) == 1) {
    reject(
        "{}: the scene '-' is standard input, which is a terminal here; allowed: a file or a pipe, as in slipbench {} - < SCENE.yaml",
        verb, verb);
  }
  // One byte more than allowed: enough to detect a scene that is too long.
  std::string text(max_yaml_bytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), stdin));
  if (std::ferror(stdin) != 0) reject("{}: cannot read standard input: {}", verb, std::strerror(errno));
  return text;
}

// Completes a command that is suggested to the user: the scene must be piped to standard input
// again.
std::string with_input(const SweepOptions& options, const std::string& command) {
  return options.scene_text ? command + " < SCENE.yaml" : command;
}

void print_only_trial(const SweepOptions& options, const SweepSummary& summary, const Catalogues& catalogues,
                      const Style& style) {
  print_text("{}{}", scene_text(summary.scene, catalogues, style, terminal_width(stdout)),
             trial_text(summary.trials.front(), sensors_of(summary.scene), style));
  if (summary.available > 1) {
    print_text("  trial {} of the {} trials of the scene's sweep; run all of them with: {}\n", summary.trials.front().trial,
               summary.available, as_called(with_input(options, "slipbench sweep " + shell_word(options.scene_path))));
  }
}

// `streams`: the dataset goes to standard output.
void print_next_step(const SweepOptions& options, const SweepSummary& summary, bool streams, const Style& style) {
  if (streams) return;
  if (summary.files.empty()) {
    print_next(with_input(options, fmt::format("slipbench {} {} -o FILE.h5", options.verb, shell_word(options.scene_path))) +
               " stores the recordings");
  } else {
    print_text("{} {}\n", style.good("written:"), files_text(summary.files));
    print_next(summary.shard ? "slipbench merge SHARD.h5 ... -o FILE.h5, when all shards are finished"
                             : "slipbench report " + shell_word(summary.files.front()));
  }
}

// Prints which trials failed, why, and how to run them again.
void print_failed(const SweepOptions& options, const SweepSummary& summary) {
  constexpr std::size_t most = 10;
  std::string text = fmt::format("slipbench: {}\n", failures_text(summary.failed, summary.planned));
  for (std::size_t i = 0; i < std::min(most, summary.failed.size()); ++i) {
    text += fmt::format("  {}\n    again: {}\n", summary.failed[i].message,
                        as_called(with_input(options, summary.failed[i].command)));
  }
  say(stderr, text);
}

void print_summary(const SweepOptions& options, const Finished& finished, bool streams, const Catalogues& catalogues) {
  const SweepSummary& summary = finished.summary;
  const Style style = style_for(stdout);
  if (summary.trials.size() == 1) {
    print_only_trial(options, summary, catalogues, style);
  } else {
    print_text("{}", sweep_text(summary, style));
  }
  if (summary.shard)
    print_text("shard {}: {} of {} of the sweep\n", shard_text(*summary.shard), summary.planned,
               counted(summary.shard->trials, "trial"));
  print_text("\n{}\n{}", speed_text(summary, finished.elapsed), steps_text(summary));
  print_next_step(options, summary, streams, style);
}

// Parses "3/8".
SweepShard parse_shard_option(const std::string& text) {
  SweepShard shard{.number = 0, .count = 0};
  const char* const end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, shard.number);
  if (error == std::errc() && slash != end && *slash == '/') std::from_chars(slash + 1, end, shard.count);
  if (shard_text(shard) == text && shard.number >= 1 && shard.number <= shard.count) return shard;
  reject("sweep: --shard is {}; expected k/n with whole numbers 1 <= k <= n, e.g. 3/8", quote(text));
}

int report_interrupted(const SweepSummary& summary, bool streams) {
  const std::string kept = summary.files.empty() || streams
                               ? "nothing is kept"
                               : fmt::format("kept in {}; continue by the same command with --resume", files_text(summary.files));
  say(stderr, fmt::format("slipbench: interrupted: {} of {} finished; {}\n", std::max(summary.trials.size(), summary.kept),
                          counted(summary.planned, "trial"), kept));
  return exit_interrupted;
}

// Returns true if a value in the scene, perhaps one of several in its sweep, is one of `names`.
bool has_value(const YamlNode& node, const std::set<std::string>& names) {
  return names.contains(node.text) ||
         std::ranges::any_of(node.children, [&](const YamlNode& child) { return has_value(child, names); });
}

}  // namespace

void IsolationOptions::declare(Arguments& arguments) {
  arguments.flag("--isolate", isolate, "Run each trial in a separate process, so that a crash of a plugin fails only that trial");
  arguments.flag("--no-isolate", together, "Run trials in threads (default, except for sweeps with plugins)");
  arguments.quantity("--trial-limit TIME", limit, "Fail a trial that takes longer; implies --isolate", Quantity::time);
  arguments.then([this, &arguments] {
    isolate = isolate || std::isfinite(limit);
    if (isolate && together)
      throw InputError(arguments.name() + ": --no-isolate cannot be combined with --isolate or --trial-limit");
  });
}

Isolation IsolationOptions::chosen(const ReadSweep& read, const SweepOptions& sweep) const {
  const bool several = !sweep.only && read.planned.requested > 1;
  return {.on = isolate || (!together && several && has_value(read.file.root(), users_types())), .limit = limit};
}

void SimulationCommand::declare_both(Arguments& arguments, std::size_t& trials, const std::string& trials_help) {
  sweep.verb = arguments.name();
  arguments.scene("SCENE", sweep.scene_path, "Scene file (YAML), name of a shipped scene, or - for standard input").required();
  arguments.overrides(sweep.overrides, sweep.seed);
  arguments.flag("-q,--quiet", quiet, "Print no progress and no summary");
  arguments.number("--trials N", trials, trials_help, 1);
  arguments.jobs(sweep.jobs);
  arguments.output("-o,--output FILE.h5", sweep.output, "Write the dataset (HDF5); -: to standard output");
  arguments.word("--record NAME", sweep.recording, "What -o writes: full (everything, the default) or outcome (only outcomes)",
                 recording_words);
  isolation.declare(arguments);
  arguments.flag("--resume", sweep.resume, "Continue a killed or interrupted run of the same command");
  arguments.then([this] {
    if (sweep.resume && (sweep.output.empty() || streams()))
      throw InputError(sweep.verb + ": --resume continues a dataset, so it needs -o FILE.h5");
    if (streams()) sweep.shard_limit = std::numeric_limits<std::uint64_t>::max();  // standard output is one file
    if (sweep.recording != Recording::full && sweep.output.empty()) {
      throw InputError(sweep.verb + ": --record sets what -o writes, so it needs -o");
    }
  });
}

int SimulationCommand::run() {
  if (sweep.scene_path == "-") sweep.scene_text = standard_input(sweep.verb);
  const Catalogues catalogues = program_catalogues();
  std::optional<PreparationNotice> preparing(silent());
  const ReadSweep read = read_sweep(sweep, catalogues);
  sweep.isolation = isolation.chosen(read, sweep);
  std::vector<Warning> warnings = scene_warnings(read, sweep);
  print_warnings(warnings);
  TrialsJson trials;
  if (json) sweep.on_trial = [&trials](const TrialSummary& trial) { trials.add(trial); };
  const Finished finished = simulate(read, sweep, catalogues, silent(), preparing);
  const SweepSummary& summary = finished.summary;
  // A single requested trial is not part of a sweep that could be resumed.
  if (summary.planned == 1 && !summary.shard && !summary.failed.empty()) throw InputError(summary.failed.front().message);
  const std::vector<Warning> shown = trial_warnings(summary.trials);
  print_warnings(shown);
  warnings.insert(warnings.end(), shown.begin(), shown.end());
  const bool sums_up = !quiet && !brief;
  if (json) {
    print_json(finished, warnings, trials);
  } else if (summary.was_complete && sums_up) {
    print_text("{} is complete with {}; there is nothing to resume\n", sweep.output, counted(summary.resumed, "trial"));
  } else if (sums_up && !summary.interrupted && !summary.trials.empty()) {
    print_summary(sweep, finished, streams(), catalogues);
  }
  if (!summary.damaged.empty()) {
    say(stderr, fmt::format("slipbench: damaged, so its trials were simulated again: {}\n", fmt::join(summary.damaged, ", ")));
  }
  if (!summary.failed.empty()) print_failed(sweep, summary);
  if (!sweep.output.empty() && summary.files.empty() && !summary.interrupted) say(stderr, "slipbench: nothing was written\n");
  if (summary.interrupted) return report_interrupted(summary, streams());
  return summary.failed.empty() ? exit_good : exit_check_failed;
}

void RunCommand::declare(Arguments& arguments) {
  arguments.about("run", "Simulate one trial of a scene", R"(
Runs the first trial of the scene's sweep, if it has a sweep. --trials N runs the first N trials; if
the scene has fewer, they are repeated with new random draws. --trial K runs only trial K of these,
with a bit-identical result. The same command and seed write the same content into FILE.h5 for any
number of --jobs. Relative paths in a scene start from its folder. Relative paths in --set, or in a
scene on standard input, start from the current folder.

Examples:
  slipbench run scenes/papillarray/stage.yaml
  slipbench run scenes/papillarray/stage.yaml --set motion.speed="8 mm/s" friction.scale=0.8 -o slide.h5
  slipbench run scenes/papillarray/stage.yaml --set "effects=[stribeck, {ageing: {}}]" --json
  slipbench run - -o - < scenes/papillarray/stage.yaml > slide.h5)");
  declare_both(arguments, sweep.limit, "Simulate N trials");
  arguments.number("--trial K", sweep.only, "Simulate only trial K", 0);
  arguments.then([this] {
    if (sweep.limit == 0 && !sweep.only) sweep.limit = 1;
  });
}

void SweepCommand::declare(Arguments& arguments) {
  arguments.about("sweep", "Simulate all trials of a scene's sweep", R"(
Runs each cell of the sweep's grid once for each random draw. --trials N sets the number of
draws per cell (default: sweep.trials of the scene, or 1). Without -o it only prints a summary.
--record outcome stores only the swept values and the outcome of each trial, a few kB per trial:
enough for the maps and curves of the report, but not for training.

FILE.h5 is written under a temporary name and renamed at the end; an existing dataset is replaced.
Above 1 GB it is split into FILE.h5, FILE-0001.h5, ... Ctrl-C lets running trials finish, keeps all
finished trials in the folder FILE.h5.partial and exits with status 130; a second Ctrl-C stops at
once. A kill loses at most the work of the last 5 s. The same command with --resume continues a killed
or interrupted run. If trials fail, the others are written and the exit status is 1.

Examples:
  slipbench sweep scenes/papillarray/hexapod.yaml -o hexapod.h5
  slipbench sweep scenes/papillarray/stage.yaml --set "sweep={motion.speed: [1 mm/s, 4 mm/s]}" -o speeds.h5
  slipbench sweep scenes/papillarray/hexapod.yaml --shard 1/2 -o shard-1.h5
  slipbench sweep scenes/papillarray/hexapod.yaml --shard 2/2 -o shard-2.h5)");
  declare_both(arguments, sweep.trials, "Number of random draws for each cell of the grid");
  arguments.read("--shard k/n", "Simulate only part k of n; slipbench merge joins the parts", [this](const std::string& text) {
    sweep.shard = parse_shard_option(text);
    if (sweep.output.empty()) throw InputError("sweep: --shard writes a part of a dataset, so it needs -o");
  });
}

void MergeCommand::declare(Arguments& arguments) {
  arguments.about("merge", "Merge the shards of a sweep", R"(
Writes the dataset of the undivided sweep, with the same digests, from all files of sweep --shard k/n.
It copies compressed arrays, so it needs little memory and no simulation. Shards of another scene,
seed, version or n, missing trials and trials with a wrong digest are errors. A trial in several
files is written once; its copies must have equal digests or, if MuJoCo, FFTW or a network computed
them, numbers that agree within 1e-9.

Examples:
  slipbench merge shard-1.h5 shard-2.h5 -o hexapod.h5)");
  arguments.inputs("FILE ...", shards, "Shards (HDF5); for split shards the first file", ".h5").required();
  arguments.file("-o,--output FILE.h5", output, "Dataset to write (required)").required();
}

int MergeCommand::run() {
  const Merged merged = merge_shards(shards, output);
  if (json) return print_json(merged_json(merged));
  std::string about = counted(merged.trials, "trial");
  if (merged.failed > 0) about += fmt::format(", {} failed", merged.failed);
  if (merged.duplicates > 0) {
    about += fmt::format(", {} were in several files ({} bit-identical, {} within 1e-9)", merged.duplicates,
                         merged.duplicates - merged.within_rounding, merged.within_rounding);
  }
  print_text("{} {}: {}\n", style_for(stdout).good("written:"), files_text(merged.files), about);
  print_next("slipbench report " + shell_word(merged.files.front()));
  return exit_good;
}

void ClusterCommand::declare(Arguments& arguments) {
  arguments.about("cluster", "Write scripts that run a sweep on many machines", R"(
The folder contains a Slurm array, a Snakefile, and the two scripts that they call: one runs a shard
with sweep --shard, the other verifies and merges the shards. The merged dataset has the digests of
the undivided sweep. A shard may be killed, repeated or run twice at the same time. README.md in the
folder explains how to start it; its paths are those of this machine.

Examples:
  slipbench cluster scenes/papillarray/hexapod.yaml -o hexapod-cluster --shards 64
  slipbench cluster scenes/grasp/map.yaml -o map-cluster --shards 1000 --throttle 200 --record outcome)");
  SweepOptions& sweep = options.sweep;
  arguments.scene("SCENE", sweep.scene_path, "Scene file (YAML), or name of a shipped scene").required();
  arguments.folder("-o,--output DIR", options.folder, "Folder to write, new or empty (required)").required();
  arguments.number("--shards N", options.shards, "Number of shards (required)", 1).required();
  arguments.number("--throttle N", options.throttle, "Maximum number of simultaneous Slurm tasks (default: all)", 1);
  arguments.overrides(sweep.overrides, sweep.seed);
  arguments.number("--trials N", sweep.trials, "Number of random draws for each cell of the grid", 1);
  arguments.word("--record NAME", sweep.recording,
                 "What the shards contain: full (everything, the default) or outcome (only outcomes)", recording_words);
  arguments.jobs(sweep.jobs, "Worker threads per shard, 1 to 1024 (default: 1)");
}

int ClusterCommand::run() {
  const Catalogues catalogues = program_catalogues();
  const std::vector<std::string> files = write_cluster_folder(options, catalogues);
  if (json) return print_json({{"files", files}});
  print_written(files);
  print_text("{} read {}\n", style_for(stdout).dim("next:"), files.front());
  return exit_good;
}

}  // namespace slipbench

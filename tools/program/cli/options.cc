#include "tools/program/cli/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "detectors/hd/words.h"
#include "sim/core/error.h"
#include "tools/program/catalogue/hd_engine_catalogue.h"
#include "tools/program/cli/suggestion.h"
#include "tools/program/train/training_words.h"

namespace slipbench {
namespace {

constexpr std::string_view program_footer = R"(
Exit status: 0 good, 1 a check failed, 2 bad input, 130 interrupted. Errors go to stderr.
`slipbench COMMAND --help` explains a command. Start with: slipbench run scenes/papillarray/stage.yaml)";

constexpr std::string_view run_footer = R"(
One trial, the first of the scene's sweep where it has one. With --trials N: the first N trials of the sweep; a scene with
fewer trials is repeated with fresh random draws until there are N. With --trial K: trial K of these alone, byte for byte as it is
among them. The same command and seed give the same bytes in FILE.h5,
whatever --jobs is.

Examples:
  slipbench run scenes/papillarray/stage.yaml
  slipbench run scenes/papillarray/stage.yaml --set motion.speed="8 mm/s" friction.scale=0.8 -o slide.h5
  slipbench run scenes/papillarray/stage.yaml --set "effects=[stribeck, {ageing: {}}]" --json)";

constexpr std::string_view sweep_footer = R"(
All trials of the scene's sweep: every cell of its grid, times the number of random draws of each cell. --trials N sets the number
of draws of each cell (otherwise the scene's sweep.trials, or 1). Without -o the trials are simulated and summed up, and nothing is written. With --record outcome FILE.h5 holds what was swept and how each
trial ended, a few kB a trial: enough for the report's maps and curves, not for training.

FILE.h5 is written under a temporary name and renamed at the end; a file of that name is replaced. Above 1 GB it is split into
FILE.h5, FILE-0001.h5, ... Ctrl-C: running trials finish, all finished ones are kept in FILE.partial.h5, the exit status is 130;
a second Ctrl-C stops at once.

Examples:
  slipbench sweep scenes/papillarray/hexapod.yaml -o hexapod.h5
  slipbench sweep scenes/papillarray/stage.yaml --set "sweep={motion.speed: [1 mm/s, 4 mm/s]}" -o speeds.h5)";

constexpr std::string_view check_footer = R"(
A scene says under `expect` what must come out of its trials, and under `sweep` how many there are; `slipbench list expectations` shows
what can be asked. An expectation passes where enough trials keep it (`pass`, `reliability`); beside the count stands the exact
(Clopper-Pearson) interval of the rate. Then all trials run again with the negative control, a controller that never tightens on slip: where it
passes as well, the scene tests nothing, which is a failure. A scene without `expect` is not checked.

A scene that fails leaves the trial that shows most of it as DIR/SCENE/trial_K.h5 and .html, and the command that replays it. To put a
controller of one's own to the test: --set "controller={type: plugin, library: /path/to/mine.so}".

Examples:
  slipbench check scenes/grasp/*.yaml --junit check.xml
  slipbench check scenes/grasp/check_ptfe.yaml --set controller.debounce=2 --trials 5 -o check)";

constexpr std::string_view report_footer = R"(
One self-contained HTML file that opens in any browser, without a network.

Examples:
  slipbench report hexapod.h5
  slipbench report hexapod.h5 --trial 17 -o trial17.html)";

constexpr std::string_view export_footer = R"(
Formats of any sensor:
  csv           one table a trial and sensor, with a header: time, every channel, the true state by each rule
  npz           one numpy archive a trial, with every array of the dataset under its path there
  robomimic     one HDF5 file of demonstrations at one rate: observations, actions, rewards, masks
Formats of the PapillArray:
  vendor-csv    the log layout of the sensor vendor's own software, one file a trial
  training-csv  73 columns, no header, 1000 Hz, one file a trial: time, then contact, slip, displacement, force of each pillar
Format of grasps with three BioTac SP:
  grasp-csv     one file, a row a grasp: object, whether it slipped, the 72 electrodes before the lift
Format of a BioTac SP that slides, turns or rests:
  slip-csv      the layout of the public recordings, CLASS/OBJECT<trial>.csv: 24 electrodes, no time, 100 rows a second

Examples:
  slipbench export hexapod.h5 --format npz --trial 3 -o arrays
  slipbench export hexapod.h5 --format training-csv -o training
  slipbench export hexapod.h5 --format vendor-csv --slip paper -o logs)";

constexpr std::string_view hd_footer = R"(
Its memories are a folder of hex files, as detectors/hd/README.md explains.)";

constexpr std::string_view hd_replay_footer = R"(
Prints step,class,d1,d2,d3 as CSV: class 1 non-slip, 2 incipient, 3 gross, and the Hamming distances of the three; from the first step
on whose window is full. VECTORS.csv has the columns n (step), L0 to L8 (levels, 0 to 20) and ctx (context, 0 to 3); others are left alone.

DIR holds AM.hex, CIM.hex, CM.hex, IM.hex and model.txt. Without model.txt, as the published memories are, --encoder must be given and
ties go to one; with it, --encoder and --ties replace what it says. cl_gst_hd, where no folder has that name, is the classifier
that ships with the program.

Examples:
  slipbench hd replay vectors.csv --memories published --encoder published_core --ties one
  slipbench hd replay vectors.csv --memories published --encoder paper --ties zero --engine reference)";

constexpr std::string_view train_footer = R"(
Trains the hyperdimensional slip detector in a single pass. Six draws are made first, by sequence and, to compare, by frame: within each
compression and speed as many sequences are drawn with replacement as there are; those never drawn are the test. Draw 0 is for
choosing options, the other five make the figures. Then all sequences train the classifier that is saved.

Encoders: shdc (pillars of one frame), sthdc (over a window), gsthdc (with graphs, over a window). --context is gsthdc's default only.
Bundles: paper starts afresh with every frame, published_core keeps the counts of the pillars over a window, as the gripper's core does.
Labels: strict and micro are the truth (a pillar slips as a whole, or in part), paper is the published rule of tip speed;
with has_slipped a pillar that slipped so counts until it loses contact, whether it still moves or not.

Examples:
  slipbench train hexapod.h5 -o memories
  slipbench train hexapod.h5 --encoder shdc --labels strict -o plain)";

constexpr std::string_view eval_footer = R"(
Judges a trained classifier on every sequence of a dataset, also those that it was trained on, if they are there.
DIR is what `slipbench train` wrote; cl_gst_hd, where no folder has that name, is the classifier that ships with the program.

Examples:
  slipbench eval hexapod.h5 --memories memories
  slipbench eval hexapod.h5 --memories cl_gst_hd
  slipbench eval hexapod.h5 --memories memories --labels strict --json)";

constexpr std::string_view reproduce_footer = R"(
Without a name: what can be reproduced. With -o the table goes to FILE.html and all figures to FILE.json beside it.

Examples:
  slipbench reproduce
  slipbench reproduce hd-papillarray/table1 --data hexapod.h5 -o table1.html
  slipbench reproduce hd-papillarray/table2 --trials 2 --only as_recorded,light,rubber,gst_hd,hold_preset)";

constexpr std::string_view cost_footer = R"(
Runs a trial of the scene with other time steps, integrators, solvers, fidelities, numbers of elements and output rates, and with MuJoCo's own
contact in place of the field; measures the CPU time of each and how far onsets, slipped distances, forces, labels, the outcome and the detector
are from the closed form or from a far finer run; and what each effect and each part of the electronics costs and changes. It takes the
time of the budget. With -o the diagram goes to FILE.html and all figures to FILE.json beside it.
--stability measures the longest stable step over stiffness, mass and damping, beside the one that is predicted; a scene is not needed then.

Examples:
  slipbench cost scenes/papillarray/stage.yaml --budget 30s -o cost.html
  slipbench cost scenes/grasp/lift.yaml --set box.mass="0.5 kg" --json
  slipbench cost --stability -o stability.html)";

constexpr std::string_view list_footer = R"(
Examples:
  slipbench list
  slipbench list effects)";

constexpr std::string_view describe_footer = R"(
Generated from the declarations that the scene parser reads.

Examples:
  slipbench describe papillarray
  slipbench describe stage
  slipbench describe acrylic --json)";

constexpr std::string_view doctor_footer = R"(
Exit status 0 when everything required is there, 1 otherwise, with the command that installs it.)";

constexpr std::string_view plugin_path_footer = R"(
Any MuJoCo program of the right version can load the library; scenes/mujoco/README.md shows how.)";

// The footers above begin with a line end, which is there for the source only.
std::string footer_text(std::string_view footer) { return std::string(footer.substr(1)); }

// More threads than any machine has use for: each takes an address space of megabytes, so that thousands find no room.
constexpr std::size_t max_jobs = 1024;

// Reads a whole number from `min` to `max`.
template <class Integer>
Integer parse_integer(const std::string& command, const std::string& option, const std::string& text, Integer min,
                      Integer max = std::numeric_limits<Integer>::max()) {
  Integer value{};
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc{} || stop != end || text.empty() || value < min || value > max) {
    throw InputError(fmt::format("{}: {} is '{}'; allowed: a whole number from {} to {}", command, option, text, min, max));
  }
  return value;
}

constexpr std::array record_words{hd::Word<Recording>{"full", Recording::full},
                                  hd::Word<Recording>{"outcome", Recording::outcome}};

// Reads one of the words of a table.
template <class Words>
auto parse_word(const std::string& command, const std::string& option, const std::string& text, const Words& words) {
  const auto value = hd::value_of(words, text);
  if (!value) throw InputError(fmt::format("{}: {} is '{}'{}", command, option, text, allowed_names(text, hd::names_of(words))));
  return *value;
}

// Reads a speed above zero, in m/s or with its unit.
double parse_quantity(const std::string& command, const std::string& option, const std::string& text, Quantity quantity) {
  ParameterSpec spec;
  spec.name = option;
  spec.quantity = quantity;
  spec.range = positive;
  try {
    return std::get<double>(parse_scalar(spec, text));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}: {}", command, option, error.what()));
  }
}

Override parse_override(const std::string& command, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError(fmt::format("{}: --set '{}'; expected key=value, as in --set motion.speed=\"8 mm/s\"", command, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

// A scene key, then '=': what may follow the first value of --set.
bool looks_like_override(const std::string& word) {
  const auto is_key_character = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  };
  const std::size_t equals = word.find('=');
  return equals != std::string::npos && equals > 0 &&
         std::all_of(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(equals), is_key_character);
}

// "--set a=1 b=2 SCENE" and "--set a=1 --set b=2 SCENE" mean the same; the second form leaves no doubt where the values end.
std::vector<std::string> repeat_set(const std::vector<std::string>& arguments) {
  std::vector<std::string> result;
  bool inside = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (inside && looks_like_override(arguments[i])) result.emplace_back("--set");
    result.push_back(arguments[i]);
    if (arguments[i] == "--set" && i + 1 < arguments.size()) {
      result.push_back(arguments[++i]);
      inside = true;
    } else {
      inside = inside && looks_like_override(arguments[i]);
    }
  }
  return result;
}

// CLI11's view of the command line: numbers stay text, so that our own messages say what is allowed.
struct Parser {
  Options options;
  std::vector<std::string> sets;
  std::optional<std::string> seed, trials, jobs, trial, output, junit, format, slip_rule, label_speed, rate, compat, ties, record;
  std::optional<std::string> encoder, dimension, window, quantiser, budget;
  bool context = false;
  bool no_context = false;
  bool version = false;
  CLI::App app{"A physics testbench for tactile slip detection.", "slipbench"};

  Parser();
  CLI::App* command(const char* name, const char* summary, std::string_view footer) {
    return command(app, name, summary, footer);
  }
  CLI::App* command(CLI::App& parent, const char* name, const char* summary, std::string_view footer);
  CLI::App* simulation(const char* name, const char* summary, std::string_view footer, const char* trials_help);
  void overrides(CLI::App* sub);
  void choices(CLI::App* sub, const char* trials_help);
  void check();
  void learning();
  void labels(CLI::App* sub);
};

CLI::App* Parser::command(CLI::App& parent, const char* name, const char* summary, std::string_view footer) {
  CLI::App* sub = parent.add_subcommand(name, summary);
  sub->footer(footer_text(footer));
  sub->add_flag("--json", options.json, "Print one JSON object on stdout and nothing else there");
  sub->get_formatter()->column_width(26);
  return sub;
}

// What changes a scene.
void Parser::overrides(CLI::App* sub) {
  sub->add_option("--set", sets, "Replace or add a value of the scene, e.g. motion.speed=\"8 mm/s\"; several may follow")
      ->option_text("KEY=VALUE ...")
      ->allow_extra_args(false);
  sub->add_option("--seed", seed, "Seed of all random draws (default: the scene's own)")->option_text("N");
  sub->add_flag("--quiet", options.quiet, "No progress and no summary");
}

// What run, sweep and check choose trials by.
void Parser::choices(CLI::App* sub, const char* trials_help) {
  overrides(sub);
  sub->add_option("--trials", trials, trials_help)->option_text("N");
  sub->add_option("--jobs", jobs, "Worker threads, 1 to 1024 (default: one a hardware thread)")->option_text("N");
}

CLI::App* Parser::simulation(const char* name, const char* summary, std::string_view footer, const char* trials_help) {
  CLI::App* sub = command(name, summary, footer);
  sub->add_option("SCENE", options.scene, "Scene file (YAML)")->required()->option_text(" ");
  choices(sub, trials_help);
  sub->add_option("-o,--output", output, "Write the dataset (HDF5)")->option_text("FILE.h5");
  sub->add_option("--record", record, "What -o writes: everything (full, the default), or outcomes alone (outcome)")
      ->option_text("NAME");
  return sub;
}

void Parser::check() {
  CLI::App* sub = command("check", "Hold the trials of scenes against what they expect", check_footer);
  sub->add_option("SCENE", options.scenes, "Scene files (YAML)")->required()->option_text("...");
  choices(sub, "Number of random draws of each cell of the grid");
  sub->add_option("--junit", junit, "Write what was found as JUnit XML")->option_text("FILE.xml");
  sub->add_option("-o,--output", output, "Folder for the trials of failed checks (default: slipbench-check)")->option_text("DIR");
}

// What train and eval read a dataset by.
void Parser::labels(CLI::App* sub) {
  sub->add_option("--labels", slip_rule, fmt::format("Truth to learn: {} (default: paper)", fmt::join(slip_rule_names(), ", ")))
      ->option_text("RULE");
  sub->add_option("--sensor", options.sensor, "The scene's name of the sensor (default: the only one)")->option_text("NAME");
  sub->add_option("--jobs", jobs, "Worker threads, 1 to 1024 (default: one a hardware thread)")->option_text("N");
}

void Parser::learning() {
  CLI::App* train = command("train", "Train a slip detector on a dataset", train_footer);
  train->add_option("FILE", options.dataset, "Dataset (HDF5) with a PapillArray on a stage")->required()->option_text(" ");
  train->add_option("-o,--output", output, "Folder for the memories; always needed")->option_text("DIR");
  train->add_option("--encoder", encoder, fmt::format("{} (default: gsthdc)", fmt::join(hd::names_of(encoder_words), ", ")))
      ->option_text("NAME");
  train->add_flag("--context", context, "Bind with the context of the centre pillar's compression (default with gsthdc)");
  train->add_flag("--no-context", no_context, "Do not (default with shdc and sthdc)");
  train->add_option("--dimension", dimension, "Bits of a hypervector, 8 to 65535 (default: 1000)")->option_text("D");
  train->add_option("--window", window, "Frames at 100 Hz, 1 to 1000 (default: 15)")->option_text("N");
  train
      ->add_option("--compat", compat,
                   fmt::format("Whose bundle: {} (default: paper)", fmt::join(hd::names_of(hd::compat_words), ", ")))
      ->option_text("NAME");
  train
      ->add_option("--ties", ties,
                   fmt::format("What an even bundle gives: {} (default: one)", fmt::join(hd::names_of(hd::ties_words), ", ")))
      ->option_text("RULE");
  train
      ->add_option("--quantiser", quantiser,
                   fmt::format("How displacements become levels: {} (default: fixed_point)",
                               fmt::join(hd::names_of(hd::quantiser_words), ", ")))
      ->option_text("NAME");
  train->add_option("--seed", seed, "Seed of item memories and draws (default: 1)")->option_text("N");
  labels(train);

  CLI::App* eval = command("eval", "Judge a trained slip detector on a dataset", eval_footer);
  eval->add_option("FILE", options.dataset, "Dataset (HDF5) with a PapillArray on a stage")->required()->option_text(" ");
  eval->add_option("--memories", options.memories, "Folder of the classifier, or cl_gst_hd")->required()->option_text("DIR");
  labels(eval);

  CLI::App* reproduce = command("reproduce", "Reproduce a table of a paper", reproduce_footer);
  reproduce->add_option("PAPER/TABLE", options.name, "What to reproduce (default: list what there is)")->option_text(" ");
  reproduce->add_option("-o,--output", output, "Write the page, and FILE.json beside it")->option_text("FILE.html");
  reproduce->add_option("--trials", trials, "table2: trials of each row (default: 10); table4: recordings a level (200)")
      ->option_text("N");
  reproduce->add_option("--only", options.only, "table2: protocols, boxes, surfaces and loops to keep; table4: networks")
      ->option_text("NAME,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  reproduce->add_option("--memories", options.memories, "table2: folder of the published classifier")->option_text("DIR");
  reproduce->add_option("--data", options.data, "Use this dataset instead of a fresh one")->option_text("FILE.h5");
  reproduce->add_option("--seed", seed, "Seed of dataset, item memories and draws (default: 1)")->option_text("N");
  reproduce->add_option("--jobs", jobs, "Worker threads, 1 to 1024 (default: one a hardware thread)")->option_text("N");
  reproduce->add_flag("--synthesise", options.synthesise, "Run the synthesis instead of reading its stored figures");
  reproduce->add_flag("--quiet", options.quiet, "No progress");
}

Parser::Parser() {
  app.footer(footer_text(program_footer));
  app.add_flag("--version", version, "Print the version");
  app.add_flag("--json", options.json, "Print one JSON object on stdout and nothing else there");
  simulation("run", "Simulate one trial of a scene", run_footer, "Simulate N trials instead of one")
      ->add_option("--trial", trial, "Simulate trial K alone")
      ->option_text("K");
  simulation("sweep", "Simulate all trials of a scene's sweep", sweep_footer, "Number of random draws of each cell of the grid");

  check();

  CLI::App* report = command("report", "Turn a dataset into an HTML page", report_footer);
  report->add_option("FILE", options.dataset, "Dataset (HDF5)")->required()->option_text(" ");
  report->add_option("-o,--output", output, "Page to write (default: the dataset's name with .html)")->option_text("FILE.html");
  report->add_option("--trial", trial, "Trial to show in full (default: the first)")->option_text("K");

  CLI::App* exporting = command("export", "Write a dataset in another format", export_footer);
  exporting->add_option("FILE", options.dataset, "Dataset (HDF5)")->required()->option_text(" ");
  exporting->add_option("--format", format, fmt::format("{}, see below", fmt::join(export_format_names(), " or ")))
      ->required()
      ->option_text("NAME");
  exporting->add_option("-o,--output", output, "Folder to write into; always needed")->option_text("DIR");
  exporting
      ->add_option("--slip", slip_rule,
                   fmt::format("When a pillar counts as slipping: {} (default: strict)", fmt::join(slip_rule_names(), ", ")))
      ->option_text("RULE");
  exporting->add_option("--label-speed", label_speed, "Tip speed above which paper and has_slipped say slip (default: 0.1 mm/s)")
      ->option_text("SPEED");
  exporting->add_option("--sensor", options.sensor, "The scene's name of the sensor (default: all, or the only one)")
      ->option_text("NAME");
  exporting->add_option("--rate", rate, "Rate of robomimic's demonstrations, e.g. '100 Hz' (default: the slowest sensor's)")
      ->option_text("RATE");
  exporting->add_option("--trial", trial, "Trial to export (default: all)")->option_text("K");

  CLI::App* hd = command("hd", "Work with the hyperdimensional classifier", hd_footer);
  CLI::App* replay = command(*hd, "replay", "Classify quantised input step by step", hd_replay_footer);
  replay->add_option("VECTORS", options.vectors, "Quantised input (CSV)")->required()->option_text(" ");
  replay->add_option("--memories", options.memories, "Folder of the classifier, or cl_gst_hd")->required()->option_text("DIR");
  replay->add_option("--encoder", compat, fmt::format("Whose bundle: {}", fmt::join(hd::names_of(hd::compat_words), " or ")))
      ->option_text("NAME");
  replay
      ->add_option("--ties", ties,
                   fmt::format("A bundle that sums to zero becomes {}", fmt::join(hd::names_of(hd::ties_words), " or ")))
      ->option_text("NAME");
  replay->add_option("--engine", options.engine, fmt::format("{} (default: kernel)", fmt::join(hd_engine_names(), " or ")))
      ->option_text("NAME");

  learning();

  CLI::App* cost = command("cost", "Show what accuracy costs in time", cost_footer);
  cost->add_option("SCENE", options.scene, "Scene file (YAML)")->option_text(" ");
  cost->add_option("--budget", budget, "Time to spend, e.g. 60s or '2 min' (default: 60 s)")->option_text("TIME");
  cost->add_flag("--stability", options.stability, "Map the longest stable steps");
  overrides(cost);
  cost->add_option("--trial", trial, "Trial of the scene's sweep (default: the first)")->option_text("K");
  cost->add_option("-o,--output", output, "Write the page, and FILE.json beside it")->option_text("FILE.html");
  CLI::App* simulation = command("bench", "Count the instructions of the reference scenes", bench_footer);
  add_bench_options(*simulation, options.simulation);
  simulation->add_option("-o,--output", output, "Write the results, and FILE.svg beside them")->option_text("FILE.json");
  simulation->add_option("--jobs", jobs, "Scenes counted at a time, 1 to 1024 (default: 1)")->option_text("N");
  simulation->add_flag("--quiet", options.quiet, "No progress");

  CLI::App* list = command("list", "List what a scene may name", list_footer);
  list->add_option(
          "CATALOGUE", options.name,
          "effects, sensors, surfaces, bodies, materials, motions, electronics, grasp, contact, detectors, controllers or expectations (default: all)")
      ->option_text(" ");
  CLI::App* describe = command("describe", "Explain one name: parameters, units, defaults, law, source", describe_footer);
  describe->add_option("NAME", options.name, "A name that `slipbench list` shows")->required()->option_text(" ");
  command("doctor", "Check the installation", doctor_footer);
  command("plugin-path", "Print where the MuJoCo plugin is", plugin_path_footer);

  app.get_formatter()->column_width(26);
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// A word that CLI11 had no place for.
InputError unexpected(const CLI::App& app, const std::string& command, const std::string& word) {
  const std::string prefix = command.empty() ? "" : command + ": ";
  if (word.rfind('-', 0) != 0) {
    return InputError(fmt::format("{}unexpected argument '{}'; see slipbench {} --help", prefix, word, command));
  }
  const std::vector<std::string> names = option_names(app);
  const std::string name = word.substr(0, word.find('='));
  return InputError(
      fmt::format("{}unknown option '{}'{} options: {}", prefix, name, suggestion(name, names), fmt::join(names, ", ")));
}

// The commands of a program or of a command, in the order the help shows them.
std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

// The innermost command given and its full name: "run", "hd replay"; the program itself and "" where there is none.
std::pair<const CLI::App*, std::string> chosen_command(const CLI::App& app) {
  std::pair<const CLI::App*, std::string> chosen{&app, ""};
  while (!chosen.first->get_subcommands().empty()) {
    chosen.first = chosen.first->get_subcommands().front();
    chosen.second += (chosen.second.empty() ? "" : " ") + chosen.first->get_name();
  }
  return chosen;
}

// Of the command line's fixed part: later versions have them.
constexpr std::array<std::string_view, 2> later_commands{"import", "view"};

void refuse_unknown_command(const std::vector<std::string>& arguments) {
  const auto word = std::find_if(arguments.begin(), arguments.end(), [](const std::string& a) { return a.rfind('-', 0) != 0; });
  const std::vector<std::string> names = command_names();
  if (word == arguments.end() || std::find(names.begin(), names.end(), *word) != names.end()) return;
  if (std::find(later_commands.begin(), later_commands.end(), *word) != later_commands.end()) {
    throw InputError(fmt::format("command '{}' is not available in this version; available: {}", *word, fmt::join(names, ", ")));
  }
  throw InputError(fmt::format("unknown command '{}'{} commands: {}", *word, suggestion(*word, names), fmt::join(names, ", ")));
}

}  // namespace

std::vector<std::string> command_names() {
  const Parser parser;
  return subcommand_names(parser.app);
}

Options parse_options(const std::vector<std::string>& arguments) {
  refuse_unknown_command(arguments);
  Parser parser;
  Options& options = parser.options;
  if (arguments.empty()) {
    options.help = parser.app.help();
    return options;
  }
  std::vector<std::string> words = repeat_set(arguments);
  std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
  const auto prefix = [&parser] {
    const std::string name = chosen_command(parser.app).second;
    return name.empty() ? name : name + ": ";
  };
  try {
    parser.app.parse(words);
  } catch (const CLI::CallForHelp&) {
    options.help = parser.app.help();
    return options;
  } catch (const CLI::ExtrasError&) {
    const auto [app, name] = chosen_command(parser.app);
    throw unexpected(*app, name, parser.app.remaining(true).front());
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string message = error.what();  // "--output: 1 required TEXT missing"
    throw InputError(fmt::format("{}{} needs one value", prefix(), message.substr(0, message.find(':'))));
  } catch (const CLI::ParseError& error) {
    throw InputError(prefix() + error.what());
  }
  if (parser.version) {
    options.command = "--version";
    return options;
  }
  const auto [chosen, name] = chosen_command(parser.app);
  if (const std::vector<std::string> further = subcommand_names(*chosen); !further.empty()) {
    throw InputError(fmt::format("{}no command given; commands: {}", prefix(), fmt::join(further, ", ")));
  }
  options.command = name;
  const std::string& command = options.command;
  for (const std::string& text : parser.sets) options.overrides.push_back(parse_override(command, text));
  if (parser.seed) options.seed = parse_integer<std::uint64_t>(command, "--seed", *parser.seed, 0);
  if (parser.trials) options.trials = parse_integer<std::size_t>(command, "--trials", *parser.trials, 1);
  if (parser.jobs) options.jobs = parse_integer<std::size_t>(command, "--jobs", *parser.jobs, 1, max_jobs);
  if (parser.trial) options.trial = parse_integer<std::size_t>(command, "--trial", *parser.trial, 0);
  if (parser.format) options.format = parse_export_format(*parser.format);
  if (parser.output && parser.output->empty()) {
    const bool folder = command == "export" || command == "train" || command == "check";
    throw InputError(fmt::format("{}: -o needs a {} name", command, folder ? "folder" : "file"));
  }
  if (parser.output) options.output = *parser.output;
  if (parser.junit && parser.junit->empty()) throw InputError(command + ": --junit needs a file name");
  if (parser.junit) options.junit = *parser.junit;
  if (parser.record) {
    options.record = parse_word(command, "--record", *parser.record, record_words);
    if (options.output.empty()) throw InputError(command + ": --record says what -o writes; allowed: with -o");
  }
  // Asked for here and not by CLI11, so that a wrong format is named first.
  if ((command == "export" || command == "train") && options.output.empty()) throw InputError(command + ": --output is required");
  if (command == "train" || command == "eval") options.slip_rule = SlipRule::paper;
  if (parser.slip_rule) options.slip_rule = parse_slip_rule(*parser.slip_rule);
  if (parser.label_speed) options.label_speed = parse_quantity(command, "--label-speed", *parser.label_speed, Quantity::speed);
  if (parser.rate) options.rate = parse_quantity(command, "--rate", *parser.rate, Quantity::frequency);
  if (parser.budget) options.budget = parse_quantity(command, "--budget", *parser.budget, Quantity::time);
  if (command == "cost" && options.scene.empty() && !options.stability) {
    throw InputError("cost: a scene is missing; allowed: SCENE.yaml, --stability, or both");
  }
  if (parser.compat) {
    options.hd_compat = parse_word(command, command == "train" ? "--compat" : "--encoder", *parser.compat, hd::compat_words);
  }
  if (parser.ties) options.hd_ties = parse_word(command, "--ties", *parser.ties, hd::ties_words);
  if (parser.encoder) options.model.encoding = parse_word(command, "--encoder", *parser.encoder, encoder_words);
  if (parser.context && parser.no_context) throw InputError(command + ": --context and --no-context exclude each other");
  const bool graphs = options.model.encoding == hd::Encoding::graph_spatial_temporal;
  options.model.context_driven = parser.context || (graphs && !parser.no_context);
  if (parser.dimension) options.model.dimension = parse_integer<std::size_t>(command, "--dimension", *parser.dimension, 8, 65535);
  if (parser.window) options.model.window = parse_integer<std::size_t>(command, "--window", *parser.window, 1, 1000);
  if (parser.quantiser) options.quantiser = parse_word(command, "--quantiser", *parser.quantiser, hd::quantiser_words);
  return options;
}

}  // namespace slipbench

#include "tools/cli/commands/dataset_commands.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/counted.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/process/own_library.h"
#include "sim/mujoco/releases/release_table.h"
#include "tools/cli/arguments.h"
#include "tools/cli/format/describe.h"
#include "tools/cli/format/describe_key.h"
#include "tools/cli/format/schema.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/json.h"
#include "tools/doctor/doctor.h"
#include "tools/eval/shipped_networks.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"
#include "tools/learning_data/label_rules.h"
#include "tools/registry/program_catalogues.h"
#include "tools/train/recipe_list.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/verify/verify.h"
#include "tools/workers/interrupt_guard.h"
#include "tools/workers/python_package/python_package.h"

namespace slipbench {
namespace {

constexpr std::array<std::string_view, 2> schema_kinds{"map", "scene"};

// A folder may hold thousands of recordings.
constexpr std::size_t most_import_warnings = 10;

void say_failed(const std::string& dataset) {
  if (const std::string text = failed_text(dataset); !text.empty()) say(stderr, fmt::format("slipbench: {}\n", text));
}

// Returns the text of a value from a dataset, made safe for a terminal: the file may be untrusted.
std::string text_of(const Json& value) { return printable(value.get<std::string>()); }

// "trial 3, labels/pad/force, sample 17: ".
std::string place_of(const Json& failure) {
  std::string place;
  const auto add = [&place](const std::string& part) { place += (place.empty() ? "" : ", ") + part; };
  if (!failure["trial"].is_null()) add(fmt::format("trial {}", failure["trial"].get<std::size_t>()));
  if (!failure["array"].is_null()) add(text_of(failure["array"]));
  if (!failure["sample"].is_null()) add(fmt::format("sample {}", failure["sample"].get<std::size_t>()));
  return place.empty() ? "" : place + ": ";
}

std::string report_of(const Json& dataset, const Style& style) {
  const bool holds = dataset["holds"].get<bool>();
  std::string text =
      fmt::format("{} {}: {} in {}{}\n", holds ? style.good("ok:") : style.error("failed:"), text_of(dataset["file"]),
                  counted(dataset["trials"].get<std::size_t>(), "trial"), counted(dataset["files"].size(), "file"),
                  dataset["complete"].get<bool>() ? "" : ", of an unfinished run");
  for (const Json& check : dataset["checks"]) {
    const std::string name = check["check"].get<std::string>();
    const auto failed = check["failed"].get<std::size_t>();
    const auto checked = check["checked"].get<std::size_t>();
    std::string items = check["of"].get<std::string>();  // such as "samples of units"
    if (checked == 1) items.erase(std::min(items.find(' '), items.size()) - 1, 1);
    text += fmt::format("  {:<8} {:>12} {}{}\n", name, checked, items,
                        failed == 0 ? "" : ", " + style.error(fmt::format("{} failed", failed)));
    for (const Json& failure : dataset["failures"]) {
      if (failure["check"] == name) text += fmt::format("    {}{}\n", place_of(failure), text_of(failure["what"]));
    }
    for (const Json& reason : check["left_out"]) text += fmt::format("    {} {}\n", style.dim("skipped:"), text_of(reason));
  }
  return text;
}

std::string sweep_report(const Json& sweep, const Style& style) {
  std::string text = fmt::format("{} {} of one sweep", sweep["holds"].get<bool>() ? style.good("ok:") : style.error("failed:"),
                                 counted(sweep["shards"].get<std::size_t>(), "shard"));
  if (!sweep["trials"].is_null()) text += ": " + counted(sweep["trials"].get<std::size_t>(), "trial");
  if (!sweep["duplicates"].is_null() && sweep["duplicates"] != 0) {
    const auto duplicates = sweep["duplicates"].get<std::size_t>(), within = sweep["within_rounding"].get<std::size_t>();
    text += fmt::format(", {} of them in several files", duplicates);
    if (within < duplicates) text += fmt::format("; {} are bit-identical", duplicates - within);
    if (within > 0) text += fmt::format("; {} agree within 1e-9 (computed by MuJoCo, FFTW or a network)", within);
  }
  text += "\n";
  for (const Json& failure : sweep["failures"]) text += fmt::format("  {}\n", text_of(failure));
  return text;
}

}  // namespace

std::string failed_text(const std::string& dataset) {
  const DatasetReader reader = dataset_header_at(dataset);
  const std::string text = failures_text(reader.failed(), reader.trials().size() + reader.failed().size());
  return text.empty() ? "" : fmt::format("{}: {}; the attribute `failed` of the dataset gives the reasons", dataset, text);
}

void ReportCommand::declare(Arguments& arguments) {
  arguments.about("report", "Turn a dataset into an HTML page", R"(
Writes a self-contained HTML file that opens in any browser, without a network. The page of
recordings without truth (slipbench import) shows their signals over time, a table with rates and
gaps, and their recorded labels.

Examples:
  slipbench report hexapod.h5
  slipbench report hexapod.h5 --trial 17 -o trial17.html)");
  arguments.input("FILE", dataset, "Dataset (HDF5)", ".h5").required();
  arguments.output("-o,--output FILE.html", output,
                   "Page to write, or - for standard output (default: name of the dataset with .html)");
  arguments.number("--trial K", options.trial, "Trial to show in detail (default: the first)", 0);
}

int ReportCommand::run() {
  const std::string page = output.empty() ? report_path(dataset) : output;
  {
    const InterruptGuard guard("stopping; nothing is kept");
    const InterruptScope scope(&InterruptGuard::flag());
    write_report(dataset, page, options);
  }
  say_failed(dataset);
  if (json) return print_json({{"report", page}});
  if (streams()) return exit_good;
  print_written({page});
  print_text("{} open it in a browser\n", style_for(stdout).dim("next:"));
  return exit_good;
}

void ExportCommand::declare(Arguments& arguments) {
  arguments.about("export", "Write a dataset in another format", R"(
Formats of any sensor:
  csv           one table per trial and sensor, with a header: time, all channels, true state by each rule
  npz           one NumPy archive per trial, with every array of the dataset under its path
  robomimic     one HDF5 file of demonstrations at one rate: observations, actions, rewards, masks
  lerobot       one LeRobotDataset v3.0 per sensor rate: observations, actions, and labels as features
  parquet       one table of columns per sensor, with all trials, for pandas, polars and DuckDB
  mcap          one recording per trial, with each sensor, label, pose and command at its own rate,
                for Foxglove and Lichtblick
  rosbag2       one ROS 2 bag per trial, with the messages of the PapillArray's driver, and the truth
                on separate topics
Formats of the PapillArray:
  vendor-csv    the log format of the vendor's software, one file per trial
  training-csv  73 columns, no header, 1000 Hz, one file per trial: time, then contact, slip,
                displacement and force of each pillar
Formats of the Myrmex:
  myrmex-csv    only counts, one image per line, one file per trial and sensor
  myrmex-rotated npz with the images rotated in steps of 30 degrees, as in the published training
Format of grasps with three BioTac SP:
  grasp-csv     one file with one row per grasp: object, whether it slipped, and the 72 electrodes
                before the lift
Format of a BioTac SP that slides, turns or rests:
  slip-csv      the format of the public recordings, CLASS/OBJECT<trial>.csv: 24 electrodes without
                time, 100 rows per second

Examples:
  slipbench export hexapod.h5 --format npz --trial 3 -o arrays
  slipbench export hexapod.h5 --format training-csv -o training
  slipbench export hexapod.h5 --format vendor-csv --slip paper -o logs)");
  arguments.input("FILE", dataset, "Dataset (HDF5)", ".h5").required();
  arguments
      .read("--format NAME", "Format to write (see the list below)",
            [this](const std::string& name) { options.format = parse_export_format(name); })
      .offers(export_format_names)
      .required();
  arguments.folder("-o,--output DIR", output, "Folder to write into (required)").required();
  arguments.read(
      "--labels,--slip RULE",
      fmt::format(
          "Rule by which a unit slips: {}, or recorded (labels of recordings) (default: all rules; formats of the PapillArray: strict)",
          fmt::join(label_rule_names(LabelUse::pillars), ", ")),
      [this](const std::string& name) { set_label_rule(options, name); });
  arguments.quantity("--label-speed SPEED", options.label_speed,
                     "Tip speed above which a pillar slips by the rules paper and has_slipped (default: 0.1 mm/s)",
                     Quantity::speed);
  arguments.texts("--sensors,--sensor NAME,...", options.sensors,
                  "Names of sensors in the scene (default: all; formats for one sensor: the only one)");
  arguments.quantity(
      "--rate RATE", options.rate,
      "Rate of the rows, e.g. '100 Hz'; each row has the latest values (default: rate of each sensor; robomimic: the slowest)",
      Quantity::frequency);
  arguments.text("--split PART", options.split, "Export only the trials of train, valid or test (default: all)");
  arguments.number("--trial K", options.trial, "Trial to export (default: all)", 0);
  arguments.text("--licence NAME", options.licence,
                 "Licence of the data for the dataset card, e.g. cc-by-4.0 (default: not stated)");
  arguments.flag("--points", options.points, "lerobot: add x, y, z, fx, fy, fz of each unit as observation.tactile.SENSOR");
  arguments.flag("-q,--quiet", quiet, "Print no progress and no summary");
  arguments.flag("-v,--verbose", verbose, "Print the name of every file that is written");
  arguments.flag("--compress", options.compress, "Write .csv.gz instead of .csv; robomimic: compress the arrays");
}

int ExportCommand::run() {
  check_export_options(options);
  const std::optional<PythonModule> python = python_writer();
  std::vector<std::string> files;
  if (!is_python_format(options.format)) {
    check_card_target(output);
    const InterruptGuard guard("stopping after this trial");
    const InterruptScope scope(&InterruptGuard::flag());
    // The progress is destroyed before an error is reported.
    const auto bar = std::make_shared<ExportBar>(silent());
    files = export_dataset(dataset, output, options,
                           [bar](std::size_t done, std::size_t total, std::uintmax_t bytes) { bar->update(done, total, bytes); });
  }
  say_failed(dataset);
  if (python) {
    take_stdout_back();
    python->start({{"export", export_request(dataset, output, options, files)},
                   {"json", json},
                   {"quiet", quiet},
                   {"verbose", verbose},
                   {"install", python->install()}});
  }
  print_export(files, output, {.json = json, .quiet = quiet, .verbose = verbose});
  return exit_good;
}

// The module that writes the format, or else the card. Empty, with a note, if only the card needs
// it and the program has no Python.
std::optional<PythonModule> ExportCommand::python_writer() const {
  const bool writes_format = is_python_format(options.format);
  try {
    return PythonModule("slipbench._export",
                        writes_format ? "--format " + export_format_name(options.format) : std::string("the dataset card"),
                        writes_format ? "export" : "");
  } catch (const InputError& error) {
    if (writes_format || !options.licence.empty()) throw;
    say(stderr, fmt::format("slipbench: note: README.md and croissant.json were not written: {}\n", error.what()));
    return std::nullopt;
  }
}

std::string size_text(std::uintmax_t bytes) {
  auto value = static_cast<double>(bytes);
  constexpr std::array units{"B", "kB", "MB", "GB"};
  std::size_t unit = 0;
  for (; value >= 999.5 && unit + 1 < units.size(); ++unit) value /= 1000.0;
  return fmt::format("{:.3g} {}", value, units[unit]);
}

void ExportBar::update(std::size_t done, std::size_t total, std::uintmax_t bytes) {
  if (quiet_) return;
  if (done == 1 && total > 1) say(stderr, fmt::format("{}, about {}\n", counted(total, "trial"), size_text(bytes * total)));
  progress_.update(done, total, std::nullopt);
}

void print_export(const std::vector<std::string>& files, const std::string& folder, const ExportOutput& how) {
  if (how.json) {
    print_json({{"files", files}});
    return;
  }
  if (how.quiet) return;
  if (how.verbose) print_written(files);
  std::uintmax_t bytes = 0;
  for (const std::string& file : files) bytes += std::filesystem::file_size(file);
  const std::string what = files.size() == 1 ? files.front() : fmt::format("{} files", files.size());
  print_text("{} {}, {}{}\n", style_for(stdout).good("written:"), what, size_text(bytes),
             files.size() == 1 ? "" : ", in " + folder);
}

void ImportCommand::declare(Arguments& arguments) {
  arguments.about("import", "Read recordings of real sensors into a dataset",
                  fmt::format(
                      R"(
A dataset of recordings has readings but no truth. If the recordings state when slip occurs, these
states become recorded labels, which `slipbench eval` uses (--labels recorded).

--map MAP describes recordings of any sensor: which columns, arrays or message fields are channels,
times, labels and objects. It reads tables (.csv, .tsv, .txt, .dat), Parquet, .npz, .npy, MCAP and
bags of ROS 1 and ROS 2. MAP is a YAML file or one of the included maps:
{}
--draft TYPE writes a map for a table of text: it finds the columns by their titles, and marks what
you should check. TYPE is the type of the sensor: papillarray, magnetic_skin, biotac_sp, taxels, ...

Formats without a map:
{}
Examples:
  slipbench import logs --format papillarray-csv -o recorded.h5
  slipbench import training --format training-csv -o published.h5 --seed 3
  slipbench import mine/press.csv --draft taxels -o columns.yaml
  slipbench import mine --map columns.yaml -o mine.h5)",
                      wrap_text(SLIPBENCH_IMPORT_MAPS ".", 100, 0), import_formats_text()));
  arguments.inputs("SOURCE ...", options.sources, "Files, or folders with recordings").required();
  arguments
      .read("--format NAME", "Format of SOURCE, see the list below (default: as --map describes)",
            [this](const std::string& name) { options.format = chosen_import_format(name); })
      .offers(import_format_names);
  arguments.input("--map MAP", options.map, "Description of the recordings: a YAML file, or the name of an included map");
  arguments.text("--draft TYPE", draft, "Write a map of SOURCE for this type of sensor to the file of -o, instead of importing");
  arguments.quantity("--rate RATE", options.rate,
                     "Resample at this rate, e.g. '100 Hz', by linear interpolation without a filter (default: as recorded)",
                     Quantity::frequency);
  arguments.file("-o,--output FILE.h5", options.output, "Dataset to write (default: only check the sources)");
  arguments.flag("-v,--verbose", options.verbose, "Print all warnings, not only the first ten (formats without --map)");
  arguments.number("--seed N", options.seed, "Seed of the split into train, valid and test (default: 1)", 0);
  arguments.then([this] {
    if (!draft.empty() && (options.format != nullptr || !options.map.empty() || options.rate || json))
      reject("import: --draft writes a map; expected only -o FILE.yaml next to it");
    if (draft.empty()) check_import_options(options);
  });
}

int ImportCommand::run() {
  if (!draft.empty()) draft_map();
  if (options.format == nullptr) import_by_map();
  const ImportSummary summary = [this] {
    const InterruptGuard guard("stopping; nothing is kept");
    const InterruptScope scope(&InterruptGuard::flag());
    return import_recordings(options);
  }();
  print_import(summary, options, json);
  return exit_good;
}

// Continues in Python, which reads the map.
void ImportCommand::import_by_map() {
  const PythonModule module("slipbench._import", "import --map", "import");
  const Json request{{"sources", options.sources},
                     {"map", options.map},
                     {"output", options.output},
                     {"seed", options.seed},
                     {"rate", options.rate ? Json(*options.rate) : Json()},
                     {"json", json},
                     {"install", module.install()}};
  take_stdout_back();
  module.start(request);
}

// Python reads the table.
void ImportCommand::draft_map() {
  const PythonModule module("slipbench._import.draft", "import --draft", "import");
  const Json request{{"sources", options.sources}, {"type", draft}, {"output", options.output}, {"install", module.install()}};
  take_stdout_back();
  module.start(request);
}

namespace {

// Returns a detector that reads these channels of a sensor: an included network, force_ratio or
// deviation, which reads any channel.
std::string detector_for(const std::string& type, const std::set<std::string>& channels) {
  for (const eval::ShippedNetwork& network : eval::shipped_networks) {
    if (type != network.sensor || network.first_choice == nullptr || !channels.contains(network.first_choice)) continue;
    try {
      return shell_word(project_file(network.path));
    } catch (const InputError&) {  // not installed
    }
  }
  return channels.contains("force") ? "force_ratio" : "deviation";
}

}  // namespace

void print_import(const ImportSummary& summary, const ImportOptions& options, bool json) {
  const std::size_t shown = options.verbose ? summary.warnings.size() : std::min(summary.warnings.size(), most_import_warnings);
  print_warnings({summary.warnings.begin(), summary.warnings.begin() + static_cast<std::ptrdiff_t>(shown)});
  if (shown < summary.warnings.size()) {
    say(stderr, fmt::format("slipbench: {} of this kind; --verbose prints all of them\n",
                            counted(summary.warnings.size() - shown, "more warning")));
  }
  if (json) {
    print_json(import_json(summary));
    return;
  }
  print_text("{} of {}, {}{}\n", counted(summary.trials, "recording"), counted(summary.sources, "file"),
             counted(summary.samples, "sample"), summary.objects.empty() ? "" : ", " + counted(summary.objects.size(), "object"));
  if (summary.repeated_rows > 0)
    print_text("{} skipped, because the previous row is identical\n", counted(summary.repeated_rows, "row"));
  if (options.rate) {
    print_text("resampled at {} by linear interpolation\n", format_quantity(*options.rate, Quantity::frequency));
  }
  print_written(summary.files);
  if (summary.files.empty()) {
    say(stderr, "slipbench: nothing was written\n");
  } else {
    print_next("slipbench verify " + shell_word(summary.files.front()));
    if (!options.map.empty() && summary.channels.size() == 1) {
      const auto& [type, channels] = *summary.channels.begin();
      print_next("slipbench detect " + detector_for(type, channels) + " " + shell_word(summary.files.front()));
    }
  }
}

void VerifyCommand::declare(Arguments& arguments) {
  arguments.about("verify", "Check datasets for errors", R"(
Checks the digests, order and masks of the trials, their times, and Coulomb's law in their labels.
Checks that all values are finite, and that events agree with onset times and states. Shards of a
sweep (sweep --shard k/n) are also compared with each other: they must belong to one sweep, no trial
may be missing, and repeated trials must have equal digests. Prints what was checked, what was
skipped and why, and each error with trial, array and sample. Exit status 1: an error was found; 2:
a file cannot be read.

Examples:
  slipbench verify hexapod.h5
  slipbench verify shard-1.h5 shard-2.h5
  slipbench verify hexapod.h5 --json)");
  arguments.inputs("FILE ...", datasets, "Datasets (HDF5); for split datasets the first file", ".h5").required();
}

int VerifyCommand::run() {
  const Verified verified = verify_datasets(datasets);
  const Style style = style_for(stdout);
  if (json) print_json(verified_json(verified));
  for (const Json& dataset : verified.datasets) {
    if (dataset.contains("error")) {
      say(stderr,
          fmt::format("{} {}\n", style_for(stderr).error("slipbench:"), printable(dataset["error"].get<std::string>(), true)));
    } else if (!json) {
      print_text("{}", dataset.contains("part_of") ? fmt::format("verified with the first file: {}\n", text_of(dataset["file"]))
                                                   : report_of(dataset, style));
    }
  }
  if (!json && !verified.sweep.is_null()) print_text("{}", sweep_report(verified.sweep, style));
  if (!verified.readable) return exit_bad_input;
  return verified.holds ? exit_good : exit_check_failed;
}

void ListCommand::declare(Arguments& arguments) {
  arguments.about("list", "List the names that scenes and train --recipe accept", R"(
Examples:
  slipbench list
  slipbench list effects
  slipbench list recipes)");
  arguments
      .text(
          "CATALOGUE", catalogue,
          "effects, sensors, surfaces, bodies, materials, motions, electronics, grasp, contact, detectors, controllers, expectations or recipes (default: all)")
      .offers([] {
        std::vector<std::string> names{"recipes"};
        for (const CatalogueKind& kind : catalogue_kinds()) names.emplace_back(kind.plural);
        return names;
      });
}

int ListCommand::run() {
  const std::vector<CatalogueItem> items = catalogue_items(program_catalogues());
  std::vector<CatalogueKind> kinds;
  if (catalogue.empty()) kinds.assign(catalogue_kinds().begin(), catalogue_kinds().end());
  const bool recipes = catalogue.empty() || catalogue == "recipes";
  if (!recipes) kinds = {find_kind(catalogue)};
  if (json) {
    Json lists = list_json(items, kinds);
    if (recipes) lists["recipes"] = recipe_list_json();
    return print_json(lists);
  }
  const Style style = style_for(stdout);
  const std::size_t width = terminal_width(stdout);
  print_text("{}{}{}", list_text(items, kinds, style, width), kinds.empty() || !recipes ? "" : "\n",
             recipes ? recipe_list_text(style, width) : "");
  return exit_good;
}

void DescribeCommand::declare(Arguments& arguments) {
  arguments.about("describe", "Explain a name: parameters, units, defaults, law, source", R"(
Examples:
  slipbench describe papillarray
  slipbench describe stage
  slipbench describe split
  slipbench describe acrylic --json
  slipbench describe piezo_fft_gru)");
  arguments.text("NAME", name, "Name shown by `slipbench list`, or a key of a scene").required().offers([] {
    std::vector<std::string> names = train::recipe_names();
    for (const std::string& key : scene_key_names()) names.push_back(key);
    for (const CatalogueItem& item : catalogue_items(program_catalogues())) names.push_back(item.entry.name);
    return names;
  });
}

int DescribeCommand::run() {
  const Catalogues catalogues = program_catalogues();
  if (train::is_recipe(name)) {
    const PythonModule module("slipbench._recipe", "describe " + name, "");
    take_stdout_back();
    module.start({{"name", name}, {"json", json}});
  }
  const std::vector<CatalogueItem> items = catalogue_items(catalogues);
  const std::vector<std::string> keys = scene_key_names();
  const bool in_catalogue = std::ranges::any_of(items, [this](const CatalogueItem& item) { return item.entry.name == name; });
  if (!in_catalogue && std::ranges::find(keys, name) != keys.end()) {
    const Json schema = scene_schema(catalogues);
    if (json) return print_json({{"name", name}, {"entries", Json::array({describe_key_json(name, schema)})}});
    print_text("{}", describe_key_text(name, schema, style_for(stdout), terminal_width(stdout)));
    return exit_good;
  }
  std::vector<std::string> others = train::recipe_names();
  others.insert(others.end(), keys.begin(), keys.end());
  const std::vector<CatalogueItem> found = find_items(items, name, others);
  if (json) {
    Json entries = Json::array();
    for (const CatalogueItem& item : found) entries.push_back(describe_json(item, catalogues));
    return print_json({{"name", name}, {"entries", entries}});
  }
  const Style style = style_for(stdout);
  for (std::size_t i = 0; i < found.size(); ++i)
    print_text("{}{}", i == 0 ? "" : "\n", describe_text(found[i], catalogues, style, terminal_width(stdout)));
  return exit_good;
}

void SchemaCommand::declare(Arguments& arguments) {
  arguments.about("schema", "Print the JSON Schema of scenes or of import maps", R"(
Editors use the schema to check and complete files. A scene names its schema in its first line, by
the path relative to its folder:
# yaml-language-server: $schema=scene.schema.json
The output is JSON with and without --json.

Examples:
  slipbench schema > scene.schema.json
  slipbench schema map > map.schema.json)");
  arguments.text("KIND", schema_kind, "Schema to print: scene, or map (files of import --map) (default: scene)").offers([] {
    return std::vector<std::string>{schema_kinds.begin(), schema_kinds.end()};
  });
}

int SchemaCommand::run() {
  if (std::ranges::find(schema_kinds, schema_kind) == schema_kinds.end())
    reject("schema: unknown kind {}{}", quote(schema_kind), allowed_names(schema_kind, schema_kinds));
  take_stdout_back();
  if (schema_kind == "map") PythonModule("slipbench._import.schema", "schema map", "").start({});
  constexpr int indent = 1;
  fmt::print("{}\n", scene_schema(program_catalogues()).dump(indent));
  return exit_good;
}

void DoctorCommand::declare(Arguments& arguments) {
  arguments.about("doctor", "Check the installation", R"(
Prints what is installed, and the commands that install what is missing. Exit status 0 if everything
required is installed, otherwise 1.)");
}

int DoctorCommand::run() {
  take_stdout_back();
  return doctor_main(json);
}

void PluginPathCommand::declare(Arguments& arguments) {
  arguments.about("plugin-path", "Print the path of the MuJoCo plugin", R"(
The path is for `mj_loadPluginLibrary` of every supported release of MuJoCo. For a release that
the plugin does not know, --mujoco prints the command that adds it. scenes/mujoco/README.md explains
the plugin.)");
  arguments.text("--mujoco VERSION", mujoco, "Check that the plugin supports this release, such as 3.17.0");
}

int PluginPathCommand::run() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path front = own_path(SLIPBENCH_PLUGIN);
  if (!fs::exists(front, error)) {
    reject(
        "the MuJoCo plugin {} does not exist; `./slipbench plugin-path` builds it if MuJoCo is installed (see `slipbench doctor`)",
        front.string());
  }
  const fs::path path = fs::canonical(front);
  const std::string folder = path.parent_path().string();
  if (!mujoco.empty() && !find_layout(mujoco, folder)) reject("--mujoco {}: {}", mujoco, how_to_add(mujoco, folder, ""));
  if (json) return print_json({{"plugin", path.string()}});
  fmt::print("{}\n", path.string());
  return exit_good;
}

}  // namespace slipbench

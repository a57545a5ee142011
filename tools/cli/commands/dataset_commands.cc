#include "tools/cli/commands/dataset_commands.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/process/interrupted.h"
#include "sim/core/process/own_library.h"
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
#include "tools/files/counted.h"
#include "tools/files/reject.h"
#include "tools/plugin/plugin_builds.h"
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

// Which trials of its run a dataset does not hold.
void say_failed(const std::string& dataset) {
  const DatasetReader reader = dataset_header_at(dataset);
  const std::string text = failures_text(reader.failed(), reader.trials().size() + reader.failed().size());
  if (!text.empty()) say(stderr, fmt::format("slipbench: {}: {}; the dataset says why in its attribute failed\n", dataset, text));
}

// "318 MB"
std::string size_text(std::uintmax_t bytes) {
  auto value = static_cast<double>(bytes);
  constexpr std::array units{"B", "kB", "MB", "GB"};
  std::size_t unit = 0;
  for (; value >= 999.5 && unit + 1 < units.size(); ++unit) value /= 1000.0;
  return fmt::format("{:.3g} {}", value, units[unit]);
}

// Says after the first trial how much there will be, and then how far it is.
ExportProgress progress_of(bool quiet) {
  if (quiet) return {};
  const std::shared_ptr<Progress> bar(new Progress(Progress::for_stream(stderr, false)));  // which cannot be moved
  return [bar](std::size_t done, std::size_t total, std::uintmax_t bytes) {
    if (done == 1 && total > 1) {
      say(stderr, fmt::format("{} trials, about {}\n", total, size_text(bytes * total)));
    }
    bar->update(done, total, std::nullopt);
  };
}

// The text of a dataset's value, as a terminal may get it: it comes from a file.
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
      fmt::format("{} {}: {} in {}{}\n", holds ? style.good("holds:") : style.error("does not hold:"), text_of(dataset["file"]),
                  counted(dataset["trials"].get<std::size_t>(), "trial"), counted(dataset["files"].size(), "file"),
                  dataset["complete"].get<bool>() ? "" : ", of a run that did not come to its end");
  for (const Json& check : dataset["checks"]) {
    const std::string name = check["check"].get<std::string>();
    const auto failed = check["failed"].get<std::size_t>();
    text += fmt::format("  {:<8} {:>12} {}{}\n", name, check["checked"].get<std::size_t>(), check["of"].get<std::string>(),
                        failed == 0 ? "" : ", " + style.error(fmt::format("{} failed", failed)));
    for (const Json& failure : dataset["failures"]) {
      if (failure["check"] == name) text += fmt::format("    {}{}\n", place_of(failure), text_of(failure["what"]));
    }
    for (const Json& reason : check["left_out"]) text += fmt::format("    {} {}\n", style.dim("left out:"), text_of(reason));
  }
  return text;
}

std::string sweep_report(const Json& sweep, const Style& style) {
  std::string text =
      fmt::format("{} the {} shards together", sweep["holds"].get<bool>() ? style.good("holds:") : style.error("does not hold:"),
                  sweep["shards"].get<std::size_t>());
  if (!sweep["trials"].is_null()) text += fmt::format(": {} trials", sweep["trials"].get<std::size_t>());
  if (!sweep["duplicates"].is_null() && sweep["duplicates"] != 0) {
    const auto duplicates = sweep["duplicates"].get<std::size_t>(), within = sweep["within_rounding"].get<std::size_t>();
    text += fmt::format(", {} of them twice, which is harmless", duplicates);
    if (within < duplicates) text += fmt::format("; {} compared bit by bit", duplicates - within);
    if (within > 0) text += fmt::format("; {} compared within 1e-9, since libraries of others computed them", within);
  }
  text += "\n";
  for (const Json& failure : sweep["failures"]) text += fmt::format("  {}\n", text_of(failure));
  return text;
}

}  // namespace

void ReportCommand::declare(Arguments& arguments) {
  arguments.about("report", "Turn a dataset into an HTML page", R"(
One self-contained HTML file that opens in any browser, without a network. The page of recordings without truth
(slipbench import) shows their signals over time, a table of them with rates and gaps, and their recorded labels.

Examples:
  slipbench report hexapod.h5
  slipbench report hexapod.h5 --trial 17 -o trial17.html)");
  arguments.input("FILE", dataset, "Dataset (HDF5)", ".h5").required();
  arguments.output("-o,--output FILE.html", output,
                   "Page to write, - for standard output (default: the dataset's name with .html)");
  arguments.number("--trial K", options.trial, "Trial to show in full (default: the first)", 0);
}

int ReportCommand::run() {
  const std::string page = output.empty() ? std::filesystem::path(dataset).replace_extension(".html").string() : output;
  write_report(dataset, page, options);
  say_failed(dataset);
  if (json) return print_json({{"report", page}});
  if (streams()) return exit_good;
  print_written({page});
  fmt::print("{} open it in a browser\n", style_for(stdout).dim("next:"));
  return exit_good;
}

void ExportCommand::declare(Arguments& arguments) {
  arguments.about("export", "Write a dataset in another format", R"(
Formats of any sensor:
  csv           one table a trial and sensor, with a header: time, every channel, the true state by each rule
  npz           one numpy archive a trial, with every array of the dataset under its path there
  robomimic     one HDF5 file of demonstrations at one rate: observations, actions, rewards, masks
  lerobot       a LeRobotDataset v3.0 a sensor rate: observations, actions, labels as features beside them
  parquet       a table of columns a sensor, with all trials, for pandas, polars and DuckDB
  mcap          one recording a trial, every sensor, label, pose and command at its own rate, for Foxglove and Lichtblick
  rosbag2       one ROS 2 bag a trial, with the messages of the PapillArray's driver and the truth on topics of its own
Formats of the PapillArray:
  vendor-csv    the log layout of the sensor vendor's own software, one file a trial
  training-csv  73 columns, no header, 1000 Hz, one file a trial: time, then contact, slip, displacement, force of each pillar
Formats of the Myrmex:
  myrmex-csv    counts alone, an image a line, one file a trial and sensor
  myrmex-rotated npz with the images turned in steps of 30 degrees, as the published training augments them
Format of grasps with three BioTac SP:
  grasp-csv     one file, a row a grasp: object, whether it slipped, the 72 electrodes before the lift
Format of a BioTac SP that slides, turns or rests:
  slip-csv      the layout of the public recordings, CLASS/OBJECT<trial>.csv: 24 electrodes, no time, 100 rows a second

Examples:
  slipbench export hexapod.h5 --format npz --trial 3 -o arrays
  slipbench export hexapod.h5 --format training-csv -o training
  slipbench export hexapod.h5 --format vendor-csv --slip paper -o logs)");
  arguments.input("FILE", dataset, "Dataset (HDF5)", ".h5").required();
  arguments
      .read("--format NAME", fmt::format("{}, see below", fmt::join(export_format_names(), " or ")),
            [this](const std::string& name) { options.format = parse_export_format(name); })
      .offers(export_format_names)
      .required();
  arguments.folder("-o,--output DIR", output, "Folder to write into; always needed").required();
  arguments.read(
      "--labels,--slip RULE",
      fmt::format(
          "When a unit counts as slipping: {}, or recorded: the labels of recordings (default: every rule's state; of a PapillArray's formats strict)",
          fmt::join(slip_rule_names(), ", ")),
      [this](const std::string& name) {
        options.recorded = name == "recorded";
        if (!options.recorded) options.slip_rule = parse_slip_rule(name);
      });
  arguments.quantity("--label-speed SPEED", options.label_speed,
                     "Tip speed above which paper and has_slipped say slip (default: 0.1 mm/s)", Quantity::speed);
  arguments.texts("--sensors,--sensor NAME,...", options.sensors, "The scene's names of sensors (default: all, or the only one)");
  arguments.quantity(
      "--rate RATE", options.rate,
      "Rate of the rows, e.g. '100 Hz': the latest values, held (default: each sensor's own; of robomimic the slowest's)",
      Quantity::frequency);
  arguments.text("--split PART", options.split, "Only the trials of train, valid or test (default: all)");
  arguments.number("--trial K", options.trial, "Trial to export (default: all)", 0);
  arguments.text("--licence NAME", options.licence,
                 "Licence of the data, for the dataset card, e.g. cc-by-4.0 (default: none stated)");
  arguments.flag("--points", options.points, "Add x, y, z, fx, fy, fz of each unit to lerobot, as observation.tactile.SENSOR");
  arguments.flag("-q,--quiet", quiet, "No progress and no summary");
  arguments.flag("-v,--verbose", verbose, "Name every file that is written");
  arguments.flag("--compress", options.compress, "Write .csv.gz instead of .csv, and the arrays of robomimic compressed");
}

int ExportCommand::run() {
  if (is_python_format(options.format)) {
    say_failed(dataset);
    take_stdout_back();
    start_python_export(dataset, output, options, {.json = json, .quiet = quiet, .verbose = verbose});
  }
  const std::string no_card = check_card(output, options);
  if (!no_card.empty()) say(stderr, fmt::format("slipbench: note: README.md and croissant.json are not written: {}\n", no_card));
  const std::vector<std::string> files = export_dataset(dataset, output, options, progress_of(silent()));
  say_failed(dataset);
  if (no_card.empty()) {
    take_stdout_back();
    start_card(dataset, output, options, files, {.json = json, .quiet = quiet, .verbose = verbose});
  }
  if (json) return print_json({{"files", files}});
  if (quiet) return exit_good;
  if (verbose) print_written(files);
  std::uintmax_t bytes = 0;
  for (const std::string& file : files) bytes += std::filesystem::file_size(file);
  const std::string what = files.size() == 1 ? files.front() : fmt::format("{} files", files.size());
  fmt::print("{} {}, {}{}\n", style_for(stdout).good("written:"), what, size_text(bytes),
             files.size() == 1 ? "" : ", in " + output);
  return exit_good;
}

void ImportCommand::declare(Arguments& arguments) {
  arguments.about("import", "Read recordings of real sensors into a dataset",
                  fmt::format(R"(
A dataset of recordings has the readings and no truth. What the recordings say of slip are their recorded labels,
by which `slipbench eval` judges (--labels recorded).

--map describes the recordings of any sensor: which columns, arrays or fields of messages are which channel, times, labels, objects.
It reads tables (.csv, .tsv, .txt, .dat), Parquet, .npz, .npy, MCAP and bags of ROS 1 and ROS 2. Besides a file of your own, MAP can be one
of the maps of the program: {}.

Formats without a map:
{}
Examples:
  slipbench import logs --format papillarray-csv -o recorded.h5
  slipbench import training --format training-csv -o published.h5 --seed 3
  slipbench import mine --map columns.yaml -o mine.h5)",
                              "papillarray_ros, papillarray_ros2, xela_ros, biotac_ros", import_formats_text()));
  arguments.inputs("SOURCE ...", options.sources, "Files, and folders whose recordings are all meant").required();
  arguments
      .read("--format NAME",
            fmt::format("{}, see below (default: what --map describes)", fmt::join(import_format_names(), " or ")),
            [this](const std::string& name) { options.format = name == "csv" ? nullptr : &import_format(name); })
      .offers(import_format_names);
  arguments.input("--map MAP", options.map, "Description of the recordings (YAML file), or the name of one of the program's");
  arguments.quantity("--rate RATE", options.rate,
                     "Resample at this rate, e.g. '100 Hz': straight lines between samples, no filter (default: as recorded)",
                     Quantity::frequency);
  arguments.file("-o,--output FILE.h5", options.output, "Dataset to write (default: none, the sources are only checked)");
  arguments.flag("-v,--verbose", options.verbose, "Print every warning, not the first ten (formats without --map)");
  arguments.number("--seed N", options.seed, "Of the split into training, validation and test (default: 1)", 0);
  arguments.then([this] {
    if (options.format == nullptr && options.map.empty())
      reject("import: needs --map MAP, which describes the recordings, or --format {}", fmt::join(import_format_names(), ", "));
    if (options.format != nullptr && !options.map.empty())
      reject("import: --map {}: the format {} has no map; name either --map or --format", options.map,
             format_name(*options.format));
  });
}

int ImportCommand::run() {
  if (options.format == nullptr) import_by_map();
  const ImportSummary summary = [this] {
    const InterruptGuard guard("stopping; nothing is kept");
    const InterruptScope scope(&InterruptGuard::flag());
    return import_recordings(options);
  }();
  print_import(summary, options, json);
  return exit_good;
}

// Goes on in Python.
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
  module.start(request.dump());
}

void print_import(const ImportSummary& summary, const ImportOptions& options, bool json) {
  const std::size_t shown = options.verbose ? summary.warnings.size() : std::min(summary.warnings.size(), most_import_warnings);
  print_warnings({summary.warnings.begin(), summary.warnings.begin() + static_cast<std::ptrdiff_t>(shown)});
  if (shown < summary.warnings.size()) {
    say(stderr, fmt::format("slipbench: {} of this kind; --verbose prints all of them\n",
                            counted(summary.warnings.size() - shown, "more warning")));
  }
  if (json) {
    print_json({{"sources", summary.sources},
                {"trials", summary.trials},
                {"samples", summary.samples},
                {"repeated_rows", summary.repeated_rows},
                {"objects", summary.objects},
                {"warnings", warnings_json(summary.warnings)},
                {"files", summary.files}});
    return;
  }
  fmt::print("{} of {}, {}{}\n", counted(summary.trials, "recording"), counted(summary.sources, "file"),
             counted(summary.samples, "sample"), summary.objects.empty() ? "" : ", " + counted(summary.objects.size(), "object"));
  if (summary.repeated_rows > 0)
    fmt::print("{} left out: the row before has the same words\n", counted(summary.repeated_rows, "row"));
  if (options.rate) {
    fmt::print("resampled at {} by straight lines between samples\n", format_quantity(*options.rate, Quantity::frequency));
  }
  print_written(summary.files);
  if (summary.files.empty()) {
    say(stderr, "slipbench: nothing is written\n");
  } else {
    print_next("slipbench verify " + shell_word(summary.files.front()));
  }
}

void VerifyCommand::declare(Arguments& arguments) {
  arguments.about("verify", "Hold datasets against themselves", R"(
Checks digests, order and masks of trials, times, that values are finite, events against onset times and states, and Coulomb's law in the
labels. Shards of a sweep (sweep --shard k/n) are held against each other too: one sweep, no gaps, no trial twice with different digests. Says what was checked, what was left out and why, and what does not hold, with trial, array and sample.
Exit status 1: something does not hold; 2: a file cannot be read.

Examples:
  slipbench verify hexapod.h5
  slipbench verify shard-1.h5 shard-2.h5
  slipbench verify hexapod.h5 --json)");
  arguments.inputs("FILE ...", datasets, "Datasets (HDF5), by their first files", ".h5").required();
}

int VerifyCommand::run() {
  const Verified verified = verify_datasets(datasets);
  const Style style = style_for(stdout);
  if (json) {
    Json object{{"holds", verified.holds && verified.readable}, {"datasets", verified.datasets}};
    if (!verified.sweep.is_null()) object["sweep"] = verified.sweep;
    print_json(object);
  }
  for (const Json& dataset : verified.datasets) {
    if (dataset.contains("error")) {
      say(stderr,
          fmt::format("{} {}\n", style_for(stderr).error("slipbench:"), printable(dataset["error"].get<std::string>(), true)));
    } else if (!json) {
      fmt::print("{}", dataset.contains("part_of") ? fmt::format("verified with its first file: {}\n", text_of(dataset["file"]))
                                                   : report_of(dataset, style));
    }
  }
  if (!json && !verified.sweep.is_null()) fmt::print("{}", sweep_report(verified.sweep, style));
  if (!verified.readable) return exit_bad_input;
  return verified.holds ? exit_good : exit_check_failed;
}

void ListCommand::declare(Arguments& arguments) {
  arguments.about("list", "List what a scene may name, and recipes", R"(
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
  fmt::print("{}{}{}", list_text(items, kinds, style, width), kinds.empty() || !recipes ? "" : "\n",
             recipes ? recipe_list_text(style, width) : "");
  return exit_good;
}

void DescribeCommand::declare(Arguments& arguments) {
  arguments.about("describe", "Explain one name: parameters, units, defaults, law, source", R"(
Generated from the declarations that the scene parser reads.

Examples:
  slipbench describe papillarray
  slipbench describe stage
  slipbench describe split
  slipbench describe acrylic --json
  slipbench describe piezo_fft_gru)");
  arguments.text("NAME", name, "A name that `slipbench list` shows, or a key of a scene").required().offers([] {
    std::vector<std::string> names = train::recipe_names();
    for (const std::string& key : scene_key_names()) names.push_back(key);
    for (const CatalogueItem& item : catalogue_items(program_catalogues())) names.push_back(item.entry.name);
    return names;
  });
}

int DescribeCommand::run() {
  const Catalogues catalogues = program_catalogues();
  if (train::is_network_recipe(name)) {
    const PythonModule module("slipbench._recipe", "describe " + name, "");
    take_stdout_back();
    module.start(Json{{"name", name}, {"json", json}}.dump());
  }
  const std::vector<CatalogueItem> items = catalogue_items(catalogues);
  const std::vector<std::string> keys = scene_key_names();
  const bool in_catalogue = std::ranges::any_of(items, [this](const CatalogueItem& item) { return item.entry.name == name; });
  if (!in_catalogue && std::ranges::find(keys, name) != keys.end()) {
    const Json schema = scene_schema(catalogues);
    if (json) return print_json({{"name", name}, {"entries", Json::array({describe_key_json(name, schema)})}});
    fmt::print("{}", describe_key_text(name, schema, style_for(stdout), terminal_width(stdout)));
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
    fmt::print("{}{}", i == 0 ? "" : "\n", describe_text(found[i], catalogues, style, terminal_width(stdout)));
  return exit_good;
}

void SchemaCommand::declare(Arguments& arguments) {
  arguments.about("schema", "Print the JSON Schema of scenes or of import maps", R"(
Editors check and complete files by it. A file names its schema in its first line, with the path from its own folder:
# yaml-language-server: $schema=scene.schema.json
The output is JSON with and without --json.

Examples:
  slipbench schema > scene.schema.json
  slipbench schema map > map.schema.json)");
  arguments.text("KIND", of, "scene, or map: of import --map (default: scene)").offers([] {
    return std::vector<std::string>{schema_kinds.begin(), schema_kinds.end()};
  });
}

int SchemaCommand::run() {
  if (std::ranges::find(schema_kinds, of) == schema_kinds.end())
    reject("schema: unknown kind {}{}", quote(of), allowed_names(of, schema_kinds));
  take_stdout_back();
  if (of == "map") PythonModule("slipbench._import.schema", "schema map", "").start("");
  constexpr int indent = 1;
  fmt::print("{}\n", scene_schema(program_catalogues()).dump(indent));
  return exit_good;
}

void DoctorCommand::declare(Arguments& arguments) {
  arguments.about("doctor", "Check the installation", R"(
Exit status 0 when everything required is there, 1 otherwise, with the command that installs it.)");
}

int DoctorCommand::run() {
  take_stdout_back();
  return doctor_main(json);
}

void PluginPathCommand::declare(Arguments& arguments) {
  arguments.about("plugin-path", "Print where the MuJoCo plugin is", R"(
For `mj_loadPluginLibrary`: the library looks which MuJoCo loads it, and takes the build for that version. With --mujoco: the build for one version.
scenes/mujoco/README.md shows what the plugin is for.)");
  arguments.text("--mujoco VERSION", mujoco, "The build for this version of MuJoCo, such as 3.3.7");
}

int PluginPathCommand::run() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path front = own_path(SLIPBENCH_PLUGIN);
  if (!fs::exists(front, error)) {
    reject(
        "there is no MuJoCo plugin {}: `./slipbench plugin-path` builds it where there is MuJoCo; `slipbench doctor` says how to get that",
        front.string());
  }
  const std::string build = mujoco.empty() ? front.filename().string() : plugin_build(mujoco);
  if (build.empty()) {
    reject("--mujoco {}: there is no build of the plugin for MuJoCo {}; allowed: {}", mujoco, mujoco, plugin_versions_text);
  }
  const fs::path path = fs::canonical(front.parent_path() / build);
  if (json) return print_json({{"plugin", path.string()}});
  fmt::print("{}\n", path.string());
  return exit_good;
}

}  // namespace slipbench

#include "tools/program/commands/dataset_commands.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/reader.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/progress.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/export/python_formats.h"

namespace slipbench {
namespace {

// Which trials of its run a dataset does not hold.
void say_failed(const std::string& dataset) {
  const std::string text = guarded(dataset, [&] {
    const DatasetReader reader(dataset);
    return failures_text(reader.failed(), reader.trials().size() + reader.failed().size());
  });
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

}  // namespace

void ReportCommand::declare(Arguments& arguments) {
  arguments.about("report", "Turn a dataset into an HTML page", R"(
One self-contained HTML file that opens in any browser, without a network.

Examples:
  slipbench report hexapod.h5
  slipbench report hexapod.h5 --trial 17 -o trial17.html)");
  arguments.text("FILE", dataset, "Dataset (HDF5)").required();
  arguments.file("-o,--output FILE.html", output, "Page to write (default: the dataset's name with .html)");
  arguments.number("--trial K", options.trial, "Trial to show in full (default: the first)", 0);
}

int ReportCommand::run() {
  const std::string page = output.empty() ? std::filesystem::path(dataset).replace_extension(".html").string() : output;
  write_report(dataset, page, options);
  say_failed(dataset);
  if (json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"report", page}}.dump());
  } else {
    fmt::print("{} {}\n{} open it in a browser\n", style_for(stdout).good("written:"), page, style_for(stdout).dim("next:"));
  }
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
  slipbench export hexapod.h5 --format vendor-csv --slip paper -o logs)");
  arguments.text("FILE", dataset, "Dataset (HDF5)").required();
  arguments
      .read("--format NAME", fmt::format("{}, see below", fmt::join(export_format_names(), " or ")),
            [this](const std::string& name) { options.format = parse_export_format(name); })
      .required();
  arguments.folder("-o,--output DIR", output, "Folder to write into; always needed").required();
  arguments.read(
      "--labels,--slip RULE",
      fmt::format("When a unit counts as slipping: {} (default: every rule's state; of a PapillArray's formats strict)",
                  fmt::join(slip_rule_names(), ", ")),
      [this](const std::string& name) { options.slip_rule = parse_slip_rule(name); });
  arguments.quantity("--label-speed SPEED", options.label_speed,
                     "Tip speed above which paper and has_slipped say slip (default: 0.1 mm/s)", Quantity::speed);
  arguments.texts("--sensors,--sensor NAME,...", options.sensors, "The scene's names of sensors (default: all, or the only one)");
  arguments.quantity(
      "--rate RATE", options.rate,
      "Rate of the rows, e.g. '100 Hz': the latest values, held (default: each sensor's own; of robomimic the slowest's)",
      Quantity::frequency);
  arguments.text("--split PART", options.split, "Only the trials of train, valid or test (default: all)");
  arguments.number("--trial K", options.trial, "Trial to export (default: all)", 0);
  arguments.flag("--compress", options.compress, "Write .csv.gz instead of .csv, and the arrays of robomimic compressed");
}

int ExportCommand::run() {
  if (is_python_format(options.format)) {
    say_failed(dataset);
    start_python_export(dataset, output, options, json);
  }
  const std::vector<std::string> files = export_dataset(dataset, output, options, progress_of(json));
  say_failed(dataset);
  if (json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"files", files}}.dump());
  } else {
    std::uintmax_t bytes = 0;
    for (const std::string& file : files) bytes += std::filesystem::file_size(file);
    const std::string what = files.size() == 1 ? files.front() : fmt::format("{} files", files.size());
    fmt::print("{} {}, {}{}\n", style_for(stdout).good("written:"), what, size_text(bytes),
               files.size() == 1 ? "" : ", in " + output);
  }
  return exit_good;
}

}  // namespace slipbench

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands/detectors/detector_commands.h"
#include "tools/cli/terminal.h"
#include "tools/eval/detect_page.h"
#include "tools/eval/replay.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/workers/python_package/python_package.h"

namespace slipbench {
namespace {

constexpr std::size_t most_trials_shown = 20;

std::string detect_command_text(const DetectCommand& command) {
  std::string text = "slipbench detect " + shell_word(command.detector);
  for (const std::string& recording : command.options.recordings) text += " " + shell_word(recording);
  for (const Override& change : command.parameters) text += " --set " + shell_word(change.path + "=" + change.value);
  if (!command.options.sensor.empty()) text += " --sensor " + shell_word(command.options.sensor);
  if (command.options.resample) text += " --resample";
  return text;
}

}  // namespace

void print_detection(Json result, const std::vector<std::string>& files, bool json) {
  if (json) {
    result["files"] = files;
    print_json(result);
    return;
  }
  const Style style = style_for(stdout);
  const Json& sensor = result.at("sensor");
  std::string text = style.heading(fmt::format("{} on {} ({})", printable(eval::detector_name(result.at("detector"))),
                                               printable(sensor.at("name").get<std::string>()),
                                               printable(sensor.at("type").get<std::string>()))) +
                     "\n";
  for (const std::string& note : eval::frame_notes(result)) text += fmt::format("  {}\n", printable(note));
  Table table(eval::detections_table(result, most_trials_shown));
  text += table.text(style);
  if (const std::size_t trials = result.at("trials").size(); trials > most_trials_shown)
    text += fmt::format("  {}; -o FILE writes all of them\n", counted(trials - most_trials_shown, "more trial"));
  print_text("{}", text);
  print_written(files);
}

void DetectCommand::declare(Arguments& arguments) {
  arguments.about("detect", "Run a slip detector on recordings", R"(
Prints the alarms of the detector, and writes its state and probability at each sample. Recordings
need no labels; if they have labels, the share of wrong samples is printed too. The alarms are the
same as in `slipbench eval`.

-o writes one of:
  FILE.csv      one row per alarm; FILE_samples.csv has one row per sample: time, state, probability, label
  FILE.parquet  the same two tables, for pandas, polars and DuckDB
  FILE.json     both in one object
  FILE.html     a page with signals, probability and alarms, the worst trials first, and FILE.json
  -             the alarms as CSV, on standard output

DETECTOR is as in `slipbench eval`. `slipbench import` converts logs to recordings.

Examples:
  slipbench detect force_ratio recorded.h5 -o alarms.html
  slipbench detect cl_gst_hd recorded.h5 -o alarms.csv)");
  arguments.input("DETECTOR", detector, "Name of a detector, FILE.onnx, or a folder of memories").required();
  arguments.inputs("RECORDING ...", options.recordings, "Datasets (HDF5) with the sensor of the detector", ".h5").required();
  arguments.sets(parameters, "Set a parameter of the detector, e.g. ratio=0.35");
  arguments.text("--sensor NAME", options.sensor, "Name of the sensor in the recordings (default: the only one)");
  arguments.flag("--resample", options.resample, resample_help);
  arguments.output("-o,--output FILE", output, "Write a .csv, .parquet, .json or .html file", ".csv");
}

int DetectCommand::run() {
  if (!output.empty()) eval::check_detect_output(output);
  options.detector = eval::chosen_detector(detector, parameters);
  if (output.ends_with(".parquet")) detect_in_python();
  Json result = eval::detect(options);
  result["command"] = detect_command_text(*this);
  std::vector<std::string> files;
  if (!output.empty()) files = eval::write_detection(output, result);
  print_detection(std::move(result), files, json);
  return exit_good;
}

// Python writes the Parquet file.
void DetectCommand::detect_in_python() {
  const PythonModule module("slipbench._detect", "detect -o FILE.parquet", "export");
  Json set = Json::object();
  for (const Override& change : parameters) set[change.path] = change.value;
  const Json request{{"detector", detector},
                     {"recordings", options.recordings},
                     {"parameters", set},
                     {"sensor", options.sensor},
                     {"resample", options.resample},
                     {"output", output},
                     {"json", json},
                     {"install", module.install()}};
  take_stdout_back();
  module.start(request);
}

}  // namespace slipbench

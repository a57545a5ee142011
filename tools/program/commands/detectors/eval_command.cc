#include "tools/program/commands/detectors/eval_command.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "detectors/hd/words.h"
#include "detectors/network/engine.h"
#include "sim/core/error.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/eval/detector_choice.h"
#include "tools/program/eval/eval_page.h"
#include "tools/program/sweep/run_sweep.h"
#include "tools/program/text/eval_text.h"

namespace slipbench {
namespace {

constexpr std::array<hd::Word<std::string_view>, 4> splits{
    {{"all", ""}, {"train", "train"}, {"valid", "valid"}, {"test", "test"}}};

std::string eval_command_text(const EvalCommand& command) {
  std::string text = "slipbench eval " + shell_word(command.detector) + " " + shell_word(command.options.dataset);
  for (const Override& change : command.parameters) text += " --set " + shell_word(change.path + "=" + change.value);
  text += " --labels " + eval::label_rule_name(command.options.labels);
  if (!command.options.sensor.empty()) text += " --sensor " + shell_word(command.options.sensor);
  if (!command.options.split.empty()) text += " --split " + command.options.split;
  if (command.options.all) text += " --all";
  return text;
}

constexpr std::size_t steps_timed = 201;

// Of the wall clock [s]: what the machine takes, so it stands in no file. On made-up features of the size of scaled ones, and not all alike:
// a network that divides by their size or their spread has to say numbers of them.
double step_time(network::Engine& engine) {
  std::vector<float> features(engine.inputs());
  for (std::size_t i = 0; i < features.size(); ++i) features[i] = 0.25F * static_cast<float>(1 + i % 7);
  std::vector<double> times;
  for (std::size_t k = 0; k < steps_timed; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    engine.run(features);
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return median(std::move(times));
}

// What is said of it. A network need not take features that are made up; the dataset's own are another matter.
std::string step_text(network::Engine& engine) {
  try {
    return fmt::format("  a step of the network takes {:.3g} us on this machine (median of {}); `latency` makes a loop feel it\n",
                       1e6 * step_time(engine), steps_timed);
  } catch (const InputError& error) {
    return fmt::format("  a step of the network is not timed: of made-up features, {}\n", error.what());
  }
}

}  // namespace

void EvalCommand::declare(Arguments& arguments) {
  arguments.about("eval", "Judge any slip detector on a dataset", R"(
Feeds the recorded samples of every trial to the detector, as the loop does, and compares what it sees with the truth: recall of slip, balanced
accuracy, delay from the true first slip, early, missed, false alarms a minute of true stick, each with an interval of 95 % by trial; then by
material or object, by speed and by the dataset's masks. The same samples give the same classes as in the loop.

DETECTOR is a name of `slipbench list detectors`, FILE.onnx (a network), or a folder that `slipbench train` wrote (gst_hd); cl_gst_hd is the
classifier that ships with the program. Trials of this dataset that a network was trained on are left out.

Labels: strict (a unit slips when all of it does), micro (when a part of it does), paper (the rule of the sensor's paper), latched (micro, and what
has slipped stays so until contact is lost), masked (micro, without the frames that stick again after a slip), has_slipped (of a PapillArray: a pillar whose tip was fast stays so until it loses contact).

Examples:
  slipbench eval memories hexapod.h5 --labels paper
  slipbench eval force_ratio hexapod.h5 --set ratio=0.35 -o ratio.html
  slipbench eval cl_gst_hd hexapod.h5 --split test --json)");
  arguments.text("DETECTOR", detector, "A detector's name, FILE.onnx, or a folder of memories").required();
  arguments.text("FILE", options.dataset, "Dataset (HDF5) of the detector's sensor").required();
  arguments.sets(parameters, "A parameter of the detector, e.g. ratio=0.35");
  arguments.read("--labels RULE",
                 fmt::format("Truth to judge by: {} (default: what a network learnt by, else strict)",
                             fmt::join(eval::label_rule_names(), ", ")),
                 [this](const std::string& name) { labels = eval::parse_label_rule(name); });
  arguments.text("--sensor NAME", options.sensor, "The scene's name of the sensor (default: the only one)");
  arguments.word("--split PART", options.split, "Trials to judge, by the dataset's masks: {} (default: all)", splits);
  arguments.flag("--all", options.all, "Also trials that the detector was trained on");
  arguments.file("-o,--output FILE.html", output, "Write a page, and FILE.json beside it");
}

int EvalCommand::run() {
  if (!output.empty()) eval::check_eval_target(output);
  options.detector = eval::chosen_detector(detector, parameters);
  if (labels) options.labels = *labels;
  std::string step;
  if (const std::unique_ptr<network::Engine> engine = eval::network_of(options.detector)) {
    options.trained = engine->description().trained;
    if (!labels) options.labels = eval::learnt_labels(options.trained);
    step = step_text(*engine);
  }
  Json result = eval::evaluate(options);
  result["command"] = eval_command_text(*this);
  std::vector<std::string> files;
  if (!output.empty()) files = eval::write_eval(output, result);
  if (json) {
    fmt::print("{}\n", result.dump());
    return exit_good;
  }
  const Style style = style_for(stdout);
  fmt::print("{}{}", eval_text(result, style), step);
  for (const std::string& file : files) fmt::print("{} {}\n", style.good("written:"), file);
  return exit_good;
}

}  // namespace slipbench

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "detectors/network/engine.h"
#include "sim/core/choice.h"
#include "sim/core/process/regular_file.h"
#include "tools/benchmark/board_page.h"
#include "tools/benchmark/submission.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands/detectors/detector_commands.h"
#include "tools/cli/format/eval_text.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/cli/terminal.h"
#include "tools/eval/eval_page.h"
#include "tools/eval/replay.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"
#include "tools/learning_data/label_rules.h"
#include "tools/statistics/descriptive.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench {
namespace {

constexpr std::array<Choice<std::string_view>, 4> splits{{{"all", ""}, {"train", "train"}, {"valid", "valid"}, {"test", "test"}}};

// `labels`: the rule of the labels.
std::string eval_command_text(const EvalCommand& command, const std::string& labels) {
  std::string text = "slipbench eval " + shell_word(command.detector) + " " + shell_word(command.options.dataset);
  for (const Override& change : command.parameters) text += " --set " + shell_word(change.path + "=" + change.value);
  text += " --labels " + labels;
  if (!command.options.sensor.empty()) text += " --sensor " + shell_word(command.options.sensor);
  if (!command.options.split.empty()) text += " --split " + command.options.split;
  if (command.options.all) text += " --all";
  if (command.options.resample) text += " --resample";
  return text;
}

constexpr std::size_t steps_timed = 201;

// Returns the wall-clock time of a step [s]. The time depends on the machine, so no file contains
// it. The features are synthetic: of the size of scaled features and not all equal, because a
// network may divide by their spread.
double step_time(network::Engine& engine) {
  std::vector<float> features(engine.inputs());
  for (std::size_t i = 0; i < features.size(); ++i) features[i] = 0.25F * static_cast<float>(1 + i % 7);
  return median_time(steps_timed, [&] { engine.run(features); });
}

// Reports the time of a step. A network may reject the synthetic features and still accept those of
// the dataset.
std::string step_text(network::Engine& engine) {
  try {
    return fmt::format(
        "  a step of the network takes {:.3g} us on this machine (median of {}); set `latency` to simulate it in a loop\n",
        1e6 * step_time(engine), steps_timed);
  } catch (const InputError& error) {
    return fmt::format("  a step of the network was not timed, because it fails with artificial features: {}\n", error.what());
  }
}

constexpr std::uintmax_t max_submission = 64U << 20U;  // bytes

std::string read_text(const std::string& path) {
  check_regular_file(path, max_submission);
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw InputError(path + ": cannot be read");
  return text;
}

// A library is third-party code, so the user must name it: a submission from elsewhere must not
// choose the code that runs here.
void check_libraries(const benchmark::BoardRequest& submitted, const std::vector<Override>& allowed, const std::string& file) {
  for (const Override& change : submitted.parameters) {
    const auto names = [&](const Override& own) { return own.path == change.path && own.value == change.value; };
    if (change.path == "library" && std::ranges::none_of(allowed, names))
      reject("{}: the submission runs a library; to run its code here, add --set library={}", file, change.value);
  }
}

// Returns true if both paths denote the same file, which need not exist.
bool same_file(const std::string& a, const std::string& b) {
  const auto place = [](const std::string& path) {
    std::error_code error;  // a folder may be unreadable; writing to it then reports the error
    const std::filesystem::path there = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
    return error ? std::filesystem::path(path).lexically_normal() : there;
  };
  return place(a) == place(b);
}

}  // namespace

void EvalCommand::declare(Arguments& arguments) {
  arguments.about("eval", "Evaluate a slip detector on a dataset",
                  fmt::format(R"(
Feeds the recorded samples of each trial to the detector, as the control loop does, and compares the
result with the truth: recall of slip, balanced accuracy, delay after the true onset, early alarms,
missed slips and false alarms per minute of true stick, each with a 95 % interval by trial. The same
figures follow by material or object, by speed and by the dataset's masks. A frame has the class of
the pad: non-slip, incipient slip or gross slip.

DETECTOR is a name of `slipbench list detectors`, FILE.onnx (a network), or a folder that
`slipbench train-hd` wrote (gst_hd); cl_gst_hd and learn_gst_hd are included. Trials on which a network
or memories were trained are left out, in whichever file they are stored; the output warns if the
detector does not record these trials.

Labels:
{}
Examples:
  slipbench eval memories hexapod.h5 --labels paper
  slipbench eval force_ratio hexapod.h5 --set ratio=0.35 -o ratio.html
  slipbench eval cl_gst_hd hexapod.h5 --split test --json)",
                              label_rules_text(LabelUse::evaluation)));
  arguments.input("DETECTOR", detector, "Name of a detector, FILE.onnx, or a folder of memories").required();
  arguments.input("FILE", options.dataset, "Dataset (HDF5) with the sensor of the detector", ".h5").required();
  arguments.sets(parameters, "Set a parameter of the detector, e.g. ratio=0.35");
  arguments.read(
      "--labels RULE",
      fmt::format(
          "Labels to compare with: {} (default: for recordings recorded, otherwise the labels of the network's training, or strict)",
          fmt::join(label_rule_names(LabelUse::evaluation), ", ")),
      [this](const std::string& name) { options.labels = parse_label_rule(name, LabelUse::evaluation); });
  arguments.text("--sensor NAME", options.sensor, "Name of the sensor in the scene (default: the only one)");
  arguments.word("--split PART", options.split, "Trials to evaluate, by the dataset's masks: {} (default: all)", splits);
  arguments.flag("--all", options.all, "Include trials that the detector was trained on");
  arguments.flag("--resample", options.resample, resample_help);
  arguments.output("-o,--output FILE.html", output,
                   "Write a page with figures, curves and the worst trials over time, and FILE.json; -: only the page");
}

int EvalCommand::run() {
  if (!output.empty()) page::check_page_files(output, eval::page_kind);
  options.detector = eval::chosen_detector(detector, parameters);
  std::string step;
  options.trained = eval::training_of(options.detector);
  if (const std::unique_ptr<network::Engine> engine = eval::network_of(options.detector)) step = step_text(*engine);
  Json result = eval::evaluate(options);
  result["command"] = eval_command_text(*this, result.at("labels").get<std::string>());
  std::vector<std::string> files;
  if (!output.empty()) {
    const std::string place = streams() ? "eval.html" : output;  // location of the page, which its links are relative to
    files = page::write_page_files(output, eval::page_kind, eval::eval_page(result, options.dataset, place, options.detector),
                                   result);
  }
  if (json) return print_json(result);
  print_text("{}{}", eval_text(result, style_for(stdout)), step);
  print_written(files);
  return exit_good;
}

void BenchmarkCommand::declare(Arguments& arguments) {
  arguments.about("benchmark", "Compare slip detectors by one protocol", R"(
Ranks detectors on a board: the included detectors, the given DETECTORs, and negative controls. The
controls do not read the sensor: they always or never report slip, or know the commanded motion.

A protocol consists of fixed recordings and grasps (scenes/benchmark/PROTOCOL) and of a score
(tools/benchmark/README.md). The seeds of recordings and grasps differ from those of the training
data. False alarms lower the score.

The board has three tracks: open recordings; closed loop, where a gripper tightens when the detector
reports slip; and transfer (--real), where detectors trained on simulations are evaluated on
recordings of real sensors.

DETECTOR is a name of `slipbench list detectors`, FILE.onnx (a network), or a folder that
`slipbench train-hd` wrote.

--verify recomputes a submission. It prints the first difference and exits with status 1 if a number
differs by more than 1e-9 (the rounding of MuJoCo, FFTW and networks on other processors), or if
anything else differs. The library of a plugin in the submission is loaded only if
--set library=PATH names it, because a plugin may contain foreign code.

Examples:
  slipbench benchmark -o board.html
  slipbench benchmark my.onnx --sensor papillarray -o board.html --submit my.json
  slipbench benchmark --verify my.json
  slipbench benchmark shear_rate --set flip=0.05 --sensor papillarray --trials 8)");
  arguments.texts("DETECTOR", request.detectors, "Detectors to add to the included ones");
  arguments.text("--protocol NAME", protocol, fmt::format("Protocol (default: {})", benchmark::default_protocol));
  arguments.sets(request.parameters, "Set a parameter of the DETECTOR, e.g. ratio=0.35");
  arguments.inputs("--real FILE", request.real, "Dataset of real recordings (slipbench import), for the track transfer");
  arguments.text("--sensor TYPE", request.sensor, "Run only one type of sensor (default: all)");
  arguments.number("--trials N", request.trials, "For quick tests: N trials of each scene; the result is not a valid board", 1,
                   100'000);
  arguments.jobs(jobs);
  arguments.output("-o,--output FILE.html", output, "Write a page, and FILE.json; -: only the page");
  arguments.file("--submit FILE", submission, "Write the board as a submission");
  arguments.input("--verify FILE", verified, "Recompute a submission; only with --jobs and --set library=PATH");
  arguments.flag("-q,--quiet", quiet, "Print no progress");
  arguments.then([this] {
    const bool sets = std::ranges::any_of(request.parameters, [](const Override& change) { return change.path != "library"; });
    const bool asks = !request.detectors.empty() || sets || !request.real.empty() || !request.sensor.empty() ||
                      request.trials > 0 || !protocol.empty() || !output.empty() || !submission.empty();
    if (!verified.empty() && asks)
      throw InputError(
          "benchmark: --verify reads all options from the submission; it can only be combined with --jobs and --set library=PATH");
    if (!output.empty() && !submission.empty() &&
        (same_file(output, submission) || same_file(page::json_path(output), submission)))
      reject("benchmark: --submit {}: --output {} also writes this file; choose another name", submission, output);
    if (verified.empty() && request.detectors.empty() && !request.parameters.empty())
      throw InputError("benchmark: --set sets a parameter of a DETECTOR, but no DETECTOR is given");
  });
}

Json BenchmarkCommand::made(benchmark::BoardRequest request, const std::string& protocol_name) const {
  const InterruptGuard guard("stopping; nothing is kept");
  return benchmark::benchmark({.request = std::move(request),
                               .protocol = protocol_name,
                               .jobs = jobs,
                               .interrupt = &InterruptGuard::flag(),
                               .say = [this](const std::string& what) { print_status(what); }});
}

std::string BenchmarkCommand::text(const Json& result) const {
  const Style style = style_for(stdout);
  std::string all;
  for (const Json& set : result.at("sets")) {
    const benchmark::BoardTable board = benchmark::board_table(set);
    all += style.heading(board.title) + "\n" + Table(board.cells).text(style);
    for (const std::string& one : board.left_out) all += style.dim("  no score: " + one) + "\n";
    all += "\n";
  }
  if (result.contains("transfer")) all += style.heading("transfer") + "\n  " + result.at("transfer").get<std::string>() + "\n";
  if (!result.at("protocol").at("whole").get<bool>())
    all += "only a part of the protocol, so this is not a board of " + result.at("protocol").at("name").get<std::string>() + "\n";
  return all;
}

int BenchmarkCommand::verify() const {
  const std::string submitted_text = read_text(verified);
  const Json submitted = benchmark::parse_submission(submitted_text, verified);
  benchmark::BoardRequest submitted_request = benchmark::parse_request(submitted.at("asked"), verified);
  check_libraries(submitted_request, request.parameters, verified);
  const Json result = made(std::move(submitted_request), submitted.at("protocol").at("name").get<std::string>());
  const std::string difference = benchmark::difference(submitted_text, submitted, result);
  const bool same_machine = submitted.contains("machine") && submitted.at("machine") == result.at("machine");
  if (json) {
    print_json({{"file", verified}, {"same", difference.empty()}, {"difference", difference}, {"same_machine", same_machine}});
  } else {
    const Style style = style_for(stdout);
    print_text("{}\n", difference.empty()
                           ? style.good(verified +
                                        ": recomputed with the same result: numbers agree within 1e-9, everything else exactly")
                           : style.error(verified + ": differs: ") + difference);
    if (!same_machine) print_text("made on another machine or by another build; see `machine` in the file\n");
  }
  return difference.empty() ? exit_good : exit_check_failed;
}

int BenchmarkCommand::run() {
  if (!output.empty()) page::check_page_files(output, benchmark::page_kind);
  if (!submission.empty()) {
    check_text_target(submission, {}, {"submission of slipbench benchmark", [](std::string_view text) {
                                         return page::begins_as_object(text, benchmark::page_kind);
                                       }});
  }
  if (!verified.empty()) return verify();
  const Json result = made(request, protocol.empty() ? benchmark::default_protocol : protocol);
  std::vector<std::string> files;
  if (!output.empty()) files = page::write_page_files(output, benchmark::page_kind, benchmark::board_page(result), result);
  if (!submission.empty()) {
    write_text_file(submission, benchmark::submission_text(result));
    files.push_back(submission);
  }
  if (json) return print_json(result);
  print_text("{}", text(result));
  print_written(files);
  return exit_good;
}

}  // namespace slipbench

#include "tools/program/commands/detectors/benchmark_command.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/process/regular_file.h"
#include "tools/base/files/output_file.h"
#include "tools/base/page/page_files.h"
#include "tools/base/workers/interrupt.h"
#include "tools/program/benchmark/board_page.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/table.h"
#include "tools/program/cli/terminal.h"

namespace slipbench {
namespace {

constexpr TextKind submission_kind{"submission of slipbench benchmark", &benchmark::begins_as_board_json};

constexpr std::uintmax_t max_submission = 64U << 20U;  // bytes

std::string read_text(const std::string& path) {
  check_regular_file(path, max_submission);
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw InputError(path + ": cannot be read");
  return text;
}

// A library is code of others, which whoever recomputes has to name: a file that came by mail is not to choose what runs here.
void check_libraries(const benchmark::Asked& submitted, const std::vector<Override>& allowed, const std::string& file) {
  for (const Override& change : submitted.parameters) {
    const auto names = [&](const Override& own) { return own.path == change.path && own.value == change.value; };
    if (change.path == "library" && std::ranges::none_of(allowed, names))
      throw InputError(
          fmt::format("{}: runs a library; allowed: with --set library={}, to run its code here", file, change.value));
  }
}

// Whether both paths lead to one file, whether it is there or not.
bool same_file(const std::string& a, const std::string& b) {
  const auto place = [](const std::string& path) {
    std::error_code error;  // of a folder that may not be looked into: writing says it
    const std::filesystem::path there = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
    return error ? std::filesystem::path(path).lexically_normal() : there;
  };
  return place(a) == place(b);
}

}  // namespace

void BenchmarkCommand::declare(Arguments& arguments) {
  arguments.about("benchmark", "Judge all slip detectors by one protocol", R"(
Puts every detector on a board: those that ship, those that the protocol teaches, the negative controls (always slip, never slip, a
clock, the motion known, the motion known and timed), and the DETECTORs given. The protocol slip-1 is fixed: recordings and grasps
of scenes/benchmark/slip-1, which share no seed, material or object with what is learnt from, and a score that false alarms lower
(tools/program/benchmark/README.md).

Three tracks: open recordings; closed loop, where a gripper tightens by what the detector says; transfer, with --real, where what was taught on
simulations is judged on recordings of real sensors.

DETECTOR is a name of `slipbench list detectors`, FILE.onnx (a network), or a folder that `slipbench train` wrote.

--verify recomputes a submission. It exits with status 1 and says what differs first where it is not the same byte for byte. The library of
a plugin, which is code of others, runs where --set library=PATH names it.

Examples:
  slipbench benchmark -o board.html
  slipbench benchmark my.onnx --sensor papillarray -o board.html --submit my.json
  slipbench benchmark --verify my.json
  slipbench benchmark shear_rate --set flip=0.05 --sensor papillarray --trials 8 --untaught)");
  arguments.texts("DETECTOR", asked.detectors, "Detectors beside those that ship");
  arguments.sets(asked.parameters, "A parameter of the DETECTOR given, e.g. ratio=0.35");
  arguments.texts("--real FILE", asked.real, "Datasets of real recordings (slipbench import), for the track transfer");
  arguments.text("--sensor TYPE", asked.sensor, "One type of sensor alone (default: all)");
  arguments.number("--trials N", asked.trials, "To try things: N trials of each scene; no board of the protocol", 1, 100'000);
  arguments.flag("--untaught", asked.untaught, "To try things: without the detectors that the protocol teaches");
  arguments.jobs(jobs);
  arguments.file("-o,--output FILE.html", output, "Write a page, and FILE.json beside it");
  arguments.file("--submit FILE", submission, "Write the board as a submission");
  arguments.text("--verify FILE", verified, "Recompute a submission; takes no other option but --jobs and --set library=PATH");
  arguments.flag("--quiet", quiet, "Print no progress");
  arguments.then([this] {
    const bool sets = std::ranges::any_of(asked.parameters, [](const Override& change) { return change.path != "library"; });
    const bool asks = !asked.detectors.empty() || sets || !asked.real.empty() || !asked.sensor.empty() || asked.trials > 0 ||
                      asked.untaught || !output.empty() || !submission.empty();
    if (!verified.empty() && asks)
      throw InputError(
          "benchmark: --verify takes what was asked from its file; allowed: it alone, --jobs, and --set library=PATH");
    if (!output.empty() && !submission.empty() &&
        (same_file(output, submission) || same_file(page::json_path(output), submission)))
      throw InputError(
          fmt::format("benchmark: --submit {}: --output {} writes that file; allowed: another name", submission, output));
    if (verified.empty() && asked.detectors.empty() && !asked.parameters.empty())
      throw InputError("benchmark: --set is of the DETECTOR given, and none is; allowed: a DETECTOR, e.g. shear_rate");
  });
}

Json BenchmarkCommand::made(benchmark::Asked asked_for) const {
  const InterruptGuard guard("stopping; nothing is kept");
  return benchmark::benchmark(
      {.asked = std::move(asked_for), .jobs = jobs, .interrupt = &InterruptGuard::flag(), .say = [this](const std::string& what) {
         tell(what);
       }});
}

std::string BenchmarkCommand::text(const Json& result) const {
  const Style style = style_for(stdout);
  std::string all;
  for (const Json& set : result.at("sets")) {
    const benchmark::BoardTable board = benchmark::board_table(set);
    Table table(board.head);
    for (const std::vector<std::string>& row : board.rows) table.add(row);
    all += style.heading(board.title) + "\n" + table.text(style);
    for (const std::string& one : board.left_out) all += style.dim("  not on this board: " + one) + "\n";
    all += "\n";
  }
  if (result.contains("transfer")) all += style.heading("transfer") + "\n  " + result.at("transfer").get<std::string>() + "\n";
  if (!result.at("protocol").at("whole").get<bool>())
    all += "a part of the protocol: no board of " + result.at("protocol").at("name").get<std::string>() + "\n";
  return all;
}

int BenchmarkCommand::verify() const {
  const std::string submitted_text = read_text(verified);
  const Json submitted = benchmark::parse_submission(submitted_text, verified);
  benchmark::Asked submitted_asked = benchmark::parse_asked(submitted.at("asked"));
  check_libraries(submitted_asked, asked.parameters, verified);
  const Json result = made(std::move(submitted_asked));
  const std::string difference = benchmark::difference(submitted_text, submitted, result);
  const bool same_machine = submitted.contains("machine") && submitted.at("machine") == result.at("machine");
  if (json) {
    fmt::print("{}\n",
               Json{{"file", verified}, {"same", difference.empty()}, {"difference", difference}, {"same_machine", same_machine}}
                   .dump());
  } else {
    const Style style = style_for(stdout);
    fmt::print("{}\n", difference.empty() ? style.good(verified + ": recomputed, the same byte for byte")
                                          : style.error(verified + ": differs: ") + difference);
    if (!same_machine) fmt::print("made on another machine or by another build, which its `machine` names\n");
  }
  return difference.empty() ? exit_good : exit_check_failed;
}

int BenchmarkCommand::run() {
  if (!output.empty()) benchmark::check_board_target(output);
  if (!submission.empty()) check_text_target(submission, {}, submission_kind);
  try {
    if (!verified.empty()) return verify();
    const Json result = made(asked);
    std::vector<std::string> files;
    if (!output.empty()) files = benchmark::write_board(output, result);
    if (!submission.empty()) {
      write_text_file(submission, benchmark::submission_text(result));
      files.push_back(submission);
    }
    if (json) {
      fmt::print("{}\n", result.dump(-1, ' ', false, Json::error_handler_t::replace));
      return exit_good;
    }
    fmt::print("{}", text(result));
    for (const std::string& file : files) fmt::print("{} {}\n", style_for(stdout).good("written:"), file);
    return exit_good;
  } catch (const Interrupted&) {
    say(stderr, "slipbench: interrupted; nothing is kept\n");
    return exit_interrupted;
  }
}

}  // namespace slipbench

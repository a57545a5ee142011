#include "tools/studies/counts/bench_command.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/files/output_file.h"
#include "tools/base/project/project_file.h"
#include "tools/base/workers/interrupt.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/studies/counts/count.h"
#include "tools/studies/counts/results.h"

namespace slipbench::counts {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t timings = 9;
constexpr std::size_t shown_functions = 6;
constexpr double shown_growth = 1e-4;  // of a scene; below it, functions are not worth a line

const TextKind results_kind{"file of results",
                            [](std::string_view beginning) { return beginning.starts_with("{\n \"slipbench_bench\""); }};
const TextKind drawing_kind{"drawing", [](std::string_view beginning) { return beginning.starts_with("<svg "); }};

std::string counts_text(const Results& results, const Style& style) {
  Table table({"scene", "simulated s", "steps", "instructions", "a simulated s", "a step", "x real time"});
  for (const SceneCount& scene : results.scenes) {
    table.add({scene_name(scene.scene), fmt::format("{:g}", scene.simulated), grouped(scene.steps), grouped(scene.instructions),
               grouped(std::lround(scene.instructions_per_second())), grouped(std::lround(scene.instructions_per_step())),
               fmt::format("{:.3g}", scene.times_real_time())});
  }
  return table.text(style);
}

Json counts_json(const Results& results) {
  Json scenes = Json::array();
  for (const SceneCount& scene : results.scenes) {
    scenes.push_back({{"scene", scene.scene},
                      {"simulated_s", scene.simulated},
                      {"steps", scene.steps},
                      {"instructions", scene.instructions},
                      {"instructions_per_simulated_s", scene.instructions_per_second()},
                      {"instructions_per_step", scene.instructions_per_step()},
                      {"times_real_time", scene.times_real_time()}});
  }
  Json build = Json::object();
  for (const auto& [name, value] : results.build) build[name] = value;
  return {{"build", std::move(build)}, {"scenes", std::move(scenes)}};
}

std::string percent_text(double growth) { return fmt::format("{:+.2f} %", 100.0 * growth); }

std::string functions_text(const SceneChange& change, const Style& style) {
  Table table({"function, its own instructions", "before", "now", "change", "of the scene"});
  for (const FunctionChange& function : change.functions) {
    if (&function - change.functions.data() == shown_functions) break;
    const double share = static_cast<double>(function.difference()) / static_cast<double>(change.before);
    const std::string before = grouped(function.before);
    table.add({function.name, function.listed ? before : "at most " + before, grouped(function.now),
               grouped(function.difference()), percent_text(share)});
  }
  return table.text(style);
}

std::string comparison_text(const std::vector<SceneChange>& changes, const std::string& file, const Style& style) {
  std::string text = fmt::format("Against {}\n", file);
  Table table({"scene", "instructions before", "now", "change", ""});
  for (const SceneChange& change : changes) {
    table.add({scene_name(change.scene), grouped(change.before), grouped(change.now), percent_text(change.growth()),
               change.grew()     ? "GREW"
               : change.shrank() ? "shrank"
                                 : "ok"});
  }
  text += table.text(style);
  for (const SceneChange& change : changes) {
    if (std::abs(change.growth()) < shown_growth) continue;
    const std::string name = scene_name(change.scene);
    text += fmt::format("\n{} {}\n", change.grew() ? style.error(name) : style.heading(name), percent_text(change.growth()));
    if (change.steps_before != change.steps_now) {
      text += fmt::format("  steps: {} before, {} now\n", grouped(change.steps_before), grouped(change.steps_now));
    }
    text += functions_text(change, style);
  }
  const auto grew = std::ranges::count_if(changes, &SceneChange::grew);
  const std::string limit = fmt::format("{:g} %", 100.0 * allowed_growth);
  if (grew > 0) {
    text += style.error(fmt::format("\n{} of {} scenes grew by more than {}", grew, changes.size(), limit)) + '\n';
    text += fmt::format("Where that is wanted, update the results: slipbench bench -o {}\n", file);
  } else if (std::ranges::any_of(changes, &SceneChange::shrank)) {
    text += fmt::format("\nA scene shrank by more than {}: update the results, so that it stays so: slipbench bench -o {}\n",
                        limit, file);
  } else {
    text += style.good(fmt::format("\nNo scene grew by more than {}", limit)) + '\n';
  }
  return text;
}

Json comparison_json(const std::vector<SceneChange>& changes, const std::string& file) {
  Json scenes = Json::array();
  for (const SceneChange& change : changes) {
    Json functions = Json::array();
    for (const FunctionChange& function : change.functions) {
      functions.push_back(
          {{"name", function.name}, {function.listed ? "before" : "before_at_most", function.before}, {"now", function.now}});
    }
    scenes.push_back({{"scene", change.scene},
                      {"before", change.before},
                      {"now", change.now},
                      {"growth", change.growth()},
                      {"grew", change.grew()},
                      {"functions", std::move(functions)}});
  }
  return {{"passed", std::ranges::none_of(changes, &SceneChange::grew)},
          {"file", file},
          {"allowed_growth", allowed_growth},
          {"scenes", std::move(scenes)}};
}

// The file to compare with, read before anything is counted: that takes a minute.
struct Before {
  std::string path;
  Results results;
};

Before stored_results(const std::string& file) {
  const Facts build = build_facts();
  Before before{file.empty() ? find_results(project_file("tests/benchmarks/results"), build) : file, {}};
  before.results = read_results(before.path);
  check_comparable(before.results, build, before.path);
  return before;
}

std::string drawing_beside(const std::string& file) { return std::filesystem::path(file).replace_extension(".svg").string(); }

}  // namespace

void BenchCommand::declare(Arguments& arguments) {
  arguments.about("bench", "Count the instructions of the reference scenes", R"(
Runs the first trial of six reference scenes under callgrind, which counts the instructions that the trial takes, and prints them
by simulated second and by step, with times real time (the median CPU time of nine runs). Counts are the same at every run to
1e-6; they depend on compiler, flags, instruction set and libraries, so that results are compared with those of the same build only.

--compare counts and compares with FILE.json, or with the results in tests/benchmarks/results that are of this build: it prints each
scene's change and the functions whose own instructions changed most. Exit status 1 where a scene grew by more than 2 %, 2 where
there are no results of this build. -o writes the results, and a drawing of them as FILE.svg beside them.

Examples:
  slipbench bench
  slipbench bench --compare
  slipbench bench -o tests/benchmarks/results/ci.json)");
  arguments.flag("--compare", compares, "Compare with stored results (default: the committed ones of this build)");
  arguments.text("FILE.json", compare_with, "Results to compare with");
  arguments.file("-o,--output FILE.json", output, "Write the results, and FILE.svg beside them");
  arguments.jobs(jobs, "Scenes counted at a time, 1 to 1024 (default: 1)");
  arguments.flag("--quiet", quiet, "No progress");
  arguments.then([this] {
    if (!compares && !compare_with.empty()) {
      throw InputError(fmt::format("bench: unexpected argument '{0}'; allowed: --compare {0}", compare_with));
    }
    if (compares && !output.empty()) throw InputError("bench: --compare and -o exclude each other; allowed: one of them");
    if (!output.empty() && !output.ends_with(".json")) {
      throw InputError(fmt::format("bench: -o is '{}'; allowed: a name that ends in .json, such as ci.json", output));
    }
  });
}

int BenchCommand::run() {
  if (!output.empty()) {
    check_text_target(output, {}, results_kind);
    check_text_target(drawing_beside(output), {}, drawing_kind);
  }
  std::optional<Before> before;
  if (compares) before = stored_results(compare_with);
  const InterruptGuard guard("waiting for the running counts to end");
  const std::optional<Results> results =
      count_reference_scenes({.jobs = jobs,
                              .timings = compares ? 0 : timings,
                              .interrupt = &InterruptGuard::flag(),
                              .on_counted =
                                  [this](const SceneCount& scene) {
                                    if (!silent()) say(stderr, fmt::format("counted {}\n", scene_name(scene.scene)));
                                  }},
                             program_catalogues());
  if (!results) {
    say(stderr, "slipbench: interrupted: nothing is kept\n");
    return exit_interrupted;
  }
  const Style style = style_for(stdout);
  if (compares) {
    const std::vector<SceneChange> changes = compare(before->results, *results);
    if (json) {
      print_json(comparison_json(changes, before->path));
    } else {
      fmt::print("{}", comparison_text(changes, before->path, style));
    }
    return std::ranges::any_of(changes, &SceneChange::grew) ? exit_check_failed : exit_good;
  }
  if (!output.empty()) {
    write_text_file(output, results_json(*results));
    write_text_file(drawing_beside(output), drawing(*results));
  }
  if (json) return print_json(counts_json(*results));
  fmt::print("{}", counts_text(*results, style));
  return exit_good;
}

}  // namespace slipbench::counts

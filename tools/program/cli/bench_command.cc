#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/dataset/output_file.h"
#include "tools/base/project/project_file.h"
#include "tools/base/workers/interrupt.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/commands.h"
#include "tools/program/cli/table.h"
#include "tools/program/cli/terminal.h"
#include "tools/studies/counts/compare.h"
#include "tools/studies/counts/count.h"
#include "tools/studies/counts/drawing.h"
#include "tools/studies/counts/results.h"

namespace slipbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t timings = 9;
constexpr std::size_t shown_functions = 6;
constexpr double shown_growth = 1e-4;  // of a scene; below it, functions are not worth a line

const TextKind results_kind{"file of results",
                            [](std::string_view beginning) { return beginning.starts_with("{\n \"slipbench_bench\""); }};
const TextKind drawing_kind{"drawing", [](std::string_view beginning) { return beginning.starts_with("<svg "); }};

// "1,234,567"
std::string grouped(std::int64_t value) {
  std::string digits = std::to_string(std::abs(value));
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return (value < 0 ? "-" : "") + digits;
}
std::string grouped(std::uint64_t value) { return grouped(static_cast<std::int64_t>(value)); }

std::string counts_text(const counts::Results& results, const Style& style) {
  Table table({"scene", "simulated s", "steps", "instructions", "a simulated s", "a step", "x real time"});
  for (const counts::SceneCount& scene : results.scenes) {
    table.add({counts::scene_name(scene.scene), fmt::format("{:g}", scene.simulated), grouped(scene.steps),
               grouped(scene.instructions), grouped(std::lround(scene.instructions_per_second())),
               grouped(std::lround(scene.instructions_per_step())), fmt::format("{:.3g}", scene.times_real_time())});
  }
  return table.text(style);
}

Json counts_json(const counts::Results& results) {
  Json scenes = Json::array();
  for (const counts::SceneCount& scene : results.scenes) {
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

std::string functions_text(const counts::SceneChange& change, const Style& style) {
  Table table({"function, its own instructions", "before", "now", "change", "of the scene"});
  for (const counts::FunctionChange& function : change.functions) {
    if (&function - change.functions.data() == shown_functions) break;
    const double share = static_cast<double>(function.difference()) / static_cast<double>(change.before);
    const std::string before = grouped(function.before);
    table.add({function.name, function.listed ? before : "at most " + before, grouped(function.now),
               grouped(function.difference()), percent_text(share)});
  }
  return table.text(style);
}

std::string comparison_text(const std::vector<counts::SceneChange>& changes, const std::string& file, const Style& style) {
  std::string text = fmt::format("Against {}\n", file);
  Table table({"scene", "instructions before", "now", "change", ""});
  for (const counts::SceneChange& change : changes) {
    table.add({counts::scene_name(change.scene), grouped(change.before), grouped(change.now), percent_text(change.growth()),
               change.grew()     ? "GREW"
               : change.shrank() ? "shrank"
                                 : "ok"});
  }
  text += table.text(style);
  for (const counts::SceneChange& change : changes) {
    if (std::abs(change.growth()) < shown_growth) continue;
    const std::string name = counts::scene_name(change.scene);
    text += fmt::format("\n{} {}\n", change.grew() ? style.error(name) : style.heading(name), percent_text(change.growth()));
    if (change.steps_before != change.steps_now) {
      text += fmt::format("  steps: {} before, {} now\n", grouped(change.steps_before), grouped(change.steps_now));
    }
    text += functions_text(change, style);
  }
  const auto grew = std::ranges::count_if(changes, &counts::SceneChange::grew);
  const std::string limit = fmt::format("{:g} %", 100.0 * counts::allowed_growth);
  if (grew > 0) {
    text += style.error(fmt::format("\n{} of {} scenes grew by more than {}", grew, changes.size(), limit)) + '\n';
    text += fmt::format("Where that is wanted, update the results: slipbench bench -o {}\n", file);
  } else if (std::ranges::any_of(changes, &counts::SceneChange::shrank)) {
    text += fmt::format("\nA scene shrank by more than {}: update the results, so that it stays so: slipbench bench -o {}\n",
                        limit, file);
  } else {
    text += style.good(fmt::format("\nNo scene grew by more than {}", limit)) + '\n';
  }
  return text;
}

Json comparison_json(const std::vector<counts::SceneChange>& changes, const std::string& file) {
  Json scenes = Json::array();
  for (const counts::SceneChange& change : changes) {
    Json functions = Json::array();
    for (const counts::FunctionChange& function : change.functions) {
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
  return {{"passed", std::ranges::none_of(changes, &counts::SceneChange::grew)},
          {"file", file},
          {"allowed_growth", counts::allowed_growth},
          {"scenes", std::move(scenes)}};
}

// The file to compare with, read before anything is counted: that takes a minute.
struct Before {
  std::string path;
  counts::Results results;
};

Before stored_results(const BenchOptions& options) {
  const counts::Facts build = counts::build_facts();
  std::string path = options.compare_with;
  if (path.empty()) path = counts::find_results(project_file("tests/benchmarks/results"), build);
  Before before{path, counts::read_results(path)};
  counts::check_comparable(before.results, build, path);
  return before;
}

std::string drawing_beside(const std::string& file) { return std::filesystem::path(file).replace_extension(".svg").string(); }

void check_options(const Options& options) {
  if (!options.simulation.compare && !options.simulation.compare_with.empty()) {
    throw InputError(fmt::format("bench: unexpected argument '{}'; allowed: --compare {}", options.simulation.compare_with,
                                 options.simulation.compare_with));
  }
  if (options.output.empty()) return;
  if (options.simulation.compare) throw InputError("bench: --compare and -o exclude each other; allowed: one of them");
  if (!options.output.ends_with(".json")) {
    throw InputError(fmt::format("bench: -o is '{}'; allowed: a name that ends in .json, such as ci.json", options.output));
  }
  check_text_target(options.output, {}, results_kind);
  check_text_target(drawing_beside(options.output), {}, drawing_kind);
}

}  // namespace

int bench_command(const Options& options) {
  check_options(options);
  const bool compares = options.simulation.compare;
  const bool quiet = options.quiet || options.json;
  std::optional<Before> before;
  if (compares) before = stored_results(options.simulation);
  const InterruptGuard guard("waiting for the running counts to end");
  const std::optional<counts::Results> results =
      counts::count_reference_scenes({.jobs = options.jobs.value_or(1),
                                      .timings = compares ? 0 : timings,
                                      .interrupt = &InterruptGuard::flag(),
                                      .on_counted =
                                          [quiet](const counts::SceneCount& scene) {
                                            if (!quiet) say(stderr, fmt::format("counted {}\n", counts::scene_name(scene.scene)));
                                          }},
                                     program_catalogues());
  if (!results) {
    say(stderr, "slipbench: interrupted: nothing is kept\n");
    return exit_interrupted;
  }
  const Style style = style_for(stdout);
  if (compares) {
    const std::vector<counts::SceneChange> changes = counts::compare(before->results, *results);
    if (options.json) {
      fmt::print("{}\n", comparison_json(changes, before->path).dump());
    } else {
      fmt::print("{}", comparison_text(changes, before->path, style));
    }
    return std::ranges::any_of(changes, &counts::SceneChange::grew) ? exit_check_failed : exit_good;
  }
  if (!options.output.empty()) {
    write_text_file(options.output, counts::results_json(*results));
    write_text_file(drawing_beside(options.output), counts::drawing(*results));
  }
  if (options.json) {
    fmt::print("{}\n", counts_json(*results).dump());
  } else {
    fmt::print("{}", counts_text(*results, style));
  }
  return exit_good;
}

}  // namespace slipbench

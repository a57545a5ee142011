#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands/simulation/simulation_commands.h"
#include "tools/cli/format/check_text.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/record/json.h"
#include "tools/files/output_file.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/warnings.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench {
namespace {

// NaN becomes null.
Json check_json(const SceneCheck& check) {
  Json expectations = Json::array();
  for (const ExpectationResult& result : check.expectations) {
    expectations.push_back({{"name", result.name},
                            {"limit", result.limit},
                            {"passed", result.passed()},
                            {"kept", result.kept},
                            {"trials", result.trials},
                            {"needed", result.needed},
                            {"interval", {result.rate.low, result.rate.high}},
                            {"median", result.median},
                            {"worst", result.worst.value},
                            {"worst_trial", result.worst.trial},
                            {"control_kept", or_null(result.control_kept)},
                            {"replay", result.replay}});
  }
  return {{"scene", check.scene_path},
          {"verdict", verdict_text(check.verdict)},
          {"seed", check.seed},
          {"confidence", check.confidence},
          {"control", check.control.empty() ? Json(nullptr) : Json(check.control)},
          {"control_trials", check.control_trials},
          {"expectations", std::move(expectations)},
          {"detectors", detectors_json(check.detectors)},
          {"failures", check.failures},
          {"warnings", warnings_json(check.warnings)},
          {"replayed", or_null(check.replayed)},
          {"files", check.files}};
}

// Returns a separate folder for each scene, named after its file.
std::string folder_of(const std::string& scene, const std::string& parent, std::set<std::string>& taken) {
  const std::string stem = std::filesystem::path(scene).stem().string();
  std::string name = stem;
  for (int next = 2; !taken.insert(name).second; ++next) name = fmt::format("{}_{}", stem, next);
  return (std::filesystem::path(parent) / name).string();
}

const TextKind junit_kind{"JUnit report", [](std::string_view beginning) {
                            return beginning.starts_with("<?xml") && beginning.find("<testsuites") != std::string_view::npos;
                          }};

bool good(const SceneCheck& check) { return check.verdict == Verdict::passed || check.verdict == Verdict::not_checked; }

void print_total(const std::vector<SceneCheck>& checks, const Style& style) {
  const auto count = [&](Verdict verdict) { return std::ranges::count(checks, verdict, &SceneCheck::verdict); };
  std::string text = fmt::format("{} of {} passed", count(Verdict::passed), counted(checks.size(), "scene"));
  for (const Verdict verdict : {Verdict::failed, Verdict::tests_nothing, Verdict::not_checked}) {
    if (count(verdict) > 0) text += fmt::format(", {} {}", count(verdict), verdict_text(verdict));
  }
  print_text("{}\n", std::ranges::all_of(checks, good) ? style.good(text) : style.error(text));
}

// Returns the checks, with a folder for each scene. Throws InputError before anything runs: for a
// scene that cannot be read, if no scene expects anything, and for a JUnit file that cannot be
// written.
std::vector<CheckOptions> plan_checks(const CheckCommand& command, const Catalogues& catalogues) {
  if (!command.junit.empty()) check_text_target(command.junit, command.scenes, junit_kind);
  std::set<std::string> taken;
  std::vector<CheckOptions> planned;
  bool any = false;
  for (const std::string& scene : command.scenes) {
    planned.push_back(command.options);
    planned.back().scene_path = scene;
    planned.back().folder = folder_of(scene, command.output, taken);
    planned.back().interrupt = &InterruptGuard::flag();
    any = expects_anything(planned.back(), catalogues) || any;
  }
  if (!any) {
    throw InputError(
        "check: no scene has expectations; at least one needs a key 'expect', such as 'expect: {gross_slip_by: 1 s}'");
  }
  return planned;
}

// Prints and adds the warnings of the scene.
SceneCheck check_warned(CheckOptions& check, const Catalogues& catalogues, const CheckCommand& command) {
  std::vector<Warning> warnings;
  if (expects_anything(check, catalogues)) {
    SweepOptions sweep = sweep_of(check);
    const ReadSweep read = read_sweep(sweep, catalogues);
    sweep.isolation = check.isolation = command.isolation.chosen(read, sweep);
    warnings = scene_warnings(read, sweep);
    print_warnings(warnings);
  }
  // During the planning of trials, a signal ends the program as usual.
  std::optional<InterruptGuard> guard;
  check.on_start = [&guard] { guard.emplace(); };
  Progress progress = Progress::for_stream(stderr, command.silent());
  SceneCheck found = check_scene(
      check, catalogues, [&progress](const SweepProgress& state) { progress.update(state.done, state.total, state.simulated); });
  print_warnings(found.warnings);
  found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
  return found;
}

}  // namespace

void CheckCommand::declare(Arguments& arguments) {
  arguments.about("check", "Test scenes against their expectations", R"(
The key `expect` of a scene states the expected results of its trials (`slipbench list expectations`),
and `sweep` the number of trials. An expectation passes if enough trials meet it (`pass`,
`reliability`); the exact (Clopper-Pearson) interval of the rate is printed too. Then all trials run
again with the negative control, a controller that never tightens on slip. If the control passes too,
the scene tests nothing, which is a failure. Scenes without `expect` are skipped.

For a failed scene the most informative trial is written to DIR/SCENE/trial_K.h5 and .html, and the
command that replays it is printed. To test your own controller or detector, use
--set "controller={type: plugin, library: /path/to/mine.so}".

Examples:
  slipbench check scenes/grasp/*.yaml --junit check.xml
  slipbench check scenes/grasp/check_ptfe.yaml --set controller.debounce=2 --trials 5 -o check)");
  arguments.scenes("SCENE ...", scenes, "Scene files (YAML), or names of shipped scenes").required();
  arguments.overrides(options.overrides, options.seed);
  arguments.flag("-q,--quiet", quiet, "Print no progress and no summary");
  arguments.number("--trials N", options.trials, "Number of random draws for each cell of the grid", 1);
  arguments.jobs(options.jobs);
  isolation.declare(arguments);
  arguments.output("--junit FILE.xml", junit, "Write the results as JUnit XML; -: to standard output");
  arguments.folder("-o,--output DIR", output, "Folder for the trials of failed checks (default: slipbench-check)");
}

int CheckCommand::run() {
  const Catalogues catalogues = program_catalogues();
  const Style style = style_for(stdout);
  const bool prints = !silent();
  std::vector<CheckOptions> planned = plan_checks(*this, catalogues);
  std::vector<SceneCheck> checks;
  try {
    for (CheckOptions& check : planned) {
      checks.push_back(check_warned(check, catalogues, *this));
      if (prints) {
        print_text("{}\n", check_text(checks.back(), style));
        std::fflush(stdout);
      }
    }
  } catch (const Interrupted&) {
    say(stderr, fmt::format("slipbench: interrupted: {} of {} checked\n", checks.size(), counted(planned.size(), "scene")));
    return exit_interrupted;
  }
  if (!junit.empty()) write_text_file(junit, junit_xml(checks));
  const bool passed = std::ranges::all_of(checks, good);
  if (json) {
    Json scenes = Json::array();
    for (const SceneCheck& check : checks) scenes.push_back(check_json(check));
    print_json({{"passed", passed}, {"scenes", std::move(scenes)}});
  } else if (prints) {
    print_total(checks, style);
  }
  return passed ? exit_good : exit_check_failed;
}

}  // namespace slipbench

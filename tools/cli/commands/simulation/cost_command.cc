#include "tools/cli/commands/simulation/simulation_commands.h"

#include <cstdio>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "tools/cli/arguments.h"
#include "tools/cli/format/eval_text.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/cli/terminal.h"
#include "tools/cost/reading.h"
#include "tools/cost/setting_search.h"
#include "tools/doctor/doctor.h"
#include "tools/registry/program_catalogues.h"
#include "tools/workers/interrupt_guard.h"
#ifdef SLIPBENCH_WITH_MUJOCO
#include "tools/cost/stability_map.h"
#endif

namespace slipbench {
namespace {

std::string command_text(const CostCommand& command) {
  const cost::ExploreOptions& explore = command.explore;
  std::string text = "slipbench cost";
  if (!explore.scene_path.empty())
    text += fmt::format(" {} --budget {}", shell_word(explore.scene_path), shell_word(fmt::format("{:g} s", explore.budget)));
  for (const Override& change : explore.overrides) text += " --set " + shell_word(change.path + "=" + change.value);
  if (explore.seed) text += fmt::format(" --seed {}", *explore.seed);
  if (explore.trial != 0) text += fmt::format(" --trial {}", explore.trial);
  if (command.stability) text += " --stability";
  return text;
}

cost::Exploration explored(const CostCommand& command) {
  cost::ExploreOptions explore = command.explore;
  explore.say = [&command](const std::string& what) { command.print_status(what); };
  const InterruptGuard guard("summarising the measurements");
  explore.interrupt = &InterruptGuard::flag();
  cost::Exploration exploration = cost::explore(explore, program_catalogues());
  exploration.command = command_text(command);
  return exploration;
}

// The map of stable steps, as JSON and as text.
struct Stability {
  Json json;
  std::string text;
};
#ifdef SLIPBENCH_WITH_MUJOCO
Stability measured_stability() {
  const cost::StabilityMap map = cost::measure_stability();
  return {cost::stability_json(map), cost::stability_text(map)};
}
#else
Stability measured_stability() { throw InputError("cost: --stability needs MuJoCo, but this program was built without it"); }
#endif

}  // namespace

void CostCommand::declare(Arguments& arguments) {
  arguments.about("cost", "Measure CPU time against accuracy", R"(
Runs a trial of the scene with other time steps, integrators, solvers, fidelities, numbers of elements
and output rates, and with MuJoCo's own contact instead of the field. It measures the CPU time of
each, and the errors of onsets, slip distances, forces, labels, outcome and detector against the
closed form or a much finer run. It also measures the cost and influence of each effect and each part
of the electronics. It runs until the budget is used up. With -o the diagram is written to FILE.html
and all figures to FILE.json.

--accuracy instead finds the cheapest time step and solver with which no error exceeds the given one in
up to five trials of the sweep, and prints them for --set. MEASURE is onset, micro_onset,
slip_distance, force, label, label_micro (a share) or creep (a speed).

--stability measures the longest stable time step against stiffness, mass and damping, and compares
it with the predicted one; it needs no scene.

Examples:
  slipbench cost scenes/papillarray/stage.yaml --budget 30s -o cost.html
  slipbench cost scenes/grasp/lift.yaml --set box.mass="0.5 kg" --json
  slipbench cost scenes/papillarray/stage.yaml --accuracy onset=1%
  slipbench cost --stability -o stability.html)");
  arguments.scene("SCENE", explore.scene_path, "Scene file (YAML), or name of a shipped scene");
  arguments.quantity("--budget TIME", explore.budget, "Total time, e.g. 60s or '2 min' (default: 60 s)", Quantity::time);
  arguments.lines("--accuracy MEASURE=ERROR", accuracy, "Find the cheapest setting with at most this error; may be repeated");
  arguments.flag("--stability", stability, "Measure the longest stable time steps");
  arguments.overrides(explore.overrides, explore.seed);
  arguments.flag("-q,--quiet", quiet, "Print no progress and no summary");
  arguments.number("--trial K", explore.trial, "Trial of the sweep to run (default: the first)", 0);
  arguments.output("-o,--output FILE.html", output, "Write the page, and FILE.json; -: only the page");
  arguments.then([this] {
    if (explore.scene_path.empty() && !stability) {
      throw InputError("cost: give SCENE.yaml, --stability, or both");
    }
    const cost::ExploreOptions usual;
    if (!accuracy.empty() && (explore.scene_path.empty() || stability || !output.empty() || explore.trial != usual.trial ||
                              explore.budget != usual.budget)) {
      throw InputError("cost: --accuracy needs SCENE.yaml, and can only be combined with --set, --seed, --quiet and --json");
    }
  });
}

int CostCommand::search() const {
  std::vector<Requirement> required;
  for (const std::string& text : accuracy) required.push_back(parse_requirement(text));
  SweepOptions sweep;
  sweep.verb = "run";
  sweep.scene_path = explore.scene_path;
  sweep.overrides = explore.overrides;
  sweep.seed = explore.seed;
  const Catalogues catalogues = program_catalogues();
  const ReadSweep read = read_sweep(sweep, catalogues);
  print_status("searching for the cheapest setting");
  const FoundSetting found = find_setting(read, required);
  std::string set, errors;
  Json setting = Json::object(), reached = Json::object();
  for (const Override& change : found.overrides) {
    set += " " + shell_word(change.path + "=" + change.value);
    setting[change.path] = change.value;
  }
  for (const Requirement& one : required) {
    const MeasureInfo& info = info_of(one.measure);
    const double worst = at(found.tried.back().errors, one.measure).value().worst;
    errors += fmt::format("{}{} error {}, allowed {}", errors.empty() ? "" : "; ", info.title, error_text(one.measure, worst),
                          error_text(one.measure, one.limit));
    reached[std::string(info.name)] = {{"worst", worst}, {"allowed", one.limit}};
  }
  sweep.overrides.insert(sweep.overrides.end(), found.overrides.begin(), found.overrides.end());
  const std::string command = canonical_command(sweep);
  if (json) {
    return print_json({{"setting", setting},
                       {"errors", reached},
                       {"reference", found.reference},
                       {"trials", found.trials},
                       {"command", command}});
  }
  print_text("--set{}\n", set);
  if (!quiet) {
    print_text("{}, compared with {} in {}\n", errors, found.reference, counted(found.trials.size(), "trial"));
    print_next(command);
  }
  return exit_good;
}

int CostCommand::run() {
  if (!accuracy.empty()) return search();
  if (!output.empty()) page::check_page_files(output, cost::page_kind);
  const Json environment = environment_json();  // before the work, which would count as load
  Json found = Json::object();
  std::string text;
  bool interrupted = false;
  if (!explore.scene_path.empty()) {
    const cost::Exploration exploration = explored(*this);
    found = cost::cost_json(exploration, environment);
    text = cost_text(exploration, style_for(stdout), terminal_width(stdout));
    interrupted = exploration.interrupted;
  }
  if (stability && !interrupted) {
    print_status("measuring the longest stable steps");
    auto [map, map_text] = measured_stability();
    map["command"] = command_text(*this);
    map["environment"] = environment;
    text += (text.empty() ? "" : "\n") + map_text;
    if (found.empty()) {
      found = std::move(map);
    } else {
      found["stability"] = std::move(map);
    }
  }
  std::vector<std::string> files;
  if (!output.empty()) files = page::write_page_files(output, cost::page_kind, cost::cost_page(found), found);
  if (json) {
    print_json(found);
  } else {
    if (!quiet) print_text("{}", text);
    print_written(files);
  }
  return interrupted ? exit_interrupted : exit_good;
}

}  // namespace slipbench

#include "tools/cli/commands/simulation/simulation_commands.h"

#include <cstdio>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/cli/arguments.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/cli/terminal.h"
#include "tools/doctor/doctor.h"
#include "tools/registry/program_catalogues.h"
#include "tools/workers/interrupt_guard.h"
#ifdef SLIPBENCH_WITH_MUJOCO
#include "tools/cli/format/eval_text.h"
#include "tools/cost/reading.h"
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
  explore.say = [&command](const std::string& what) { command.tell(what); };
  const InterruptGuard guard("summing up what has been measured");
  explore.interrupt = &InterruptGuard::flag();
  cost::Exploration exploration = cost::explore(explore, program_catalogues());
  exploration.command = command_text(command);
  return exploration;
}

// The map of stable steps as an object and as text.
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
Stability measured_stability() { throw InputError("cost: --stability needs MuJoCo, which this program was built without"); }
#endif

}  // namespace

void CostCommand::declare(Arguments& arguments) {
  arguments.about("cost", "Show what accuracy costs in time", R"(
Runs a trial of the scene with other time steps, integrators, solvers, fidelities, numbers of elements and output rates, and with MuJoCo's own
contact in place of the field; measures the CPU time of each and how far onsets, slipped distances, forces, labels, the outcome and the detector
are from the closed form or from a far finer run; and what each effect and each part of the electronics costs and changes. It takes the
time of the budget. With -o the diagram goes to FILE.html and all figures to FILE.json beside it.
--stability measures the longest stable step over stiffness, mass and damping, beside the one that is predicted; a scene is not needed then.

Examples:
  slipbench cost scenes/papillarray/stage.yaml --budget 30s -o cost.html
  slipbench cost scenes/grasp/lift.yaml --set box.mass="0.5 kg" --json
  slipbench cost --stability -o stability.html)");
  arguments.scene("SCENE", explore.scene_path, "Scene file (YAML), or name of a shipped scene");
  arguments.quantity("--budget TIME", explore.budget, "Time to spend, e.g. 60s or '2 min' (default: 60 s)", Quantity::time);
  arguments.flag("--stability", stability, "Map the longest stable steps");
  arguments.overrides(explore.overrides, explore.seed);
  arguments.flag("-q,--quiet", quiet, "No progress and no summary");
  arguments.number("--trial K", explore.trial, "Trial of the scene's sweep (default: the first)", 0);
  arguments.output("-o,--output FILE.html", output, "Write the page, and FILE.json beside it; -: the page alone");
  arguments.then([this] {
    if (explore.scene_path.empty() && !stability) {
      throw InputError("cost: a scene is missing; allowed: SCENE.yaml, --stability, or both");
    }
  });
}

int CostCommand::run() {
  if (!output.empty()) page::check_page_files(output, cost::page_kind);
  const Json environment = environment_json();  // before the work, which is load itself
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
    tell("measuring the longest stable steps");
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
    if (!quiet) fmt::print("{}", text);
    print_written(files);
  }
  return interrupted ? exit_interrupted : exit_good;
}

}  // namespace slipbench

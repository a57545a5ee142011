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

--stability measures the longest stable time step against stiffness, mass and damping, and compares
it with the predicted one; it needs no scene.

Examples:
  slipbench cost scenes/papillarray/stage.yaml --budget 30s -o cost.html
  slipbench cost scenes/grasp/lift.yaml --set box.mass="0.5 kg" --json
  slipbench cost --stability -o stability.html)");
  arguments.scene("SCENE", explore.scene_path, "Scene file (YAML), or name of a shipped scene");
  arguments.quantity("--budget TIME", explore.budget, "Total time, e.g. 60s or '2 min' (default: 60 s)", Quantity::time);
  arguments.flag("--stability", stability, "Measure the longest stable time steps");
  arguments.overrides(explore.overrides, explore.seed);
  arguments.flag("-q,--quiet", quiet, "Print no progress and no summary");
  arguments.number("--trial K", explore.trial, "Trial of the sweep to run (default: the first)", 0);
  arguments.output("-o,--output FILE.html", output, "Write the page, and FILE.json; -: only the page");
  arguments.then([this] {
    if (explore.scene_path.empty() && !stability) {
      throw InputError("cost: give SCENE.yaml, --stability, or both");
    }
  });
}

int CostCommand::run() {
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
    if (!quiet) print_text("{}", text);
    print_written(files);
  }
  return interrupted ? exit_interrupted : exit_good;
}

}  // namespace slipbench

#include <cstdio>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/workers/interrupt.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/commands.h"
#include "tools/program/cli/cost_text.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/cost/cost_json.h"
#include "tools/program/cost/cost_page.h"
#include "tools/program/cost/explore.h"
#include "tools/program/doctor/environment.h"
#include "tools/program/run/run_sweep.h"
#ifdef SLIPBENCH_WITH_MUJOCO
#include "tools/program/cost/stability_map.h"
#endif

namespace slipbench {
namespace {

using Json = nlohmann::ordered_json;

std::string command_text(const Options& options) {
  std::string text = "slipbench cost";
  if (!options.scene.empty())
    text += fmt::format(" {} --budget {}", shell_word(options.scene), shell_word(fmt::format("{:g} s", options.budget)));
  for (const Override& change : options.overrides) text += " --set " + shell_word(change.path + "=" + change.value);
  if (options.seed) text += fmt::format(" --seed {}", *options.seed);
  if (options.trial) text += fmt::format(" --trial {}", *options.trial);
  if (options.stability) text += " --stability";
  return text;
}

std::function<void(const std::string&)> sayer(const Options& options) {
  if (options.quiet || options.json) return {};
  return [](const std::string& what) { say(stderr, fmt::format("slipbench: {}\n", what)); };
}

cost::Exploration explored(const Options& options) {
  cost::ExploreOptions explore;
  explore.scene_path = options.scene;
  explore.overrides = options.overrides;
  explore.seed = options.seed;
  explore.trial = options.trial.value_or(0);
  explore.budget = options.budget;
  explore.say = sayer(options);
  const InterruptGuard guard("summing up what has been measured");
  explore.interrupt = &InterruptGuard::flag();
  cost::Exploration exploration = cost::explore(explore, program_catalogues());
  exploration.command = command_text(options);
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

int cost_command(const Options& options) {
  if (!options.output.empty()) cost::check_cost_target(options.output);
  const Style style = style_for(stdout);
  const Json environment = environment_json();  // before the work, which is load itself
  Json json = Json::object();
  std::string text;
  bool interrupted = false;
  if (!options.scene.empty()) {
    cost::Exploration exploration;
    try {
      exploration = explored(options);
    } catch (const cost::Interrupted&) {
      say(stderr, "slipbench: interrupted; nothing is kept\n");
      return exit_interrupted;
    }
    json = cost::cost_json(exploration, environment);
    text = cost_text(exploration, style, terminal_width(stdout));
    interrupted = exploration.interrupted;
  }
  if (options.stability && !interrupted) {
    if (const auto tell = sayer(options)) tell("measuring the longest stable steps");
    auto [map, map_text] = measured_stability();
    map["command"] = command_text(options);
    map["environment"] = environment;
    text += (text.empty() ? "" : "\n") + map_text;
    if (json.empty()) {
      json = std::move(map);
    } else {
      json["stability"] = std::move(map);
    }
  }
  std::vector<std::string> files;
  if (!options.output.empty()) files = cost::write_cost(options.output, json);
  if (options.json) {
    fmt::print("{}\n", json.dump());
  } else {
    if (!options.quiet) fmt::print("{}", text);
    for (const std::string& file : files) fmt::print("{} {}\n", style.good("written:"), file);
  }
  return interrupted ? exit_interrupted : exit_good;
}

}  // namespace slipbench

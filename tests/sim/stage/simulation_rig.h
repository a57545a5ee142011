// Scenes built in C++, without the parser.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "sim/api/motion.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/stage/stage_setup.h"
#include "sim/stage/stage_simulation.h"
#include "tests/oracle/pads.h"

namespace slipbench::testing_bench {

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

template <class Catalogue>
Named named(const Catalogue& catalogue, const std::string& name, const Changes& changes = {}) {
  const auto& kind = *std::find_if(catalogue.begin(), catalogue.end(), [&](const auto& k) { return k.about.name == name; });
  Named result{name, defaults_of(kind.about.parameters)};
  for (const auto& [key, value] : changes) result.parameters.set(key, value);
  return result;
}

// 4 s on a plane of friction 0.5 at 1 ms, with the stage's defaults except `changes`, and one
// sensor per pad.
inline Scene scene(std::size_t sensors = 1, const Changes& changes = {}) {
  Scene result;
  result.duration = 4.0;
  result.time_step = 1e-3;
  result.surface = named(surface_catalogue(), "plane");
  result.friction = {0.5, 0.5, 1.0};
  result.motion = named(motion_catalogue(), "stage", changes);
  for (std::size_t k = 0; k < sensors; ++k) result.sensors.push_back({"pad" + std::to_string(k), "test", {}, {}});
  return result;
}

inline StageSimulation simulation(const Scene& scene, const std::vector<const PadLayout*>& pads, const std::vector<double>& rates,
                                  std::uint64_t trial = 0) {
  return StageSimulation(scene, pads, rates, trial);
}

}  // namespace slipbench::testing_bench

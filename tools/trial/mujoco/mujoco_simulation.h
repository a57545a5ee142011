// Simulations that MuJoCo computes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sim/api/pad_layout.h"
#include "sim/api/simulation.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Returns the simulation of a scene with bodies, a grasp, or pads as articulated pillars. `pads` and
// `rates` [Hz]: of the scene's sensors, in their order. `trial`: number of the trial. Throws
// SceneValueError if the scene is not possible, or if the program was built without MuJoCo. Two
// libraries define the function: slipbench::mujoco_trials, and slipbench::no_mujoco_trials, which
// always throws.
std::unique_ptr<Simulation> make_mujoco_simulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                                   std::span<const double> rates, std::uint64_t trial);

}  // namespace slipbench

#include "tools/trial/mujoco/mujoco_simulation.h"

#include "sim/mujoco/articulated/articulated_stage.h"
#include "sim/mujoco/bodies/dynamic_simulation.h"
#include "sim/mujoco/bodies/grasp_simulation.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "tools/registry/program_catalogues.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {

std::unique_ptr<Simulation> make_mujoco_simulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                                   std::span<const double> rates, std::uint64_t trial) {
  if (!scene.dynamic()) return articulated_simulation(scene, pads, rates, trial);
  [[maybe_unused]] static const bool registered = (register_bench_plugin({pad_catalogues(), &make_sensor}), true);
  if (scene.grasp) return std::make_unique<GraspSimulation>(scene, pads, rates, trial);
  return std::make_unique<DynamicSimulation>(scene, pads, rates, trial);
}

}  // namespace slipbench

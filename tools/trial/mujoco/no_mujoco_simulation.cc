#include <string>

#include "sim/core/error.h"
#include "tools/trial/mujoco/mujoco_simulation.h"

namespace slipbench {

std::unique_ptr<Simulation> make_mujoco_simulation(const Scene& scene, std::span<const PadLayout* const> /*pads*/,
                                                   std::span<const double> /*rates*/, std::uint64_t /*trial*/) {
  const std::string key = !scene.dynamic() ? "fidelity" : scene.grasp ? "grip" : scene.model.empty() ? "bodies" : "model";
  throw SceneValueError(key, "needs MuJoCo, but this program was built without it");
}

}  // namespace slipbench

// Replaces implicit.cc in the plugin's build for MuJoCo 3.3.7, which has no integrator `discrete`:
// a model with implicit pads is refused when it is made, so that the other functions are never
// called.
#include <stdexcept>

#include <mujoco/mujoco.h>

#include "sim/mujoco/pads/implicit.h"

namespace slipbench {

std::string implicit_refusal(const mjModel* /*m*/, std::span<const ImplicitPad> /*pads*/) {
  return std::string("needs the integrator discrete, which MuJoCo ") + mj_versionString() +
         " does not have; use MuJoCo 4.0.1, or the explicit solver";
}

std::string implicit_self_test(const mjModel* m, std::span<const ImplicitPad> pads) { return implicit_refusal(m, pads); }

std::string ImplicitFields::apply(const mjModel* m, mjData* /*d*/, std::span<const ImplicitContact> /*contacts*/,
                                  std::span<const double> /*memory*/, double /*viscous_time*/) {
  return implicit_refusal(m, {});
}

void ImplicitFields::finish(const mjModel* /*m*/, const mjData* /*d*/, std::span<double> /*memory*/) {
  throw std::logic_error("ImplicitFields::finish: MuJoCo has no effective metric");
}

}  // namespace slipbench

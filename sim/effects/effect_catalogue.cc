#include "sim/effects/effect_catalogue.h"

namespace slipbench {

const std::vector<EffectKind>& effect_catalogue() {
  static const std::vector<EffectKind> kinds{
      ageing(),          anisotropic_friction(),
      asperities(),      elastic_skin(),
      inertia(),         load_dependent_friction(),
      patchy_friction(), roughness(),
      stribeck(),        texture(),
      viscoelastic(),    viscous_friction(),
  };
  return kinds;
}

}  // namespace slipbench

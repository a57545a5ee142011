// The catalogue with one more effect, linked in place of sim/effects/effect_catalogue.cc to measure
// the cost of a step.
#include "sim/effects/effect_catalogue.h"

namespace slipbench {
namespace {

class Nothing final : public FrictionEffect {
 public:
  void scale(const ElementColumns& /*elements*/, double* /*mu_s*/, double* /*mu_k*/) override {}
};

EffectKind nothing() {
  return {{"nothing", "Does nothing.", "mu = mu", "this test", {}},
          {},
          [](const Parameters&, const EffectContext&, FieldEffects& effects) {
            effects.friction.push_back(std::make_unique<Nothing>());
          }};
}

}  // namespace

const std::vector<EffectKind>& effect_catalogue() {
  static const std::vector<EffectKind> effects{
      ageing(),  anisotropic_friction(), load_dependent_friction(), nothing(), patchy_friction(), stribeck(),
      texture(), viscoelastic(),         viscous_friction(),
  };
  return effects;
}

}  // namespace slipbench

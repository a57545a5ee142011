#include "tools/studies/nib_reconfigurable/nib_laws.h"

#include <algorithm>
#include <vector>

#include "sim/effects/effect_catalogue.h"

namespace slipbench::reproduce {
namespace {

void drop(Scene& scene, const char* effect) {
  std::erase_if(scene.effects, [&](const Named& named) { return named.name == effect; });
}
void set_patches(Scene& scene, double sd) {
  for (Named& effect : scene.effects) {
    if (effect.name == "patchy_friction") effect.parameters.set("sd", sd);
  }
}
void add_lean(Scene& scene) {
  const auto& all = effect_catalogue();
  const auto lean = std::ranges::find(all, "lean", [](const EffectKind& kind) { return kind.about.name; });
  scene.effects.push_back({lean->about.name, defaults_of(lean->about.parameters)});
}
// Coulomb's law, mu_k 0.9 mu_s.
void drop_to_kinetic(Scene& scene) { scene.friction.kinetic_coefficient = 0.9 * scene.friction.static_coefficient; }

}  // namespace

const std::vector<FrictionLaw>& friction_laws() {
  static const std::vector<FrictionLaw> all{
      {"scene", "as in the scene: rate law, patches 0.3", [](Scene&) {}},
      {"lean", "as in the scene, nibs that lean", add_lean},
      {"patches_0.2", "patches 0.2", [](Scene& scene) { set_patches(scene, 0.2); }},
      {"patches_0.1", "patches 0.1", [](Scene& scene) { set_patches(scene, 0.1); }},
      {"no_patches", "no patches", [](Scene& scene) { drop(scene, "patchy_friction"); }},
      {"no_rate", "no rate law", [](Scene& scene) { drop(scene, "viscous_friction"); }},
      {"coulomb", "Coulomb, mu_k 0.9 mu_s, no patches",
       [](Scene& scene) {
         drop(scene, "patchy_friction");
         drop(scene, "viscous_friction");
         drop_to_kinetic(scene);
       }},
      {"coulomb_patches", "Coulomb, mu_k 0.9 mu_s, patches 0.3",
       [](Scene& scene) {
         drop(scene, "viscous_friction");
         drop_to_kinetic(scene);
       }},
  };
  return all;
}

}  // namespace slipbench::reproduce

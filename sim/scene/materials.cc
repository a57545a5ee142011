#include "sim/scene/materials.h"

namespace slipbench {

std::vector<Material> material_table() {
  return {
      {"acrylic", 0.5, 0.5,
       "assumed: the round value of the example scene; a vendor recording on an unknown rigid face peaks at 0.40"},
      {"ptfe", 0.35, 0.3325,
       "assumed: a held light box was never dropped in the published grasps, which needs about 0.35; kinetic 0.95 of it"},
      {"rubber", 1.0, 0.95, "assumed: silicone on rubber grips about its own load; kinetic 0.95 of it"},
      {"felt", 0.45, 0.4275, "assumed: between ptfe and rubber, as the published slip distances order them; kinetic 0.95 of it"},
      {"paper", 0.65, 0.6175, "assumed: fits the published grip force at slip of the nib pad; kinetic 0.95 of it"},
      {"masonite", 0.5, 0.475, "assumed: fits the published grip force at slip of the nib pad; kinetic 0.95 of it"},
      {"wavy_acrylic", 0.55, 0.5225, "assumed: fits the published grip force at slip of the nib pad; kinetic 0.95 of it"},
      {"soaped_wavy_acrylic", 0.07, 0.0665,
       "static: measured, 'Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation', text to Table II; kinetic assumed 0.95 of it"},
      {"wet_ptfe", 0.28, 0.266, "assumed: 0.8 of dry, since PTFE sheds the water; kinetic 0.95 of it"},
      {"wet_rubber", 0.6, 0.57, "assumed: 0.6 of dry, a film of water between two rubbers; kinetic 0.95 of it"},
      {"wet_felt", 0.36, 0.342, "assumed: 0.8 of dry, since felt takes the water up; kinetic 0.95 of it"},
      {"wet_paper", 0.52, 0.494, "assumed: 0.8 of dry, since paper takes the water up; kinetic 0.95 of it"},
      {"glass", 0.6, 0.57, "assumed: smooth and clean, a little above acrylic; kinetic 0.95 of it"},
      {"cardboard", 0.55, 0.5225, "assumed: a little below paper; kinetic 0.95 of it"},
  };
}

}  // namespace slipbench

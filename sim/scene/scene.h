// A scene: everything that a scene file says, checked and in SI.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// A catalogue entry named by a scene, with the values of its parameters.
struct Named {
  std::string name;
  Parameters parameters;
};

// One sensor of a scene.
struct SensorScene {
  std::string name;  // the scene's own name for it: "pad"
  std::string type;  // "papillarray"
  Parameters parameters;
  std::vector<Named> electronics;  // empty: ideal
};

// Friction of the touched surface, after the scene's own values have overridden the material's and `scale` has multiplied both.
struct FrictionScene {
  double static_coefficient = 0.0;   // mu_s
  double kinetic_coefficient = 0.0;  // mu_k <= mu_s
  double scale = 1.0;                // already contained in both
};

struct Scene {
  std::string description;
  double duration = 0.0;            // s
  std::optional<double> time_step;  // s; empty: auto
  std::string fidelity = "field";
  std::uint64_t seed = 0;
  std::string material;
  Named surface;  // name is the shape: plane, box, cylinder, sphere
  FrictionScene friction;
  Named motion;  // name is the kind: stage
  std::vector<SensorScene> sensors;
  std::vector<Named> effects;
  bool expects = false;  // it says under `expect` what must come out
};

}  // namespace slipbench

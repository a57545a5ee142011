// A field with one effect from the catalogue.
#pragma once

#include <map>
#include <string>

#include "tests/sim/effects/effect_rig.h"

namespace slipbench::oracle {

// Builds `pad` on `surface` with the catalogue's effect `name`, with its defaults except `changes`
// (SI).
inline Field field_with_effect(const PadLayout& pad, Friction friction, const std::string& name,
                               const std::map<std::string, double>& changes = {}, const Surface& surface = Plane{}) {
  return Field(pad, surface, friction, testing_effects::installed(pad, {{name, changes}}));
}

}  // namespace slipbench::oracle

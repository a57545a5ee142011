// A field with one effect from the catalogue.
#pragma once

#include <algorithm>
#include <map>
#include <string>

#include "sim/effects/effect_catalogue.h"
#include "sim/field/field.h"

namespace slipbench::oracle {

// Builds `pad` on `surface` with the catalogue's effect `name` at its defaults, but for `changes` (SI).
inline Field field_with_effect(const PadLayout& pad, Friction friction, const std::string& name,
                               const std::map<std::string, double>& changes = {}, const Surface& surface = Plane{}) {
  const auto& effects = effect_catalogue();
  const auto& kind = *std::find_if(effects.begin(), effects.end(), [&](const EffectKind& e) { return e.about.name == name; });
  Parameters parameters = defaults_of(kind.about.parameters);
  for (const auto& [key, value] : changes) parameters.set(key, value);
  EffectContext context;
  context.layout = &pad;
  context.elements = pad.elements.size();
  context.seed = 7;
  for (const UnitRange& unit : pad.units) {
    for (std::size_t i = 0; i < unit.count; ++i) context.share.push_back(1.0 / static_cast<double>(unit.count));
  }
  for (const Element& element : pad.elements) {
    context.k_normal.push_back(element.k_normal);
    context.k_tangential.push_back(element.k_tangential);
  }
  FieldEffects installed;
  kind.install(parameters, context, installed);
  return Field(pad, surface, friction, std::move(installed));
}

}  // namespace slipbench::oracle

#include "sim/mujoco/pads/pad_field.h"

#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

std::string name_of_geom(ModelView model, int geom) {
  const char* name = model.name_of(mj::geom, geom);
  return name == nullptr ? std::to_string(geom) : name;
}

PadLayout without_dashpots(PadLayout layout) {
  for (Element& element : layout.elements) element.c_normal = element.c_tangential = 0.0;
  return layout;
}

Field make_pad_field(ModelView model, const PadConfig& config, const PadLayout& layout, int geom, const Surface& surface) {
  FieldEffects effects;
  try {
    effects = install_effects(config.effects, layout, surface, config.seed, config.trial);
  } catch (const SceneValueError& error) {
    throw InputError(fmt::format("plugin '{}', geom '{}': {}", config.name, name_of_geom(model, geom), error.what()));
  }
  // Bodies that move by forces accelerate below the tips, and are solved with springs that have no
  // state of their own.
  if (effects.tip) {
    throw InputError(fmt::format(
        "plugin '{}': effects: tips with mass work only for pads with a prescribed motion; leave that effect out", config.name));
  }
  if (effects.skin && config.implicit) {
    throw InputError(fmt::format(
        "plugin '{}': effects: an elastic skin does not work with the implicit solver; use solver='explicit'", config.name));
  }
  return {layout, surface, config.friction, std::move(effects)};
}

Surface kind_of_surface(int geom_type) {
  if (geom_type == mj::plane_geom) return Plane{};
  if (geom_type == mj::box_geom) return Box{{1.0, 1.0, 1.0}};
  return Sphere{1.0};
}

}  // namespace slipbench

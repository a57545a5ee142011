// Fields with any list of effects on any surface, installed as by a scene.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "sim/contact/field.h"
#include "sim/effects/effect_catalogue.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_effects {

// An effect of the catalogue with its defaults, except `changes` (SI).
struct Wanted {
  std::string name;
  std::map<std::string, double> changes;
};

inline const EffectKind& kind_named(std::string_view name) {
  const auto& effects = effect_catalogue();
  return *std::find_if(effects.begin(), effects.end(), [&](const EffectKind& kind) { return kind.about.name == name; });
}

// An effect with its defaults, after the effect that it needs.
inline std::vector<Wanted> alone(const EffectKind& kind) {
  if (kind.body != nullptr) return {{kind.about.name, {{"patch", 3e-4}}}};  // for pads without a grid
  if (kind.after_tip) return {{"inertia", {}}, {kind.about.name, {}}};
  return {{kind.about.name, {}}};
}

inline EffectContext context_for(const PadLayout& pad, bool flat_surface, std::uint64_t seed, std::uint64_t trial) {
  EffectContext context;
  context.layout = &pad;
  context.elements = pad.elements.size();
  context.flat_surface = flat_surface;
  context.seed = seed;
  context.trial = trial;
  for (const UnitRange& unit : pad.units)
    context.share.insert(context.share.end(), unit.count, 1.0 / static_cast<double>(unit.count));
  for (const Element& element : pad.elements) {
    context.k_normal.push_back(element.k_normal);
    context.k_tangential.push_back(element.k_tangential);
  }
  return context;
}

inline FieldEffects installed(const PadLayout& pad, const std::vector<Wanted>& wanted, bool flat_surface = true,
                              std::uint64_t seed = 7, std::uint64_t trial = 0) {
  FieldEffects effects;
  const EffectContext context = context_for(pad, flat_surface, seed, trial);
  for (const Wanted& effect : wanted) {
    const EffectKind& kind = kind_named(effect.name);
    Parameters parameters = defaults_of(kind.about.parameters);
    for (const auto& [key, value] : effect.changes) parameters.set(key, value);
    kind.install(parameters, context, effects);
  }
  return effects;
}

inline Field field_with(const PadLayout& pad, Friction friction, const std::vector<Wanted>& wanted, std::uint64_t seed = 7,
                        std::uint64_t trial = 0) {
  return Field(pad, Plane{}, friction, installed(pad, wanted, true, seed, trial));
}

inline Pose at(double x, double y, double z) {
  Pose pose;
  pose.position = {x, y, z};
  return pose;
}

// One unit of `bristles` equal elements at the origin, with total stiffnesses k_n and k_t.
inline PadLayout one_unit(double k_n, double k_t, std::size_t bristles = 1) {
  PadLayout pad;
  Element element{.k_normal = k_n / static_cast<double>(bristles), .k_tangential = k_t / static_cast<double>(bristles)};
  pad.elements.assign(bristles, element);
  pad.units = {{0, bristles}};
  return pad;
}

// Expects that an effect whose parameters give its law no influence changes nothing: a field with it
// has the states and forces of one without, under the same random motion.
inline void expect_no_influence(const Wanted& effect) {
  RandomStream draw(3, 0, "idle effects");
  const PadLayout pad = testing_field::random_pad(draw, 40, false);
  const testing_field::RandomMotion motion(draw, Pose{});
  Field plain(pad, Plane{}, {0.6, 0.5}), with = field_with(pad, {0.6, 0.5}, {effect});
  for (int tick = 0; tick < 300; ++tick) {
    plain.step(motion.at(tick * 1e-3), 1e-3);
    with.step(motion.at(tick * 1e-3), 1e-3);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      ASSERT_EQ(plain.state(i), with.state(i)) << effect.name << ", tick " << tick;
      ASSERT_NEAR((plain.tangential_force(i) - with.tangential_force(i)).norm(), 0.0, 1e-10) << effect.name << ", tick " << tick;
      ASSERT_NEAR(plain.normal_force(i), with.normal_force(i), 1e-12) << effect.name;
    }
  }
}

}  // namespace slipbench::testing_effects

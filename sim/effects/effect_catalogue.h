// The effects that a scene may name, one line each in effect_catalogue.cc.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sim/core/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/core/random.h"
#include "sim/field/effect.h"
#include "sim/field/surface/surface.h"

namespace slipbench {

// What an effect may know about the field it joins.
struct EffectContext {
  const PadLayout* layout = nullptr;  // of the field
  std::size_t elements = 0;           // of it
  std::vector<double> share;          // [elements] share of its unit's stiffness that an element stands for: 1/bristles
  std::vector<double> k_normal;       // [elements] N/m
  std::vector<double> k_tangential;   // [elements] N/m
  bool flat_surface = true;           // plane or box: texture and patches need flat coordinates
  bool plane = true;                  // a flat surface without edges
  bool dashpots = false;              // whether an element has one beside its springs
  std::uint64_t seed = 0, trial = 0;  // key of the random streams

  // The stream of random numbers that belongs to the effect `name`: no other effect draws from it.
  [[nodiscard]] RandomStream stream(std::string_view name) const { return {seed, trial, "effect." + std::string(name)}; }
};

// An effect: what `describe` prints and how it joins a field.
struct EffectKind {
  Entry about;
  // Throws SceneValueError when it does not fit the field.
  void (*install)(const Parameters& parameters, const EffectContext& context, FieldEffects& effects);
  bool after_tip = false;  // is installed after the effect that moves the tips, wherever the scene names it
};

const std::vector<EffectKind>& effect_catalogue();

// The longest step [s] that sees every wave of `wavelength` [m] 16 times when it passes at `speed` [m/s].
inline double step_per_wave(double wavelength, double speed) {
  constexpr double samples_per_wave = 16.0;
  return speed > 0.0 ? wavelength / (samples_per_wave * speed) : std::numeric_limits<double>::infinity();
}

EffectKind ageing();
EffectKind anisotropic_friction();
EffectKind asperities();
EffectKind elastic_skin();
EffectKind inertia();
EffectKind lean();
EffectKind load_dependent_friction();
EffectKind patchy_friction();
EffectKind roughness();
EffectKind stribeck();
EffectKind texture();
EffectKind viscoelastic();
EffectKind viscous_friction();

// From the effects that a scene names to those of a field.

// The effects that a scene names, installed in its order on a field of `layout` against `surface`; `seed` and `trial` key their random
// streams. Throws SceneValueError when one does not fit the field. Every name must be in the catalogue, with all its parameters.
FieldEffects install_effects(const std::vector<Named>& effects, const PadLayout& layout, const Surface& surface,
                             std::uint64_t seed, std::uint64_t trial);

// The longest step [s] that all of them resolve when pad and surface move at up to `speed` [m/s].
double longest_step(const FieldEffects& effects, double speed);

}  // namespace slipbench

// The effects that a scene may name, one line per effect in effect_catalogue.cc.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sim/api/effect.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/parameters.h"
#include "sim/core/random.h"

namespace slipbench {

// Properties of the field to which an effect is added.
struct EffectContext {
  const PadLayout* layout = nullptr;  // of the field
  std::size_t elements = 0;           // of the field
  // [elements] element's share of its unit's stiffness: 1/bristles
  std::vector<double> share;
  std::vector<double> k_normal;       // [elements] N/m
  std::vector<double> k_tangential;   // [elements] N/m
  bool flat_surface = true;           // plane or box: texture and patches need flat coordinates
  bool plane = true;                  // a flat surface without edges
  bool dashpots = false;              // true if an element has a dashpot
  std::uint64_t seed = 0, trial = 0;  // key of the random streams

  // Returns the random stream of the effect `name`; no other effect draws from it.
  [[nodiscard]] RandomStream stream(std::string_view name) const { return {seed, trial, "effect." + std::string(name)}; }
};

// Changes by an effect of the labels of a field, compared with springs and Coulomb friction of the
// scene (sim/contact/field.h). tools/verify derives from it which laws the labels obey.
enum class Change : std::uint8_t {
  static_friction,        // mu_s, or the shape of the cone; `margin` includes it
  kinetic_friction,       // mu_k, or the shape of the cone; slipping units keep margin >= 0
  less_kinetic_friction,  // only less than the scene's mu_k
  more_kinetic_friction,  // only more than the scene's mu_k, also more than mu_s
  tip_force,              // slipping, partly slipping and detached units: the tangential force is not the friction
  stick_force,            // sticking units: likewise
  normal_force,           // f_n is not k_n times the depth of the undeformed tip in the surface's shape
};

// A wave of an effect's surface, by the names of the effect's parameters.
struct WaveParameters {
  const char* length;     // length of the wave
  const char* amplitude;  // 0: there is no such wave
  const char* angle;      // direction across the crests, from the surface's X axis
};

struct ElasticBody;  // sim/effects/skin/influence.h

// An effect: its entry in the catalogue, the function that adds it to a field, and what other
// folders must know of it. The defaults are right for an effect without the property.
struct EffectKind {
  Entry about;
  std::vector<Change> changes;
  // Adds the effect to `effects`. Throws SceneValueError if it does not fit the field.
  void (*install)(const Parameters& parameters, const EffectContext& context, FieldEffects& effects);
  // True: installed after the effect that moves the tips, whatever the scene's order.
  bool after_tip = false;
  // Third-party libraries that compute it, such as "FFTW": its results may differ between processors.
  std::vector<std::string> libraries = {};
  // Parameter that is the tolerance of an iterative solver, which `cost` varies; null: none.
  const char* tolerance = nullptr;
  // Waves that the points of a unit must resolve.
  std::vector<WaveParameters> waves = {};
  // Returns the body that replaces the elements' springs; null: the springs remain. Such an effect
  // needs the explicit solver. `parameters`: of the effect.
  ElasticBody (*body)(const Parameters& parameters) = nullptr;
};

const std::vector<EffectKind>& effect_catalogue();

// Returns the longest step [s] that samples every wave of `wavelength` [m] 16 times when it passes
// at `speed` [m/s].
inline double step_per_wave(double wavelength, double speed) {
  constexpr double samples_per_wave = 16.0;
  return speed > 0.0 ? wavelength / (samples_per_wave * speed) : std::numeric_limits<double>::infinity();
}

EffectKind ageing();
EffectKind anisotropic_friction();
EffectKind asperities();
EffectKind elastic_skin();
EffectKind inertia();
EffectKind load_dependent_friction();
EffectKind patchy_friction();
EffectKind roughness();
EffectKind stribeck();
EffectKind texture();
EffectKind viscoelastic();
EffectKind viscous_friction();

}  // namespace slipbench

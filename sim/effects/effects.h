// Every effect's declaration; each is defined in the file of its name.
#pragma once

#include <limits>

#include "sim/effects/effect_catalogue.h"

namespace slipbench {

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

}  // namespace slipbench

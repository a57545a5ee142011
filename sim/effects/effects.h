// Every effect's declaration; each is defined in the file of its name.
#pragma once

#include "sim/effects/catalogue.h"

namespace slipbench {

EffectKind ageing();
EffectKind anisotropic_friction();
EffectKind load_dependent_friction();
EffectKind patchy_friction();
EffectKind stribeck();
EffectKind texture();
EffectKind viscoelastic();

}  // namespace slipbench

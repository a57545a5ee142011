// The dashpots that elements may have in parallel with their springs.
#pragma once

#include <memory>

#include "sim/core/pad_layout.h"
#include "sim/field/effect.h"

namespace slipbench {

// Kelvin-Voigt element: f = k u + c du/dt with the rate taken over the step (backward Euler, first order, never unstable). Normal: u is
// the penetration; tangential: the stretch, and the whole force f obeys the friction cone. Null when no element has a dashpot.
std::unique_ptr<RheologyEffect> make_dashpots(const PadLayout& layout);

}  // namespace slipbench

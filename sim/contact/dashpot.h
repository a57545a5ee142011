// Dashpots in parallel with the springs of a pad.
#pragma once

#include <memory>

#include "sim/api/effect.h"
#include "sim/api/pad_layout.h"

namespace slipbench {

// Makes the dashpots in parallel with the springs; returns null if no element has one. Kelvin-Voigt
// element: f = k u + c du/dt with the rate taken over the step (backward Euler, first order,
// unconditionally stable). Normal: u is the penetration. Tangential: u is the stretch, and the
// whole force f obeys the friction cone.
std::unique_ptr<RheologyEffect> make_dashpots(const PadLayout& layout);

}  // namespace slipbench

// The friction cones of effects that replace the circular cone.
#pragma once

#include <cstddef>

#include "sim/api/effect.h"
#include "sim/contact/kernel.h"
#include "sim/contact/return_mapping.h"

namespace slipbench {

// Projects the trial of element i, which touches, onto `cone`. `rate`: null, or a rate law in a
// step of `dt` > 0 [s].
[[nodiscard]] kernel::Projected project_onto_cone(const ConeEffect& cone, RateEffect* rate, double dt,
                                                  const kernel::Columns& columns, std::size_t i, const kernel::Trial& trial);

}  // namespace slipbench

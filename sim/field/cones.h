// The return mapping of elements of which the kernel cannot work on several at once: onto an effect's cone, and of slender columns.
#pragma once

#include <cstddef>

#include "sim/field/effect.h"
#include "sim/field/return_mapping.h"

namespace slipbench {

// What `cone` makes of the trial of element i, which touches. `rate`: null, or a rate law in a step of `dt` > 0 [s].
[[nodiscard]] kernel::Mapped map_onto(const ConeEffect& cone, RateEffect* rate, double dt, const kernel::Columns& columns,
                                      std::size_t i, const kernel::Trial& trial);

// What Coulomb's cone makes of it where elements are columns (effect.h's Lean); the trial is that of an upright one. Also writes the columns trial
// and slide. Throws InputError where the column is loaded beyond what its stop holds.
[[nodiscard]] kernel::Mapped map_onto(const Lean& lean, const RateEffect* rate, double dt, const kernel::Columns& columns,
                                      std::size_t i, const kernel::Trial& trial);

}  // namespace slipbench

// Declarations of parameters that several detectors have.
#pragma once

#include "sim/core/parameter_specs.h"

namespace slipbench {

// Above 0, at most 1.
inline constexpr Range share_range{.min = 0.0, .max = 1.0, .open_min = true};

ParameterSpec touch_spec();           // "touch" [N]
ParameterSpec least_friction_spec();  // "least_friction"

}  // namespace slipbench

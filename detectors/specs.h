// Declarations of parameters that several detectors have.
#pragma once

#include <string>

#include "sim/core/parameters.h"

namespace slipbench {

// Above 0, at most 1.
inline constexpr Range share_range{.min = 0.0, .max = 1.0, .open_min = true};

// The declaration of a number, in short.
ParameterSpec number_spec(std::string name, Quantity quantity, std::string default_text, Range range, std::string doc,
                          std::string source);

ParameterSpec touch_spec();           // "touch" [N]
ParameterSpec least_friction_spec();  // "least_friction"

}  // namespace slipbench

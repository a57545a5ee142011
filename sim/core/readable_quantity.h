// Text of quantities for messages and summaries.
#pragma once

#include <string>

#include "sim/core/quantity.h"

namespace slipbench {

// Writes an SI value with at most four significant digits: lengths from 0.01 mm to 1 m in mm, other
// values in the unit that format_quantity() chooses. The text may not read back as the same double.
std::string readable_quantity(double value, Quantity quantity);

}  // namespace slipbench

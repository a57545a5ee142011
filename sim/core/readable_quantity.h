// Text of quantities for messages and summaries.
#pragma once

#include <string>
#include <string_view>

#include "sim/core/quantity.h"

namespace slipbench {

// Writes an SI value with at most four significant digits: lengths from 0.01 mm to 1 m in mm, other
// values in the unit that format_quantity() chooses. The text may not read back as the same double.
std::string readable_quantity(double value, Quantity quantity);

// The ends of a range.
enum class Bound { lower, upper };

// Writes a bound in SI in the unit of `like`, the first unit in a text such as "5 mm" or "[0 deg, 0
// deg]". A bound with more than six significant digits in this unit is rounded to four, into the
// range, so that the printed value is allowed. Without a unit in `like` the text is that of
// format_quantity().
std::string bound_in_unit_of(std::string_view like, double bound, Quantity quantity, Bound side);

}  // namespace slipbench

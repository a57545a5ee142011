#include "sim/core/readable_quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "sim/core/math.h"

namespace slipbench {
namespace {

// Returns the number with at most this many significant digits.
std::string rounded(double number, int digits = 4) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::general, digits).ptr;
  return {buffer.data(), end};
}

// Returns the first unit of `quantity` that follows a number in the text; null without one.
const Unit* unit_in(std::string_view text, Quantity quantity) {
  const std::size_t first = text.find_first_not_of("[ ");
  if (first == std::string_view::npos) return nullptr;
  text.remove_prefix(first);
  text = text.substr(0, text.find_first_of(",]"));
  for (const Unit& unit : units_of(quantity)) {
    if (unit.symbol.empty() || !text.ends_with(unit.symbol)) continue;
    // "mm" also ends with "m".
    const std::string_view number = text.substr(0, text.size() - unit.symbol.size());
    if (number.ends_with(' ') || number.ends_with('.') || (!number.empty() && number.back() >= '0' && number.back() <= '9'))
      return &unit;
  }
  return nullptr;
}

}  // namespace

std::string readable_quantity(double value, Quantity quantity) {
  if (!std::isfinite(value)) return format_number(value);
  const double size = std::abs(value);
  if (quantity == Quantity::length && size >= 1e-5 && size < 1.0) return rounded(1e3 * value) + " mm";
  const std::string exact = format_quantity(value, quantity);
  const std::size_t space = std::min(exact.find(' '), exact.size());
  double number = 0.0;
  std::from_chars(exact.data(), exact.data() + space, number);
  return rounded(number) + exact.substr(space);
}

std::string bound_in_unit_of(std::string_view like, double bound, Quantity quantity, Bound side) {
  const Unit* const unit = unit_in(like, quantity);
  if (unit == nullptr || !std::isfinite(bound)) return format_quantity(bound, quantity);
  const std::string suffix = ' ' + std::string(unit->symbol);
  const double scaled = bound / unit->factor;
  if (const std::string text = rounded(scaled, 6) + suffix; parse_quantity(text, quantity) == bound) return text;
  std::string text = rounded(scaled) + suffix;
  const double read = parse_quantity(text, quantity);
  if (side == Bound::lower ? read >= bound : read <= bound) return text;
  const double step = math::pow(10.0, std::floor(math::log10(std::abs(scaled))) - 3.0);
  return rounded(scaled + (side == Bound::lower ? step : -step)) + suffix;
}

}  // namespace slipbench

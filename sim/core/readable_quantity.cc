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

// The number at the beginning of a text.
double number_in(std::string_view text) {
  double number = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

// "27.261 ms" -> "27.26 ms"
std::string with_rounded_number(const std::string& text) {
  return rounded(number_in(text)) + text.substr(std::min(text.find(' '), text.size()));
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
  if (const std::string text = with_rounded_number(exact); text.find("e+") == std::string::npos) return text;
  // In the unit in which the exact number is shortest, four digits need an exponent: 27261 us, not
  // 27.26 ms.
  return format_quantity(number_in(rounded(value)), quantity);
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

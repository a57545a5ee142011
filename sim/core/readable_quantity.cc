#include "sim/core/readable_quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>

namespace slipbench {
namespace {

// Returns the number with at most four significant digits.
std::string rounded(double number) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::general, 4).ptr;
  return {buffer.data(), end};
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

}  // namespace slipbench

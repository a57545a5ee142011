#include "sim/core/math/decade.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <system_error>

#include "sim/core/math.h"

namespace slipbench {

double power_of_ten(int exponent) {
  double power = 1.0;                                             // an integer, exact up to 10^22
  const int factors = std::abs(std::clamp(exponent, -400, 400));  // beyond the range of a double
  for (int k = 0; k < factors; ++k) power *= 10.0;
  return exponent < 0 ? 1.0 / power : power;
}

int decade_of(double x) {
  auto exponent = static_cast<int>(std::floor(math::log10(x)));
  while (power_of_ten(exponent) > x) --exponent;
  while (power_of_ten(exponent + 1) <= x) ++exponent;
  return exponent;
}

double rounded_to_digits(double x, int digits) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::scientific, digits - 1).ptr;
  double rounded = 0.0;
  // Rounding up may leave the range of a double.
  return std::from_chars(text.data(), end, rounded).ec == std::errc{} ? rounded : x;
}

}  // namespace slipbench

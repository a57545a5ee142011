#include "sim/core/math/decade.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

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

}  // namespace slipbench

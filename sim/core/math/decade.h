// Powers of ten and the decade of a number, without the rounding of logarithms.
#pragma once

namespace slipbench {

// 10^exponent, correctly rounded for |exponent| <= 22.
double power_of_ten(int exponent);

// Returns the exponent for which 10^exponent <= x < 10^(exponent + 1). `x` must be finite and above
// 1e-300.
int decade_of(double x);

}  // namespace slipbench

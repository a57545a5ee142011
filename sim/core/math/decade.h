// Powers of ten, the decade of a number without the rounding of logarithms, and decimal rounding.
#pragma once

namespace slipbench {

// 10^exponent, correctly rounded for |exponent| <= 22.
double power_of_ten(int exponent);

// Returns the exponent for which 10^exponent <= x < 10^(exponent + 1). `x` must be finite and above
// 1e-300.
int decade_of(double x);

// Returns `x` rounded to `digits` significant decimal digits, whatever the locale.
double rounded_to_digits(double x, int digits);

}  // namespace slipbench

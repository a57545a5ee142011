// Bessel functions of the first kind.
#pragma once

namespace slipbench {

struct Bessel {
  double j0, j2;  // of order 0 and 2
};

// Both of x >= 0, with an absolute error below 1e-14. Sources: Abramowitz and Stegun, Handbook of
// Mathematical Functions, 9.1.18 (Bessel's integral) and 9.2.5 (Hankel's expansion).
Bessel bessel(double x);

}  // namespace slipbench

// Bessel functions of the first kind.
#pragma once

namespace slipbench {

struct Bessel {
  double j0, j2;  // of orders 0 and 2
};

// Returns J_0(x) and J_2(x) for x >= 0, with an absolute error below 1e-14. Sources: Abramowitz and
// Stegun, Handbook of Mathematical Functions, 9.1.18 (Bessel's integral) and 9.2.5 (Hankel's
// expansion).
Bessel bessel(double x);

}  // namespace slipbench

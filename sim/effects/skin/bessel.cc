#include "sim/effects/skin/bessel.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sim/core/math.h"

namespace slipbench {
namespace {

// J_n(x) = 1/pi Int_0^pi cos(x sin a) cos(n a) da for even n by the trapezoidal rule, whose error
// for N intervals is near J_(2N - n)(x): below 1e-16 for x < 25 and N = 32. Both halves of the
// interval are equal.
class Integral {
 public:
  Integral() {
    for (std::size_t k = 0; k < nodes; ++k) {
      const double angle = std::numbers::pi * static_cast<double>(k + 1) / intervals;
      const double weight = k + 1 == nodes ? 1.0 : 2.0;  // the middle is its own mirror image
      sine_[k / quad][k % quad] = math::sin(angle);
      weight_[k / quad][k % quad] = weight / intervals;
      weight2_[k / quad][k % quad] = weight / intervals * math::cos(2.0 * angle);
    }
  }

  [[nodiscard]] Bessel at(double x) const {
    Quad j0{1.0 / intervals}, j2 = j0;  // at the angle 0
    for (std::size_t k = 0; k < sine_.size(); ++k) {
      const Quad cosine = math::sincos(x * sine_[k]).cos;
      j0 += weight_[k] * cosine;
      j2 += weight2_[k] * cosine;
    }
    return {j0[0] + j0[1] + j0[2] + j0[3], j2[0] + j2[1] + j2[2] + j2[3]};
  }

 private:
  static constexpr double intervals = 32.0;
  static constexpr std::size_t nodes = 16;

  std::array<Quad, nodes / quad> sine_, weight_, weight2_;
};

// P and Q of Hankel's expansion, for x >= 25, where its terms fall below rounding error.
struct Expansion {
  Expansion(double order, double x) {
    double term = 1.0;
    for (int k = 0; k < 24; ++k) {
      (k % 2 == 0 ? p : q) += k / 2 % 2 == 0 ? term : -term;
      const double odd = 2.0 * k + 1.0;
      term *= (4.0 * order * order - odd * odd) / (8.0 * (k + 1) * x);
    }
  }

  double p = 0.0, q = 0.0;
};

}  // namespace

Bessel bessel(double x) {
  if (x < 25.0) {
    static const Integral integral;
    return integral.at(x);
  }
  const auto [sine, cosine] = math::sincos(x);
  // cos(x - pi/4) = (cos x + sin x)/sqrt(2)
  const double scale = 1.0 / std::sqrt(std::numbers::pi * x);
  const Expansion of_0(0.0, x), of_2(2.0, x);
  return {scale * (of_0.p * (cosine + sine) - of_0.q * (sine - cosine)),
          -scale * (of_2.p * (cosine + sine) - of_2.q * (sine - cosine))};
}

}  // namespace slipbench

// The analogue path of a sensor that hears changes: a band-pass.
#pragma once

#include <cmath>
#include <numbers>
#include <span>

#include "sim/core/math.h"

namespace slipbench {

// A first-order high-pass y' = x' - w_1 y, then a first-order low-pass z' = w_2 (y - z). Between two samples x goes straight; each filter is then
// moved exactly, so that its response at the samples does not depend on their rate but for what is lost of x in between:
//   y_k+1 = E y_k + (1 - E)/a (x_k+1 - x_k),           a = w_1 h, E = exp(-a)
//   z_k+1 = E z_k + ((1 - E)/a - E) y_k + (1 - (1 - E)/a) y_k+1   with w_2 (which takes y as straight).
// Well below w_1 the output is x'/w_1: it follows the rate of x.
class BandPass {
 public:
  static constexpr std::size_t memory_size = 4;

  // `corner` [Hz] of the high-pass, > 0; `anti_alias` [Hz] of the low-pass, > 0, infinite: none. `rate` [Hz] of the samples. `memory`: where the
  // filter keeps its state, all zero at the beginning; it must outlive the band-pass.
  BandPass(double corner, double anti_alias, double rate, std::span<double, memory_size> memory)
      : high_(2.0 * std::numbers::pi * corner / rate), low_(2.0 * std::numbers::pi * anti_alias / rate), memory_(memory) {}

  // The output for the next sample x. The first one finds the filter settled: its output is 0.
  double next(double x) {
    double &last = memory_[0], &y = memory_[1], &z = memory_[2], &begun = memory_[3];
    if (begun == 0.0) {
      begun = 1.0;
      last = x;
      return 0.0;
    }
    const double before = y;
    y = high_.keeps * y + high_.mean * (x - last);
    last = x;
    z = low_.keeps * z + (low_.mean - low_.keeps) * before + (1.0 - low_.mean) * y;
    return z;
  }

 private:
  struct Pole {
    // `a`: its angular frequency times the time between two samples.
    explicit Pole(double a) : keeps(math::exp(-a)), mean(std::isinf(a) ? 0.0 : -math::expm1(-a) / a) {}
    double keeps;  // E
    double mean;   // (1 - E)/a, of exp(-w t) over a step
  };

  Pole high_, low_;
  std::span<double, memory_size> memory_;
};

}  // namespace slipbench

// Band-pass: the analogue path of a sensor that responds to changes.
#pragma once

#include <cmath>
#include <numbers>
#include <span>

#include "sim/core/math.h"

namespace slipbench {

// A first-order high-pass y' = x' - w_1 y, then a first-order low-pass z' = w_2 (y - z). x is taken
// as linear between samples, and each filter is advanced exactly, so that the response at the
// samples depends on their rate only through changes of x between samples:
//   y_k+1 = E y_k + (1 - E)/a (x_k+1 - x_k),           a = w_1 h, E = exp(-a)
//   z_k+1 = E z_k + ((1 - E)/a - E) y_k + (1 - (1 - E)/a) y_k+1   with w_2 (y taken as linear).
// Well below w_1 the output is x'/w_1, proportional to the rate of change of x.
class BandPass {
 public:
  static constexpr std::size_t memory_size = 4;

  // `corner` [Hz] of the high-pass, > 0; `anti_alias` [Hz] of the low-pass, > 0, infinite: no
  // low-pass; `rate` [Hz] of the samples. `memory` holds the filter's state, all zero at the
  // beginning, and must outlive the band-pass.
  BandPass(double corner, double anti_alias, double rate, std::span<double, memory_size> memory)
      : high_(2.0 * std::numbers::pi * corner / rate), low_(2.0 * std::numbers::pi * anti_alias / rate), memory_(memory) {}

  // Returns the output for the next sample x. The filter is settled at the first sample: its output
  // is 0.
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
    // `a`: angular frequency times the time between two samples.
    explicit Pole(double a) : keeps(math::exp(-a)), mean(std::isinf(a) ? 0.0 : -math::expm1(-a) / a) {}
    double keeps;  // E
    double mean;   // (1 - E)/a, mean of exp(-w t) over a step
  };

  Pole high_, low_;
  std::span<double, memory_size> memory_;
};

}  // namespace slipbench

// A damped linear oscillator, moved exactly by any time.
#pragma once

#include <cmath>

namespace slipbench {

// x'' + 2 zeta omega x' + omega^2 x = 0, omega [rad/s] > 0, zeta >= 0.
struct Oscillator {
  double omega, zeta;

  [[nodiscard]] double acceleration(double x, double speed) const { return -omega * omega * x - 2.0 * zeta * omega * speed; }
};

// (x, x') -> (xx x + xv x', vx x + vv x'): the matrix exponential.
struct Propagator {
  double xx = 1.0, xv = 0.0, vx = 0.0, vv = 1.0;

  [[nodiscard]] double position(double x, double speed) const { return xx * x + xv * speed; }
  [[nodiscard]] double speed(double x, double speed) const { return vx * x + vv * speed; }
};

// Over `time` [s] >= 0. With s = zeta omega and C, S = exp(-s t) (cos, sin/w)(w t), w^2 = omega^2 - s^2 (above critical damping cosh and
// sinh): x(t) = (C + s S) x + S x', x'(t) = -omega^2 S x + (C - s S) x'.
inline Propagator propagator(const Oscillator& oscillator, double time) {
  const double omega = oscillator.omega, decay = oscillator.zeta * omega;
  const double w2 = (omega - decay) * (omega + decay), turn2 = w2 * time * time;
  double even = 0.0, odd = 0.0;
  if (std::abs(turn2) < 1e-8) {  // next to critical damping, or a short time: the series, good to turn2^2/24
    const double fade = std::exp(-decay * time);
    even = fade * (1.0 - 0.5 * turn2);
    odd = fade * time * (1.0 - turn2 / 6.0);
  } else if (w2 > 0.0) {
    const double w = std::sqrt(w2), fade = std::exp(-decay * time);
    even = fade * std::cos(w * time);
    odd = fade * std::sin(w * time) / w;
  } else {
    const double s = std::sqrt(-w2);
    const double slow = std::exp(-(decay - s) * time), fast = std::exp(-(decay + s) * time);
    even = 0.5 * (slow + fast);
    odd = 0.5 * (slow - fast) / s;
  }
  return {even + decay * odd, odd, -omega * omega * odd, even - decay * odd};
}

}  // namespace slipbench

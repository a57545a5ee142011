// One tip with mass, carried by a spring and a dashpot, on a plane with Coulomb friction.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/api/effect.h"
#include "sim/core/math.h"

namespace slipbench {

// A damped linear oscillator, integrated exactly over any time.

// x'' + 2 zeta omega x' + omega^2 x = 0, omega [rad/s] > 0, zeta >= 0.
struct Oscillator {
  double omega, zeta;

  [[nodiscard]] double acceleration(double x, double speed) const { return -omega * omega * x - 2.0 * zeta * omega * speed; }
};

// Matrix exponential: (x, x') -> (xx x + xv x', vx x + vv x').
struct Propagator {
  double xx = 1.0, xv = 0.0, vx = 0.0, vv = 1.0;

  [[nodiscard]] double position(double x, double speed) const { return xx * x + xv * speed; }
  [[nodiscard]] double speed(double x, double speed) const { return vx * x + vv * speed; }
};

// Returns the propagator over `time` [s] >= 0. With s = zeta omega and C, S = exp(-s t) (cos,
// sin/w)(w t), w^2 = omega^2 - s^2 (above critical damping cosh and sinh): x(t) = (C + s S) x + S
// x', x'(t) = -omega^2 S x + (C - s S) x'.
inline Propagator propagator(const Oscillator& oscillator, double time) {
  const double omega = oscillator.omega, decay = oscillator.zeta * omega;
  const double w2 = (omega - decay) * (omega + decay), turn2 = w2 * time * time;
  double even = 0.0, odd = 0.0;
  // Near critical damping, or a short time: the series, with an error of turn2^2/24.
  if (std::abs(turn2) < 1e-8) {
    const double fade = math::exp(-decay * time);
    even = fade * (1.0 - 0.5 * turn2);
    odd = fade * time * (1.0 - turn2 / 6.0);
  } else if (w2 > 0.0) {
    const double w = std::sqrt(w2), fade = math::exp(-decay * time);
    const auto [sine, cosine] = math::sincos(w * time);
    even = fade * cosine;
    odd = fade * sine / w;
  } else {
    const double s = std::sqrt(-w2);
    const double slow = math::exp(-(decay - s) * time), fast = math::exp(-(decay + s) * time);
    even = 0.5 * (slow + fast);
    odd = 0.5 * (slow - fast) / s;
  }
  return {even + decay * odd, odd, -omega * omega * odd, even - decay * odd};
}

// m a'' = k u + c u' - F in the tangent plane. a: position of the tip, u = r - a: stretch of the
// element whose root is at r [m], k = m omega^2, c = 2 zeta m omega.
struct TipLaw {
  double k;  // N/m
  Oscillator oscillator;

  // N s/m
  [[nodiscard]] double dashpot() const { return 2.0 * oscillator.zeta * k / oscillator.omega; }
};

// Input of a step: the root moves from `root` at `speed`; normal force and stick limit change
// linearly.
struct TipDrive {
  Eigen::Vector2d root, speed;  // m, m/s
  double dt;                    // s, > 0
  double f_normal[2];           // raw normal force [N] at start and end; negative while separated
  double limit[2];              // mu_s f_n [N]
  double mu_kinetic;
  double longest;  // longest share of the step with a constant direction of friction

  [[nodiscard]] Eigen::Vector2d root_at(double fraction) const { return root + (fraction * dt) * speed; }
};

struct Tip {
  Eigen::Vector2d place, speed;  // m, m/s, over the surface
  ElementState state;
};

// Result of a step.
struct TipTrace {
  Eigen::Vector2d slip{0.0, 0.0};      // m, displacement of the touching tip over the surface
  double path = 0.0;                   // m, its length
  Eigen::Vector2d friction{0.0, 0.0};  // N, of the tip on the surface, at the end
};

// Moves the tip through the step and appends the changes of its state as those of `element`, in
// order of time.
//
// Stick: the tip stands, F = k u + c r'. It starts to slip where |F| exceeds mu_s f_n; for a root
// at constant speed under a linear limit this is the root of a quadratic.
//
// Slip: F = mu_k f_n (mean over the piece) along the direction of slip at the piece's start, so
// that u - F/k is a free oscillator, integrated exactly. A piece ends, at a root found to rounding,
// where the tip has no speed left along that direction, so that friction never drives it. The
// remaining speed across that direction comes from the rotation of the direction within the piece.
// It is set to zero if friction could stop it within a piece; otherwise the tip slips on along it.
// A tip that stands sticks if mu_s f_n holds it; otherwise it slips on along the force.
void move_tip(const TipLaw& law, const TipDrive& drive, std::uint32_t element, Tip& tip, TipTrace& trace,
              std::vector<ElementEvent>& events);

}  // namespace slipbench

// One tip with mass, carried by a spring and a dashpot, on a plane with Coulomb friction.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/effects/oscillator.h"
#include "sim/field/effect.h"

namespace slipbench {

// m a'' = k u + c u' - F in the tangent plane, a: place of the tip, u = r - a: stretch of the element whose root is at r [m],
// k = m omega^2, c = 2 zeta m omega.
struct TipLaw {
  double k;  // N/m
  Oscillator oscillator;

  [[nodiscard]] double dashpot() const { return 2.0 * oscillator.zeta * k / oscillator.omega; }  // N s/m
};

// What a step does to the tip: the root moves from `root` at `speed`, normal force and stick limit change linearly.
struct TipDrive {
  Eigen::Vector2d root, speed;  // m, m/s
  double dt;                    // s, > 0
  double f_normal[2];           // raw normal force [N] at the start and at the end; negative while apart
  double limit[2];              // mu_s f_n [N]
  double mu_kinetic;
  double longest;  // share of the step for which the direction of friction is kept at the most

  [[nodiscard]] Eigen::Vector2d root_at(double fraction) const { return root + (fraction * dt) * speed; }
};

struct Tip {
  Eigen::Vector2d place, speed;  // m, m/s, over the surface
  ElementState state;
};

// What the step did.
struct TipTrace {
  Eigen::Vector2d slip{0.0, 0.0};      // m, way of the touching tip over the surface
  double path = 0.0;                   // m, its length
  Eigen::Vector2d friction{0.0, 0.0};  // N, of the tip on the surface, at the end
};

// Moves the tip through the step, and appends the changes of its state as those of `element`, in order of time.
//
// Stick: the tip stands, F = k u + c r'. It lets go where |F| leaves mu_s f_n, which a root at constant speed under a linear limit
// does where a quadratic has its root. Slip: F = mu_k f_n (its mean over the piece) along the direction in which the tip slipped at the
// piece's start, so that the rest u - F/k is a free oscillator, moved exactly. A piece ends, at a root found to rounding, where the tip
// has no speed left along that direction, so that friction never drives it. What speed it then has across it is what its direction has
// turned by: one that friction would take within a piece is taken; another slips on along what is left. The tip that stands then sticks
// if mu_s f_n holds it, and slips on along the force if not.
void move_tip(const TipLaw& law, const TipDrive& drive, std::uint32_t element, Tip& tip, TipTrace& trace,
              std::vector<ElementEvent>& events);

}  // namespace slipbench

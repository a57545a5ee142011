// The force of an element that is a slender column, and how far its tip slides.
#pragma once

#include <Eigen/Core>

#include "sim/field/effect.h"

namespace slipbench {

// One element in one step, in the surface frame. Springs and rheology give k u + `history` tangentially and k_normal depth + history_normal
// along the normal of an upright column.
struct LeaningElement {
  Eigen::Vector3d stretch, history;           // m, N: tangential, of the trial
  double k, k_normal, depth, history_normal;  // N/m, N/m, m, N
  double mu_slide;                            // before a rate law
};

struct LeaningForce {
  double normal;               // N, >= 0
  Eigen::Vector3d tangential;  // N, of the pad on the surface
};

// Force at the stretch u [m], by effect.h's Lean.
[[nodiscard]] LeaningForce leaning_force(const Lean& lean, const LeaningElement& element, const Eigen::Vector3d& u);

// The slip s >= 0 [m] of the tip along the unit vector e of its trial force, which is beyond mu_slide f_n: the first root of
//   e.f_t(u - s e) = mu_slide f_n(u - s e) g(s/dt),
// g = 1 without a `rate` law. Where the column's stiffness is negative the tip slides outwards, up to the stop: a tip without mass snaps there
// within the step. `guess`: a slip near the root [m].
[[nodiscard]] double leaning_slip(const Lean& lean, const LeaningElement& element, const Eigen::Vector3d& e, double guess,
                                  double dt, const RateEffect* rate);

}  // namespace slipbench

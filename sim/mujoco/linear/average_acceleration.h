// The springs of a grasp taken implicitly: `field_solver: implicit` in a scene with a gripper.
//
// Newmark's average acceleration ([newmark1959]; beta 1/4, gamma 1/2), linearised about the springs
// at the start of the step, in the form of MuJoCo's steps, the velocity first and the position with
// the new velocity:
//   S a = F(x, v),   S = M + (h/2) C + (h^2/4) K,   v' = v + h a,   x' = x + h v'
// F is that of an explicit step, from fields whose tips stick, slip and touch as they do at x. So
// statics, thresholds and labels are those of the explicit step, and K and C act as an inertia that
// slows down fast modes: an error in them changes no force. With h v = x - x_before a linear model
// obeys
//   M (x' - 2 x + x_before)/h^2 + C (x' - x_before)/(2 h) + K (x' + 2 x + x_before)/4 = f
// which is stable at any step, of second order, and without numerical damping: a mode of omega
// vibrates at Omega with
//   tan(Omega h/2) = omega h/2.
//
// A stable step need not be accurate. A step is accurate with
//   h omega <= 2,  and for a mode damped at c > 2 omega, above the critical damping,
//   h (c + sqrt(c^2 - 4 omega^2))/2 <= 2
// so that no mode turns by more than a quarter of its period per step, and no purely decaying mode
// changes its sign. Beyond it the ringing after a touch exceeds the cones of lightly pressed tips,
// and labels report slips that did not occur (tests/sim/mujoco/bodies/grasp_solver_test.cc).
//
// Two fingers and the held body are three free bodies. Each finger is connected only to its spring
// and its pad, so it is eliminated first. With G the pad's contribution to the inertia, all 6x6
// about the held body's frame and along its axes:
//   (P + G) a_f - G a = f_f + (h^2/4) K a_c,   (X + sum G) a - sum G a_f = f
// P is the finger's mass plus its spring's contribution. That spring hangs on a carriage with the
// acceleration a_c: K acts on the finger's displacement relative to it. C needs no such term: (h/2)
// C a_f brings the finger's velocity from the middle of the last step, where it is known, to the
// tick, where the carriage's is.
#pragma once

#include <array>

#include "sim/contact/field.h"
#include "sim/core/pose.h"
#include "sim/mujoco/linear/stability.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

// Returns the longest accurate step [s] (see above); infinite if nothing vibrates.
[[nodiscard]] double longest_averaged_step(const Vibration& vibration);

// Returns the inertia that springs and dashpots add over a step of `h` [s], (h/2) C + (h^2/4) K,
// about the tangent's point and along its axes, translation before rotation.
[[nodiscard]] Matrix6d added_inertia(const PadTangent& tangent, double h);
// The same for field_tangent() of a field whose elements have no dashpots of their own, about the
// surface's origin and along its axes.
[[nodiscard]] Matrix6d added_inertia(const Field& field, double viscous_time, double h);

// Transforms an inertia about the origin of one frame and along its axes to another frame, in which
// the first one is `frame`.
[[nodiscard]] Matrix6d seen_from(const Pose& frame, const Matrix6d& inertia);

// Two fingers, the held body, and the pads between them.
class HeldBodies {
 public:
  // `fingers`, `held`: bodies of the model. `spring`: between each finger and its carriage, in the
  // finger's axes. `h` [s]: the step. Throws std::logic_error if one of the bodies is not free and
  // without children.
  HeldBodies(const mjModel_* m, const std::array<int, 2>& fingers, int held, const PadTangent& spring, double h);

  [[nodiscard]] int held() const { return held_.body; }

  // Computes the accelerations of a step, from d->qfrc_smooth to d->qacc. Added inertias are about
  // the held body's frame, along its axes: `pads` between the fingers and the body, `ground`
  // between the body and fixed bodies. `carriages` [m/s2, rad/s2]: accelerations in the world of
  // the carriages of the fingers' springs. Also changes d->qfrc_applied, the forces of those
  // springs, from the start of the step to their value over the step. `d` must have its bodies'
  // frames and cvel.
  void solve(const mjModel_* m, mjData_* d, const std::array<Matrix6d, 2>& pads, const Matrix6d& ground,
             const std::array<Vector6d, 2>& carriages) const;

 private:
  struct Body {
    int body, dof;
    // about its frame and along its axes, its spring's contribution included
    Matrix6d inertia;
    Matrix6d spring = Matrix6d::Zero();     // that contribution
    Matrix6d stiffness = Matrix6d::Zero();  // its part from K
  };
  static Body free_body(const mjModel_* m, int body);

  std::array<Body, 2> fingers_;
  Body held_;
};

}  // namespace slipbench

// The springs of a grasp taken implicitly: `field_solver: implicit` in a scene with a gripper.
//
// Newmark's average acceleration (A method of computation for structural dynamics, 1959; beta 1/4, gamma 1/2), about the springs as they are when
// the step begins, written as MuJoCo steps, the velocity first and the position with the new one:
//   S a = F(x, v),   S = M + (h/2) C + (h^2/4) K,   v' = v + h a,   x' = x + h v'
// F is what an explicit step has, from fields whose tips stick, slip and touch as they do at x. So statics, thresholds and labels are those of the
// explicit step, and K and C act as an inertia that keeps fast modes slow: an error in them changes no force. With h v = x - x_before a linear
// model obeys
//   M (x' - 2 x + x_before)/h^2 + C (x' - x_before)/(2 h) + K (x' + 2 x + x_before)/4 = f
// which is stable at any step, of the second order, and without damping of its own: a mode of omega vibrates at Omega with
//   tan(Omega h/2) = omega h/2.
//
// Stable is not yet right. A step is right with
//   h omega <= 2,  and of a mode that is damped at c > 2 omega, above the critical,  h (c + sqrt(c^2 - 4 omega^2))/2 <= 2
// so that no mode turns by more than a quarter of its period within one, and none that only decays changes its sign. Beyond it the rings after a touch go over the cones of tips that hardly
// press, and labels tell of slips that never were (tests/sim/mujoco/bodies/grasp_solver_test.cc).
//
// Two fingers and what they hold are three free bodies. Each finger hangs on its spring and on its pad, and on nothing else, so it is solved for
// first, with G what the pad adds to the inertia, all 6x6 about the held body's frame and along its axes:
//   (P + G) a_f - G a = f_f + (h^2/4) K a_c,   (X + sum G) a - sum G a_f = f
// P has the finger's mass and what its spring adds. That hangs on a carriage which is accelerated by a_c: K acts on how far the finger is from it. C
// needs no such term: (h/2) C a_f brings the finger's velocity from the middle of the step before, where it is, to the tick, where the carriage's is.
#pragma once

#include <array>

#include "sim/core/pose.h"
#include "sim/field/field.h"
#include "sim/mujoco/linear/stability.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

// The longest step [s] that is right (see above); infinite when nothing vibrates.
[[nodiscard]] double longest_averaged_step(const Vibration& vibration);

// What springs and dashpots add to the inertia over a step of `h` [s], (h/2) C + (h^2/4) K, about the tangent's point and along its axes,
// translation before rotation.
[[nodiscard]] Matrix6d added_inertia(const PadTangent& tangent, double h);
// That of field_tangent() of a field whose elements have no dashpots of their own, about the surface's origin and along its axes.
[[nodiscard]] Matrix6d added_inertia(const Field& field, double viscous_time, double h);

// An inertia about the origin of one frame and along its axes, about and along those of another, in which that one is `frame`.
[[nodiscard]] Matrix6d seen_from(const Pose& frame, const Matrix6d& inertia);

// Two fingers, what they hold, and what lies between them.
class HeldBodies {
 public:
  // `fingers`, `held`: bodies of the model. `spring`: of each finger to its carriage, in the finger's axes. `h` [s]: the step.
  // Throws std::logic_error where one of the bodies is not free and alone.
  HeldBodies(const mjModel_* m, const std::array<int, 2>& fingers, int held, const PadTangent& spring, double h);

  [[nodiscard]] int held() const { return held_.body; }

  // The accelerations of a step, from d->qfrc_smooth to d->qacc. Added inertias are about the held body's frame, along its axes: `pads` between
  // the fingers and it, `ground` between it and what stands still. `carriages` [m/s2, rad/s2]: accelerations of what the fingers' springs hang
  // on, in the world. Also brings d->qfrc_applied, the forces of those springs where the step begins, to what they are over the step. `d` must have
  // its bodies' frames and cvel.
  void solve(const mjModel_* m, mjData_* d, const std::array<Matrix6d, 2>& pads, const Matrix6d& ground,
             const std::array<Vector6d, 2>& carriages) const;

 private:
  struct Body {
    int body, dof;
    Matrix6d inertia;                       // about its frame and along its axes, with what its spring adds
    Matrix6d spring = Matrix6d::Zero();     // what that is
    Matrix6d stiffness = Matrix6d::Zero();  // the part of K
  };
  static Body free_body(const mjModel_* m, int body);

  std::array<Body, 2> fingers_;
  Body held_;
};

}  // namespace slipbench

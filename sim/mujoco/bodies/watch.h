// What a run must obey whatever its scene, so that one that has gone wrong is not taken for a result. MuJoCo warns of little: a
// stiff pad that is stepped too long throws a box out of the gripper with no warning, or rings so that a cautious controller
// squeezes it.
//
// Weight. For a body with six degrees of freedom of its own, over a window of n steps of h,
//   sum h F = m (v_n - v_0)
// F being everything that acts on it, weight included: to rounding with MuJoCo's one-stage integrators and explicit fields; with
// implicit fields and with RK4 the force of a step lies between those of its two ends, which over the window makes a difference of
// at most sum |F_k+1 - F_k|/n. F is put together from what the labels say (the springs of the fields), so the rule compares the
// truth that is recorded with the motion that is recorded. Not in it are the fields' dashpots, whose mean is at most
//   d = tau K s / (n h),   s the way of the pad relative to the body from the window's start to its end, K the pad's sum of k_n.
// A body is at rest when d + sum |F_k+1 - F_k|/n <= m g/2000. Then the mean of the forces on it must be the weight (and what
// changes its momentum) to 0.1 % of m g. It cannot fire in a right run: half of the 0.1 % is all that is left out.
//
// Energy. A field is passive: over any time, with q the generalized force of all fields, U their elastic energy and L what their
// elements lose by slipping,
//   gain = sum h q . (v_k + v_k+1)/2 + U_n - U_0 + L <= 0        (less by what the dashpots take)
// since h F . (v_k + v_k+1)/2 is the kinetic energy that F gives, exactly. An explicit spring of phase z = h omega stepped by
// MuJoCo (velocity first) keeps v^2 + x^2 - z v x (in units of omega), so its energy swings by a factor of (1 + z/2)/(1 - z/2)
// between the extremes and by 1/(1 - z/2) from any mean: 1.6 at the longest step that is allowed, z = 0.75 (linear_model.h). So within
// a window a right run gains at most 0.6 of the energy that is there: kinetic and elastic at its start, and what others have put in
// since. The rule:
//   gain <= energy_share (T_0 + U_0 + sum of the positive works by weight, motors, springs and contacts of the model, and by the
//   stage)
// An unstable pad multiplies its energy in every step or two, and one that is kept in bounds by friction turns over many times its
// energy in a window. Fields with a rheology, a surface effect or leaning columns are left out: their stored energy is not
// f^2/(2k).
// A mode that average_acceleration.h steps, x_n = A cos(theta), turns by 2 phi in a step, tan phi = z/2. At the longest step, z = 2, and in units of
// k A^2/2, it has U = cos^2 theta and T = sin^2(theta - phi)/2 at a tick, together 0.191 = (3 - sqrt 5)/4 at least, of which T is at most 0.5, 2.6
// times as much. Its gain between two ticks telescopes to a difference of x_n (x_n - x_n+1) k/2, which is sqrt 2 at most, 7.4 times as much.
//
// Ejection. No body may have more kinetic energy than everything together had and got from weight, motors, springs and the stage
// since the start, times 1.6 as above:
//   m v^2/2 <= ejection_factor (T_0 + U_0 + sum of the positive works, MuJoCo's contacts left out)
// A contact that begins with a deep overlap, or one that diverges, throws its body out and so breaks this rule.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/core/pose.h"

namespace slipbench {

struct WatchLimits {
  double window = 0.1;           // s
  double weight_share = 1e-3;    // of m g
  double energy_share = 0.6;     // 1/(1 - 0.75/2) - 1
  double ejection_factor = 1.6;  // 1/(1 - 0.75/2)
  double energy_floor = 1e-9;    // J: what 1 g has at 1.4 mm/s. Below, rounding and the works' quadrature count
};

// A pad's dashpots on a body.
struct WatchedDashpot {
  double damping = 0.0;  // N s/m: tau K
  double reach = 0.0;    // m, of the pad's tips from its origin
  Pose pad;              // relative to what it touches
};

// A body as the weight rule sees it at one tick.
struct WatchedBody {
  double mass = 0.0;                                   // kg
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();    // N
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();  // kg m/s
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // N, of fields by the labels, of contacts and motors; no weight
  std::vector<WatchedDashpot> dashpots{};              // always the same ones in the same order
};

// Works and energies of one tick. A work belongs to the step that led to the tick.
struct WatchedEnergy {
  double kinetic = 0.0;         // J, of everything that is integrated
  double elastic = 0.0;         // J, of the fields
  double slip_loss = 0.0;       // J
  double field_work = 0.0;      // J, sum h q . v_mean
  double supply = 0.0;          // J, positive work by weight, motors, springs and the stage
  double contact_supply = 0.0;  // J, positive work by the model's contacts and other constraints
};

// The limits of a run by average_acceleration.h, see above.
[[nodiscard]] inline WatchLimits averaged(WatchLimits limits) {
  limits.energy_share = 7.5;
  limits.ejection_factor = 2.7;
  return limits;
}

// One rule each. check() returns what is wrong as the end of a sentence, or nothing; it is to be called at every tick.
class WeightRule {
 public:
  explicit WeightRule(const WatchLimits& limits) : limits_(limits) {}
  // `dt`: the step from this tick to the next [s].
  std::optional<std::string> check(const WatchedBody& body, double dt);

 private:
  [[nodiscard]] std::optional<std::string> judge(const WatchedBody& last) const;

  WatchLimits limits_;
  double time_ = 0.0;  // s, since the window began
  std::size_t steps_ = 0;
  Eigen::Vector3d impulse_ = Eigen::Vector3d::Zero();  // N s, weight included
  double variation_ = 0.0;                             // N, sum of the force's changes
  Eigen::Vector3d before_ = Eigen::Vector3d::Zero();   // N, force at the tick before
  WatchedBody first_;
};

class EnergyRule {
 public:
  // `judge_fields`: whether the fields' stored energy is known.
  EnergyRule(const WatchLimits& limits, bool judge_fields) : limits_(limits), judge_fields_(judge_fields) {}
  // `dt`: the step that led to this tick [s].
  std::optional<std::string> check(const WatchedEnergy& tick, double dt);
  // The ejection rule, for a body with `kinetic` [J] at the tick checked last.
  [[nodiscard]] std::optional<std::string> check_body(double kinetic) const;

 private:
  WatchLimits limits_;
  bool judge_fields_;
  bool started_ = false;
  double total_ = 0.0;      // J, of the start, and supplied since
  double time_ = 0.0;       // s, since the window began
  double available_ = 0.0;  // J, at the window's start, and supplied since
  double gain_ = 0.0;       // J, in the window
  double elastic_ = 0.0;    // J, at the tick before
};

}  // namespace slipbench

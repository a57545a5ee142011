// Rules that every run must obey, so that a diverged run is not taken for a result. MuJoCo warns of
// little: a stiff pad stepped too long throws a box out of the gripper without a warning, or rings
// so that a cautious controller squeezes it.
//
// Weight. For a body with six degrees of freedom of its own, in every step of h, at any motion,
//   F_k = m a_k,   a_k = (v_k+1 - v_k)/h + alpha_k x c + omega_k x (omega_k x c)
// F_k: the force on the body by the springs of the fields as in the labels, the fields' dashpots,
// the model's contacts, motors and joints, applied forces, and the weight. Implicit fields act with
// their force at a predicted pose, which rotating joints do not reach exactly: for them it is the
// force that the solver has applied. v: velocity of the body's frame, omega: its angular velocity,
// alpha: the change of omega in the step over h, c: the centre of mass in the frame, with the pose
// of step k. The rule compares the recorded truth with the recorded motion: over a window of n
// steps the mean of F_k - m a_k must be 0 to 0.1 % of m g.
//
// The balance holds to rounding for forces that MuJoCo evaluates at the start of the step. An
// integrator that looks ahead (RK4, average_acceleration.h, the damping of joints and motors,
// MuJoCo's contacts together with implicit fields) uses a force between those of the step's two
// ends, and so does the term of omega for an off-centre mass. The window's mean is then off by at
// most sum |P_k+1 - P_k|/n, P the sum of such forces, and the rule allows that much more.
//
// Energy. A field is passive: over any time, with q the generalized force of all fields, U their
// elastic energy and L their elements' loss by slipping,
//   gain = sum h q . (v_k + v_k+1)/2 + U_n - U_0 + L <= 0        (less the loss in dashpots)
// since h F . (v_k + v_k+1)/2 is exactly the kinetic energy that F delivers. An explicit spring of
// phase z = h omega stepped by MuJoCo (velocity first) keeps v^2 + x^2 - z v x (in units of omega),
// so its energy swings by a factor of (1 + z/2)/(1 - z/2) between the extremes and by 1/(1 - z/2)
// from any mean: 1.6 at the longest allowed step, z = 0.75 (stability.h). So within a window a
// valid run gains at most 0.6 of the available energy: kinetic and elastic at its start, and
// supplied since. The rule:
//   gain <= energy_share (T_0 + U_0 + sum of the positive works by weight, motors, springs and
//           contacts of the model, and by the stage)
// An unstable pad multiplies its energy in every step or two, and one that friction keeps bounded
// turns over many times its energy in a window. Fields with a rheology or a surface effect
// are excluded: their stored energy is not f^2/(2k).
//
// A mode stepped by average_acceleration.h, x_n = A cos(theta), turns by 2 phi per step, tan
// phi = z/2. At the longest step, z = 2, and in units of k A^2/2, it has U = cos^2 theta and
// T = sin^2(theta - phi)/2 at a tick. Their sum is at least 0.191 = (3 - sqrt 5)/4, and T is at
// most 0.5, 2.6 times as much. Its gain between two ticks telescopes to a difference of x_n
// (x_n - x_n+1) k/2, which is at most sqrt 2, 7.4 times as much.
//
// Ejection. No body may have more kinetic energy than the whole system had at the start and
// received since from weight, motors, springs and the stage, times 1.6 as above:
//   m v^2/2 <= ejection_factor (T_0 + U_0 + sum of the positive works, without MuJoCo's contacts)
// A contact that starts with a deep overlap, or one that diverges, ejects its body and so violates
// this rule.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace slipbench {

struct WatchLimits {
  double window = 0.1;           // s
  double weight_share = 1e-3;    // of m g
  double energy_share = 0.6;     // 1/(1 - 0.75/2) - 1
  double ejection_factor = 1.6;  // 1/(1 - 0.75/2)
  // J, energy of 1 g at 1.4 mm/s. Below it rounding and the quadrature of the works matter.
  double energy_floor = 1e-9;
};

// Input of the weight rule for a body at one tick.
struct WatchedBody {
  double weight = 0.0;                              // N, m g
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, total force on it
  // N, part of the force that a step evaluates between its two ends
  Eigen::Vector3d predicted = Eigen::Vector3d::Zero();
  // N, of the step that starts at this tick
  Eigen::Vector3d mass_times_acceleration = Eigen::Vector3d::Zero();
};

// Works and energies of one tick. A work belongs to the step that led to the tick.
struct WatchedEnergy {
  double kinetic = 0.0;         // J, of all bodies that are integrated
  double elastic = 0.0;         // J, of the fields
  double slip_loss = 0.0;       // J
  double field_work = 0.0;      // J, sum h q . v_mean
  double supply = 0.0;          // J, positive work by weight, motors, springs and the stage
  double contact_supply = 0.0;  // J, positive work by the model's contacts and other constraints
};

// Returns the limits of a run by average_acceleration.h, see above.
[[nodiscard]] inline WatchLimits averaged(WatchLimits limits) {
  limits.energy_share = 7.5;
  limits.ejection_factor = 2.7;
  return limits;
}

// The rules. check() must be called at every tick. It returns a violation as the end of a sentence,
// or nothing.
class WeightRule {
 public:
  explicit WeightRule(const WatchLimits& limits) : limits_(limits) {}
  // `dt`: the step from this tick to the next [s].
  std::optional<std::string> check(const WatchedBody& body, double dt);

 private:
  WatchLimits limits_;
  double time_ = 0.0;  // s, since the window began
  std::size_t steps_ = 0;
  Eigen::Vector3d missing_ = Eigen::Vector3d::Zero();  // N s, sum of h (F - m a)
  // N, sum of the changes of the predicted force
  double variation_ = 0.0;
  Eigen::Vector3d before_ = Eigen::Vector3d::Zero();  // N, predicted force at the last tick
};

class EnergyRule {
 public:
  // `judge_fields`: true if the fields' stored energy is known.
  EnergyRule(const WatchLimits& limits, bool judge_fields) : limits_(limits), judge_fields_(judge_fields) {}
  // `dt`: the step that led to this tick [s].
  std::optional<std::string> check(const WatchedEnergy& tick, double dt);
  // The ejection rule, for a body with `kinetic` [J] at the last tick checked.
  [[nodiscard]] std::optional<std::string> check_body(double kinetic) const;

 private:
  WatchLimits limits_;
  bool judge_fields_;
  bool started_ = false;
  double total_ = 0.0;      // J, at the start, and supplied since
  double time_ = 0.0;       // s, since the window began
  double available_ = 0.0;  // J, at the window's start, and supplied since
  double gain_ = 0.0;       // J, in the window
  double elastic_ = 0.0;    // J, at the last tick
};

}  // namespace slipbench

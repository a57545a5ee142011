// A scene whose bodies move by forces: MuJoCo steps them, with the pads as fields or as articulated
// pillars.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/api/simulation.h"
#include "sim/core/pose.h"
#include "sim/scene/scene.h"

struct mjData_;
struct mjModel_;

namespace slipbench {

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
// turns over many times its energy in a window. Fields with a rheology, a surface effect or leaning
// columns are excluded: their stored energy is not f^2/(2k).
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

struct Hand;  // model_builder.h

struct DynamicSimulationOptions {
  // False: for tests of the rules above, which must see the effects of a too long step.
  bool refuse_long_steps = true;
  WatchLimits limits{};
  FieldSolver hand_solver = FieldSolver::explicit_springs;  // of a grasp (average_acceleration.h)
  // The fingers of a grasp, whose springs the caller of step() applies; needed only in the
  // constructor.
  const Hand* hand = nullptr;
};

// Steps bodies by mj_step, or those of a grasp by FreeBodies (free_bodies.h). Fields are instances
// of the plugin `slipbench.field` (model_builder.h), which must be registered before. The stage,
// and the sensors that ride on it, follow the motion exactly: its state is overwritten at every
// tick.
//
// Truth at tick k is that of the state at k * time_step: with MuJoCo's one-stage integrators the
// state at the start of the step k -> k + 1; with RK4 that of the last stage of the step k - 1 ->
// k, which is accurate to third order in the step.
//
// The step of an explicit field is at most longest_explicit_step() (stability.h), evaluated at the
// start with every element of every pad stuck. When an element touches, the limit is evaluated
// again for the touching elements, and a step a third beyond it (h omega = 1: a slide starts to be
// inaccurate) ends the run. `time_step: auto` takes the longest valid step, at most the fastest
// sensor's sampling time. Implicit fields have no such limit.
//
// With `fidelity: mujoco_contact` the pads are articulated as well, but with the contact and the
// options of the scene's key `contact`: any step is taken, other contacts are allowed, and the
// results are reported as they are.
//
// With `fidelity: articulated` the same scene has MuJoCo bodies, joints and contacts for the pads'
// elements (articulated.h). Tips inside the touched surface at the start are pressed in and settled
// before t = 0, with all else held and without weights. Truth at tick k is that at the end of the
// step k - 1 -> k. The step is at most longest_articulated_step(). Any other contact of MuJoCo with
// friction ends the run, since the pads' recipe makes its friction wrong.
//
// Sensors that follow a pad (dynamic_state.h) have their own ticks, read its contact, and change
// nothing: the step depends only on the pads that exert forces.
//
// A diverged run ends in an InputError with the time: on any warning of MuJoCo (autoreset is off),
// and by the rules of watch.cc.
class DynamicSimulation final : public Simulation {
 public:
  // As for StageSimulation. Pads beyond the last of `output_rates` touch and push, but only
  // followers read them. Throws SceneValueError if the scene, its model and the step are
  // incompatible.
  DynamicSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                    std::uint64_t trial, const DynamicSimulationOptions& options = {});
  ~DynamicSimulation() override;

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override;
  [[nodiscard]] double time_step(std::size_t pad) const override;
  [[nodiscard]] std::size_t stride(std::size_t pad) const override;
  void step() override;
  [[nodiscard]] std::span<const std::size_t> stepped() const override;
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const override { return contact_part(pad, FramePart::all); }
  [[nodiscard]] const ContactFrame& contact_part(std::size_t pad, FramePart part) const override;
  void leave_slip_angle() override;
  // "pad" if sensors ride on the stage, the pad of every sensor with a site under the sensor's
  // name, the scene's own bodies, and those of the model that have a free joint or are named,
  // separated by spaces, in its custom text "slipbench.record".
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  // True if the stage rotates. Pads at sites rotate by forces, which is not reported here.
  [[nodiscard]] bool rotating() const override;

  // True if the current instant is a tick of the simulation (also at the start); otherwise it is a
  // tick of followers only, before the tick to which MuJoCo has already been stepped.
  [[nodiscard]] bool at_tick() const;

  // Returns the sum of the normal forces on a pad at its latest tick [N]. `carrying`: index among
  // the pads that exert forces, in the scene's order, unread ones included.
  [[nodiscard]] double normal_force(std::size_t carrying) const;
  // The same for MuJoCo's own contacts between two bodies of the model; 0 without contact.
  [[nodiscard]] double contact_normal_force(const std::string& body, const std::string& other) const;

  // Sets the acceleration of the carriage of finger 0 or 1 [m/s2, rad/s2], in the world, from the
  // next step on. Implicit springs need it.
  void tell_carriage(std::size_t finger, const Eigen::Matrix<double, 6, 1>& acceleration);

  // MuJoCo's model and data.
  [[nodiscard]] const mjModel_* model() const;
  [[nodiscard]] mjData_* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench

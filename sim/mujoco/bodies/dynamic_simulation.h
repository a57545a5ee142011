// A scene whose bodies move by forces: MuJoCo steps them, with the pads as fields or as articulated pillars.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

struct mjData_;
struct mjModel_;

namespace slipbench {

// What a run must obey whatever its scene, so that one that has gone wrong is not taken for a result. MuJoCo warns of little: a
// stiff pad that is stepped too long throws a box out of the gripper with no warning, or rings so that a cautious controller
// squeezes it.
//
// Weight. For a body with six degrees of freedom of its own, in every step of h, whatever the body does,
//   F_k = m a_k,   a_k = (v_k+1 - v_k)/h + alpha_k x c + omega_k x (omega_k x c)
// F_k: the force on the body by the springs of the fields as the labels have them, the fields' dashpots, the model's contacts, motors and
// joints, applied forces, and the weight. Implicit fields act with their force at a pose that the step foresees, which joints that turn do not take
// exactly: theirs is the force that the solver has applied. v: velocity of the body's frame, omega: its angular velocity, alpha: the change of omega in the step over
// h, c: the centre of mass in the frame, with the pose of step k. The rule compares the recorded truth with the recorded motion: over a window of n
// steps the mean of F_k - m a_k must be 0 to 0.1 % of m g.
// The balance holds to rounding for forces that MuJoCo takes as they are at the start of the step. An integrator that looks ahead (RK4,
// average_acceleration.h, the damping of joints and motors, MuJoCo's contacts beside implicit fields) puts a force between those of the step's two
// ends, as does the term of omega for an off-centre mass. The window's mean is then off by at most sum |P_k+1 - P_k|/n, P the sum of such forces, and the rule
// allows that much more.
//
// Energy. A field is passive: over any time, with q the generalized force of all fields, U their elastic energy and L what their
// elements lose by slipping,
//   gain = sum h q . (v_k + v_k+1)/2 + U_n - U_0 + L <= 0        (less by what the dashpots take)
// since h F . (v_k + v_k+1)/2 is the kinetic energy that F gives, exactly. An explicit spring of phase z = h omega stepped by
// MuJoCo (velocity first) keeps v^2 + x^2 - z v x (in units of omega), so its energy swings by a factor of (1 + z/2)/(1 - z/2)
// between the extremes and by 1/(1 - z/2) from any mean: 1.6 at the longest step that is allowed, z = 0.75 (stability.h). So within
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
struct WatchLimits {
  double window = 0.1;           // s
  double weight_share = 1e-3;    // of m g
  double energy_share = 0.6;     // 1/(1 - 0.75/2) - 1
  double ejection_factor = 1.6;  // 1/(1 - 0.75/2)
  double energy_floor = 1e-9;    // J: what 1 g has at 1.4 mm/s. Below, rounding and the works' quadrature count
};

// A body as the weight rule sees it at one tick.
struct WatchedBody {
  double weight = 0.0;                                  // N, m g
  Eigen::Vector3d force = Eigen::Vector3d::Zero();      // N, all that acts on it
  Eigen::Vector3d predicted = Eigen::Vector3d::Zero();  // N, that part of it which a step takes between its two ends
  Eigen::Vector3d mass_times_acceleration = Eigen::Vector3d::Zero();  // N, of the step from this tick on
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
  WatchLimits limits_;
  double time_ = 0.0;  // s, since the window began
  std::size_t steps_ = 0;
  Eigen::Vector3d missing_ = Eigen::Vector3d::Zero();  // N s, sum of h (F - m a)
  double variation_ = 0.0;                             // N, sum of the changes of the predicted force
  Eigen::Vector3d before_ = Eigen::Vector3d::Zero();   // N, predicted force at the tick before
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

struct Hand;  // model_builder.h

struct DynamicSimulationOptions {
  bool refuse_long_steps = true;  // false: for tests of the watch, which must see what a step that is too long does
  WatchLimits limits{};
  FieldSolver hand_solver = FieldSolver::explicit_springs;  // of a grasp (average_acceleration.h)
  const Hand* hand =
      nullptr;  // the fingers of a grasp, whose springs whoever steps the simulation applies; needed in the constructor only
};

// Bodies by mj_step, those of a grasp by what it needs of that (free_bodies.h); fields by the plugin `slipbench.field` (model_builder.h), which must be registered before; the stage, and the
// sensors that ride on it, exactly as the motion says: its state is overwritten at every tick.
//
// Truth at tick k is that of the state at k * time_step: with MuJoCo's one-stage integrators the state that the step k -> k + 1
// begins with, with RK4 that of the last stage of the step k - 1 -> k, which is of the third order in the step.
//
// The step: an explicit field bears no longer one than longest_explicit_step() (stability.h), taken at the start with every element
// of every pad stuck. Where an element touches it is worked out again, for the elements that touch, and a step a third beyond it (h
// omega = 1: there a slide begins to come out wrong) ends the run. `time_step: auto` takes
// the longest that fits, at most the fastest sensor's sampling time. Implicit fields have no such limit.
//
// With `fidelity: mujoco_contact` they are such pads too, but with the contact and the options of the scene's key `contact`: any
// step is taken, other contacts are allowed, and what comes of it is told as it is.
//
// With `fidelity: articulated` the same scene has MuJoCo bodies, joints and contacts for the pads' elements (articulated.h). Tips that
// begin inside what they touch are pressed in and settled, everything else held and without weights, before t = 0. Truth at tick k is
// that of the step k - 1 -> k, at its end. The step is longest_articulated_step() at most. No other contact of MuJoCo's with friction
// may touch: it ends the run, for the pads' recipe makes its friction wrong.
//
// Sensors that follow a pad (dynamic_state.h) have ticks of their own, read its contact, and change nothing: the step is that of what carries.
//
// A run that has gone wrong ends in an InputError, with the time: any warning of MuJoCo (autoreset is off), and the rules
// of watch.cc.
class DynamicSimulation final : public Simulation {
 public:
  // As StageSimulation's, but for pads after the last of `output_rates`: they touch and push, and a follower alone reads them. Throws SceneValueError where the scene, its model and the step do not suit each other.
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
  // "pad" where sensors ride on the stage, the pad of every sensor with a site under the sensor's name, the scene's own bodies, and
  // those of the model that have a free joint or that its custom text "slipbench.record" names, with spaces between them.
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  // Whether the stage turns; pads at sites turn as forces make them, which is not said here.
  [[nodiscard]] bool rotating() const override;

  // Whether the instant last stepped to is a tick of what carries (and at the start); else it is one of followers alone, before the tick that
  // MuJoCo has been stepped to already.
  [[nodiscard]] bool at_tick() const;

  // The sum of the normal forces on a pad at its latest tick [N]. `carrying`: counted among the pads that press, in the scene's
  // order, unread ones included.
  [[nodiscard]] double normal_force(std::size_t carrying) const;
  // The same of MuJoCo's own contacts between two bodies of the model; 0 where they do not touch.
  [[nodiscard]] double contact_normal_force(const std::string& body, const std::string& other) const;

  // The acceleration of what the spring of finger 0 or 1 hangs on [m/s2, rad/s2], in the world, for the steps from now on. Implicit springs need it.
  void tell_carriage(std::size_t finger, const Eigen::Matrix<double, 6, 1>& acceleration);

  // What MuJoCo has.
  [[nodiscard]] const mjModel_* model() const;
  [[nodiscard]] mjData_* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench

// Fields as implicit forces: `field_solver: implicit`, for pads too stiff for an explicit force on
// a light object.
//
// Backward Euler for the field, inside MuJoCo's own step. Over a step of length h from velocity v
// to v',
//   M (v' - v)/h = f_rest + J' F(w'),   w' = J v',
// where F is the wrench of the field at the pose reached with w', friction cone and return mapping
// included. It is solved in two parts.
//   1. Prediction: Newton iterations on the pads' relative velocities w alone,
//        w = w_0 + h (alpha + A F(w)),    A = J M^-1 J',
//      with alpha, the relative acceleration by all other forces (weight, motors, MuJoCo's
//      contacts), taken from the last steps. It determines which elements will stick, slip and
//      touch at the end of the step, the wrench F* there and the tangent K* (stability.h).
//   2. Correction: MuJoCo solves the whole model, contacts included, with
//      F(w') = F* - h K* (w' - w*). That needs h^2 K* in addition to M in its solver, which only
//      the integrator `discrete` offers, and only in undocumented memory of mjData: the rows of its
//      effective metric.
// If the prediction is exact, F(w') = F* is on the cone to the last digit. If not (a contact of
// MuJoCo that changes its force within the step), stick may exceed the cone in this one step, by h
// K_t (w' - w*); the next step starts from the true pose.
//
// Anchors are committed from poses alone, exactly as with an explicit field: at the end of the last
// step, then at this one's. So labels always describe the elements at a pose that the bodies really
// reached, and F at that pose is the wrench that was applied to get there. A rheology effect is
// stepped with the field; the prediction includes all of its force, the tangent only springs and
// dashpots.
//
// Requirements on the model (checked by implicit_refusal(), set by prepare_implicit()):
// - integrator="discrete", noslip_iterations="0", iterations="20" or more, solver Newton or CG,
//   flag damper on, sleep off,
// - for every kinematic tree with pads and every object that they touch a spatial tendon with
//   damping > 0 from a site on a body of the tree to a site on the object's, for instance
//   <spatial damping="1e-9"><site site="pad"/><site site="box"/></spatial>. Without one in the
//   metric MuJoCo takes shortcuts that omit the rows. 1e-9 N s/m is negligible damping.
// - a MuJoCo whose metric is known (effective_metric.h), as the rows are not part of its interface.
//   implicit_self_test() verifies their effect on the actual model; there is no silent fallback.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"
#include "sim/contact/field.h"
#include "sim/core/pose.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/releases/mujoco_library.h"

struct mjSpec_;

namespace slipbench {

// A pad and an object that it may touch, before any motion. `pad_in_body`: pad frame P in the pad's
// body.
struct ImplicitPad {
  int pad_body;
  int object_body;
  Pose pad_in_body;
  const PadLayout* layout;
};

// Least number of iterations of MuJoCo's solver, which must include the pads' stiffness.
inline constexpr int implicit_iterations = 20;

// MuJoCo's impratio, for its own contacts together with implicit pads. These do not allow noslip,
// so friction itself must be stiff: with MuJoCo's 1 a box of 5 g dragged over a table feels 0.44 of
// mu f_n, and one of 100 g slips at half of it. With 1e2, 1e3, 1e4 mu f_n is reached, and the creep
// at half of it is 9, 0.8, 0.1 um/s.
inline constexpr double implicit_impratio = 1e4;

// Adds the solver's requirements to a model that the program builds: options, and a tendon between
// the two sites (by name) of every pair. Throws std::invalid_argument if a site does not exist.
struct SitePair {
  std::string pad_site, object_site;
};
void prepare_implicit(mjSpec_* spec, std::span<const SitePair> pairs);

// Returns the requirements of implicit fields that this model does not meet: "needs
// integrator="discrete"; iterations="20" or more, found 5"; empty if it meets all.
[[nodiscard]] std::string implicit_refusal(ModelView m, std::span<const ImplicitPad> pads);

// Steps a copy of the model (plugins and constraints off, at qpos0, seeded velocities) with pads at
// their greatest stiffness as rows of the metric, and again under the force that these rows
// represent. Returns "" if both give the same acceleration, otherwise a sentence with the
// difference. Call implicit_refusal() first.
[[nodiscard]] std::string implicit_self_test(ModelView m, std::span<const ImplicitPad> pads);

// A field between two bodies, at the start of a step.
struct ImplicitContact {
  // Stepped repeatedly, left in any state: call load_state() before reading it. Null if it will not
  // touch.
  Field* field;
  std::span<const double> state;  // Field::save_state() after the step to the present pose
  int pad_body;
  int object_body;
  Pose pad, surface;  // pad frame and surface frame in the world
};

// The solver of one mjData. All fields of a model go through one call, since fields on one object
// affect each other.
class ImplicitFields {
 public:
  // Number of values kept from one step to the next for each contact; zero at the start. Keep them
  // in plugin_state.
  static constexpr std::size_t memory_per_contact = 6;

  // In the PASSIVE callback: adds the fields' force to d->qfrc_passive and their rows to d's
  // metric. `viscous_time` [s]: as in Field::damped_wrench_on_pad(). If MuJoCo has no metric in
  // this step or its arena is full, adds nothing and returns a sentence that says so.
  [[nodiscard]] std::string apply(ModelView m, DataView d, std::span<const ImplicitContact> contacts,
                                  std::span<const double> memory, double viscous_time);

  // After the step has computed its acceleration (a plugin's `advance`): updates the memory.
  void finish(ModelView m, DataView d, std::span<double> memory);

  // The wrench on the pad of contact i about the pad's origin, in world axes, as applied in the
  // step; valid after finish().
  [[nodiscard]] const Wrench& applied(std::size_t i) const { return applied_[i]; }

  // Newton iterations of the last apply(), and whether they converged. Otherwise the step uses the
  // best guess.
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] bool converged() const { return converged_; }

 private:
  // One field's wrench at the end of a step with the relative velocity w, and its tangents there.
  struct Linear {
    Vector6d force;
    Matrix6d stiffness;  // with damping / h; symmetric, as required by the metric
    // Growth of friction with the normal force; force changes by -(stiffness + coupling) h dw.
    Matrix6d coupling;
  };

  Pose move(const ImplicitContact& contact, const Vector6d& w) const;
  [[nodiscard]] bool touches(const ImplicitContact& contact, const Vector6d& w) const;
  void evaluate(const ImplicitContact& contact, const Vector6d& w, Linear& linear) const;
  void find_active(std::span<const ImplicitContact> contacts, std::span<const double> memory);
  void predict(std::span<const ImplicitContact> contacts);
  [[nodiscard]] Eigen::VectorXd residual(std::span<const ImplicitContact> contacts, const Eigen::VectorXd& w);

  double h_ = 0.0;                   // s, of the step
  double tau_ = 0.0;                 // s, viscous time
  RowMatrix jacobians_;              // [6 n, nv] of all contacts
  Eigen::VectorXd start_;            // [6 n] J v, for contacts with a field
  Eigen::VectorXd free_;             // [6 a] J v + h alpha of the active contacts
  std::vector<std::size_t> active_;  // contacts that touch now or would without their force
  Eigen::MatrixXd delassus_;         // [6 a, 6 a]
  Eigen::VectorXd w_;                // [6 a] the prediction
  std::vector<Linear> linear_;       // [a] at the prediction
  std::vector<Wrench> applied_;      // [n]
  int iterations_ = 0;
  bool converged_ = true;
};

}  // namespace slipbench

// A scene: all settings of a scene file, checked and in SI.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// Friction of the touched surface: the material's coefficients, overridden by the scene's own, both
// multiplied by `scale`.
struct FrictionScene {
  double static_coefficient = 0.0;   // mu_s
  double kinetic_coefficient = 0.0;  // mu_k <= mu_s
  double scale = 1.0;                // already contained in both
};

// One sensor of a scene.
struct SensorScene {
  std::string name;  // the scene's name for it: "pad"
  std::string type;  // "papillarray"
  Parameters parameters;
  std::vector<Named> electronics;  // empty: ideal

  // In a scene whose bodies move by forces:
  // The pad whose contact it reads without pressing on anything; empty: it has its own pad.
  std::string follows = {};
  double ahead = 0.0;  // m, distance before the followed pad
  // Site of the model whose frame is the pad frame P; empty: the pad rides on the stage.
  std::string site = {};
  std::vector<std::string> touches = {};  // geoms or bodies that the pad may touch
  double damping = 0.0;                   // s, time of a dashpot parallel to each spring
  // Friction with the touched bodies, if it differs from the scene's; then without effects.
  std::optional<FrictionScene> friction = {};
};

// The detector and its sensor.
struct DetectorScene {
  std::string type;        // "force_ratio"
  std::size_t sensor = 0;  // index in Scene::sensors of the sensor that it reads
  Parameters parameters;
};

// A body defined by the scene: a shape of the catalogue `bodies`.
struct BodyScene {
  std::string name;
  Named shape;
};

// Control of an actuator of the model: linear between points, constant before the first and after
// the last.
struct ControlScene {
  struct Point {
    double time;   // s
    double value;  // in the actuator's unit
  };
  std::string actuator;
  std::vector<Point> points;  // in order of time, at least one
};

// The motion of a grasp's arm whose speed the controller commands.
inline constexpr std::string_view guided_motion_name = "guided";

// The largest number of steps of a trial.
inline constexpr double max_steps = 1e8;

// The pad on the other finger of a grasp; no sensor reads it unless one follows it.
inline constexpr std::string_view second_pad_name = "second_pad";

// A gripper that takes a box from a table: the entries of the catalogue `grasp`.
struct GraspScene {
  Parameters grip, box;
  std::optional<Parameters> scatter;  // empty: all trials alike
};

// Required results of a scene's trials, for `slipbench check`.
struct ExpectScene {
  std::vector<Named> expectations;  // of the catalogue, in the scene's order; empty: none
  // of the interval that contains the rate of trials meeting an expectation
  double confidence = 0.95;
  std::string control;  // controller that must fail where the scene's own passes; empty: none
};

// Criterion for whether a body is still held when a trial ends.
struct HoldScene {
  std::string body;     // of the dataset's truth: "object"
  std::string against;  // pad of a sensor, or a body
  double from = 0.0;    // s
  // m; held: since `from` the body's origin has moved no farther relative to that of `against`.
  double within = 0.0;
};

// How the pads' springs enter a step of bodies that move by forces. Automatic: explicit, or in a
// grasp the cheaper one.
enum class FieldSolver : std::uint8_t { automatic, explicit_springs, implicit_springs };

struct Scene {
  std::string description;
  double duration = 0.0;            // s
  std::optional<double> time_step;  // s; empty: auto
  std::string fidelity = "field";
  // Parameters of fidelity mujoco_contact, as contact_entry declares them; empty: another fidelity.
  std::optional<Parameters> contact = {};
  std::uint64_t seed = 0;
  std::string material;
  Named surface;  // name is the shape: plane, box, cylinder, sphere
  FrictionScene friction;
  Named motion;  // name is the kind: stage
  std::vector<SensorScene> sensors;
  std::vector<Named> effects;
  std::optional<DetectorScene> detector = {};  // empty: none
  ExpectScene expect = {};                     // required results
  // of a dataset, as split_entry declares it; empty: by material
  std::optional<Parameters> split = {};

  // Bodies that move by forces. Without a model, bodies and a grasp all of these are empty, and all
  // motion is prescribed.
  std::string model = {};              // path of an MJCF file; empty: none
  std::vector<BodyScene> bodies = {};  // in addition to those of the model
  // m/s2, downwards; empty: the model's own, or the Earth's without a model
  std::optional<double> gravity = {};
  std::vector<ControlScene> controls = {};
  std::optional<HoldScene> hold = {};  // empty: the outcome does not include holding
  FieldSolver field_solver = FieldSolver::automatic;
  // of fields, MuJoCo's name; empty: the model's own, or the simulation's
  std::string integrator = {};
  // of a grasp; empty: none, the fingers keep their initial position
  std::optional<Named> controller = {};
  std::optional<GraspScene> grasp = {};  // without a model and bodies: it defines its own

  // True if the controller commands the arm.
  [[nodiscard]] bool guided() const { return motion.name == guided_motion_name; }
  // True if pads are solved within MuJoCo's own solver (sim/mujoco/pads/implicit.h).
  [[nodiscard]] bool implicit_fields() const { return field_solver == FieldSolver::implicit_springs && !grasp; }
  // True if any body moves by forces.
  [[nodiscard]] bool dynamic() const { return !model.empty() || !bodies.empty() || grasp.has_value(); }
};

}  // namespace slipbench

// A scene: everything that a scene file says, checked and in SI.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// Friction of the touched surface, after the scene's own values have overridden the material's and `scale` has multiplied both.
struct FrictionScene {
  double static_coefficient = 0.0;   // mu_s
  double kinetic_coefficient = 0.0;  // mu_k <= mu_s
  double scale = 1.0;                // already contained in both
};

// One sensor of a scene.
struct SensorScene {
  std::string name;  // the scene's own name for it: "pad"
  std::string type;  // "papillarray"
  Parameters parameters;
  std::vector<Named> electronics;  // empty: ideal

  // In a scene whose bodies move by forces:
  std::string follows = {};  // the pad whose contact it reads, and presses on nothing; empty: it has a pad of its own
  double ahead = 0.0;        // m, how far it stands before that pad, if it follows one
  std::string site = {};     // of the model, its frame is the pad frame P; empty: the pad rides on the stage
  std::vector<std::string> touches = {};       // geoms or bodies that the pad may touch
  double damping = 0.0;                        // s, time of a dashpot beside each spring
  std::optional<FrictionScene> friction = {};  // of what it touches, where that is not the scene's: no effects then
};

// What tells slip from one of the sensors.
struct DetectorScene {
  std::string type;        // "force_ratio"
  std::size_t sensor = 0;  // which of Scene::sensors it reads
  Parameters parameters;
};

// A body that the scene brings: a shape of the catalogue `bodies`.
struct BodyScene {
  std::string name;
  Named shape;
};

// What an actuator of the model is told: straight lines from point to point, constant before the first and after the last.
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

// The pad on the other finger of a grasp, which no sensor reads but one that follows it.
inline constexpr std::string_view second_pad_name = "second_pad";

// A gripper that takes a box from a table: the entries of the catalogue `grasp`.
struct GraspScene {
  Parameters grip, box;
  std::optional<Parameters> scatter;  // empty: every trial alike
};

// What must come out of a scene's trials, for `slipbench check`.
struct ExpectScene {
  std::vector<Named> expectations;  // of the catalogue, in the scene's order; empty: nothing is asked
  double confidence = 0.95;         // of the interval in which the rate of trials that keep an expectation is
  std::string control;              // controller that must fail where the scene's own passes; empty: none
};

// What tells whether a body is still held when a trial ends.
struct HoldScene {
  std::string body;     // of the dataset's truth: "object"
  std::string against;  // by what: the pad of a sensor, or a body
  double from = 0.0;    // s
  double within = 0.0;  // m; held: since `from` the body's origin has moved no farther against that of `against`
};

// How right a scene's results have to be. What setting that takes is for whoever runs it to find.
struct AccuracyScene {
  struct Wish {
    std::string measure;  // "onset"
    double limit;         // SI, a share as 0.01
  };
  std::vector<Wish> wishes;  // at least one
};

// How the pads' springs enter a step of bodies that move by forces. Automatic: explicit, or in a grasp what is cheaper.
enum class FieldSolver : std::uint8_t { automatic, explicit_springs, implicit_springs };

struct Scene {
  std::string description;
  double duration = 0.0;                       // s
  std::optional<double> time_step;             // s; empty: auto
  std::optional<AccuracyScene> accuracy = {};  // empty: as the scene sets it, right or not
  std::string fidelity = "field";
  std::optional<Parameters> contact = {};  // of fidelity mujoco_contact, as contact_entry declares them; empty: another one
  std::uint64_t seed = 0;
  std::string material;
  Named surface;  // name is the shape: plane, box, cylinder, sphere
  FrictionScene friction;
  Named motion;  // name is the kind: stage
  std::vector<SensorScene> sensors;
  std::vector<Named> effects;
  std::optional<DetectorScene> detector = {};  // empty: none
  ExpectScene expect = {};                     // what must come out
  std::optional<Parameters> split = {};        // of a dataset, as split_entry declares it; empty: by material

  // Bodies that move by forces. Without a model, bodies and a grasp all of it is empty, and everything moves as prescribed.
  std::string model = {};              // path of an MJCF file; empty: none
  std::vector<BodyScene> bodies = {};  // beside those of the model
  std::optional<double> gravity = {};  // m/s2, downwards; empty: the model's own, or the Earth's without a model
  std::vector<ControlScene> controls = {};
  std::optional<HoldScene> hold = {};  // empty: the outcome does not say whether anything is held
  FieldSolver field_solver = FieldSolver::automatic;
  std::string integrator = {};           // of fields, as MuJoCo calls it; empty: the model's own, or the simulation's
  std::optional<Named> controller = {};  // of a grasp; empty: none, the fingers stay where they begin
  std::optional<GraspScene> grasp = {};  // without a model and bodies: it brings its own

  // Whether the controller commands the arm.
  [[nodiscard]] bool guided() const { return motion.name == guided_motion_name; }
  // Whether pads are solved for within MuJoCo's own solver (sim/mujoco/pads/implicit.h).
  [[nodiscard]] bool implicit_fields() const { return field_solver == FieldSolver::implicit_springs && !grasp; }
  // Whether anything moves by forces.
  [[nodiscard]] bool dynamic() const { return !model.empty() || !bodies.empty() || grasp.has_value(); }
};

}  // namespace slipbench

// A free box on a pad with the mass, stiffness and friction of a hard case.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "sim/mujoco/bodies/dynamic_simulation.h"
#include "tests/expect.h"
#include "tests/oracle/pads.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench::hard {

inline constexpr double g = 9.81;                    // m/s2
inline constexpr double longest_sample = 2e-3;       // s, sampling time of the pads: the longest step of the hard cases
inline constexpr double k_n = 7100.0, k_t = 3900.0;  // N/m, a real pillar (sensors/papillarray/README.md)
// m. Wide enough for 5 kg on the softest pad: turned by a, the box's face moves it sideways by m g
// a/K_t, and the pad must balance m g times that with K_r a, K_r = 6 k_n pitch^2. With K_t = 9 k_t
// this needs pitch > m g/sqrt(54 k_n k_t) = 13 mm at a tenth of k_n, k_t.
inline constexpr double pitch = 0.02;

// n x n flat elements, one every `spacing` [m], each with `k_normal` and `k_tangential` [N/m]; one
// unit each.
inline PadLayout flat_square(int n, double spacing, double k_normal, double k_tangential) {
  return oracle::square_grid(n, n * spacing, k_normal, k_tangential);
}

inline std::string exact(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

inline std::string exact(const Eigen::Vector3d& v) { return exact(v.x()) + " " + exact(v.y()) + " " + exact(v.z()); }

// A box whose frame has its origin in the middle of the face it lies on, with its centre of mass 1
// mm above and slightly beside: a push at the origin hardly tips it. Nothing is symmetric about the
// pad.
struct BoxOnPad {
  double mass = 0.1;                                                                   // kg
  double mu = 0.5;                                                                     // static and kinetic
  PadLayout pad = flat_square(3, pitch, k_n, k_t);                                     // faces up, fixed to the world
  double damping = 0.0;                                                                // s, tau
  std::string time_step = "auto";                                                      // in the scene
  double duration = 1.0;                                                               // s, rounded up to whole samples
  Eigen::Vector3d position{0.013e-3, -0.021e-3, 0.0};                                  // m, of the face's middle over the pad's
  Eigen::Vector3d turn = 0.004 * Eigen::Vector3d(0.5, 0.7, 0.6).normalized();          // rad
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero(), spin = Eigen::Vector3d::Zero();  // m/s in the world, rad/s in the box
  std::vector<std::pair<double, double>> push{{0.0, 0.0}};                             // s, N along x
  std::string solver = "explicit", integrator = "implicitfast", fidelity = "field";
  double gravity = g;
};

inline constexpr double half_width = 0.04, half_height = 0.02;  // m
inline const Eigen::Vector3d centre{0.03e-3, 0.01e-3, 1e-3};    // m, of mass
// About the centre of mass, for a plate of that width [kg m2].
inline Eigen::Vector3d inertia_of(double mass) {
  const double across = mass * (half_width * half_width + half_height * half_height) / 3.0;
  return {across, across, 2.0 / 3.0 * mass * half_width * half_width};
}

inline std::string model_of(const BoxOnPad& box) {
  const double angle = box.turn.norm();
  const Eigen::Vector3d axis = angle > 0.0 ? Eigen::Vector3d(box.turn / angle) : Eigen::Vector3d::UnitZ();
  return "<mujoco><compiler angle='radian'/><option integrator='" + box.integrator + "' gravity='0 0 " + exact(-box.gravity) +
         "'/><worldbody><body name='pad'><geom type='box' pos='0 0 -0.02' size='0.02 0.02 0.005'/><site name='pad' zaxis='0 0 -1'/></body><body name='box' pos='" +
         exact(box.position) + "' axisangle='" + exact(axis) + " " + exact(angle) + "'><freejoint name='box'/><inertial pos='" +
         exact(centre) + "' mass='" + exact(box.mass) + "' diaginertia='" + exact(inertia_of(box.mass)) +
         "'/><geom name='box' type='box' pos='0 0 " + exact(half_height) + "' size='" +
         exact({half_width, half_width, half_height}) +
         "'/></body></worldbody><actuator><motor name='push' joint='box' gear='1 0 0 0 0 0'/></actuator></mujoco>";
}

// The box's upper face is at z = 0, under the stage's pad; both pads are nine pillars.
inline std::string stacked_model(const BoxOnPad& box) {
  std::string model = model_of(box);
  const double down = -2.0 * half_height;
  const auto replace = [&model](const std::string& from, const std::string& to) {
    model.replace(model.find(from), from.size(), to);
  };
  replace("<body name='pad'>", "<body name='pad' pos='0 0 " + exact(down) + "'>");
  replace("<body name='box' pos='" + exact(box.position),
          "<body name='box' pos='" + exact(box.position + Eigen::Vector3d(0, 0, down)));
  return model;
}

// The same with a finger of `finger` [kg] on a guide, whose motor is `press`; the pad above the box
// is at its site `finger` instead of the stage.
inline std::string fingered_model(const BoxOnPad& box, double finger) {
  std::string model = stacked_model(box);
  model.insert(model.find("</worldbody>"),
               "<body name='finger' pos='0.05e-3 0.03e-3 0.01e-3'><joint name='down' type='slide' axis='0 0 -1' damping='" +
                   exact(40.0 * finger) + "'/><geom type='box' pos='0 0 0.03' size='0.01 0.01 0.01' mass='" + exact(finger) +
                   "'/><site name='finger'/></body>");
  model.insert(model.find("</actuator>"), "<motor name='press' joint='down'/>");
  return model;
}

// The stiffest mode [rad/s] between finger and box: the lighter one against 18 springs, or 9 fixed
// ones.
inline double fastest_of_ratio(double finger, double box) { return std::sqrt(18.0 * k_n / std::min(finger, box)); }

// The scene's lines for simulating its pads; articulated pads have no choice of solver.
inline std::string pads_of(const std::string& fidelity, const std::string& solver) {
  return fidelity == "articulated" ? "fidelity: articulated\n" : "field_solver: " + solver + "\n";
}

inline std::string scene_of(const BoxOnPad& box) {
  std::string push;
  for (const auto& [time, force] : box.push) push += (push.empty() ? "[[" : ", [") + exact(time) + " s, " + exact(force) + " N]";
  return "slipbench: 1\nmodel: box.xml\nduration: " + exact(longest_sample * std::ceil(box.duration / longest_sample - 1e-9)) +
         " s\ntime_step: " + box.time_step + "\n" + pads_of(box.fidelity, box.solver) + "friction: {static: " + exact(box.mu) +
         ", kinetic: " + exact(box.mu) + "}\ncontrols: {push: " + push +
         "]}\nsensors: {pad: {type: papillarray, site: pad, touches: [box], damping: " + exact(box.damping) + " s}}\n";
}

// A bench of the scene with the given pads, whatever the scene's sensors.
class CaseRun {
 public:
  explicit CaseRun(const BoxOnPad& box) : CaseRun(scene_of(box), "box.xml", model_of(box), {&box.pad}) {
    // Articulated pads' joints come before the box's.
    const int first = simulation_->model()->jnt_dofadr[mj_name2id(simulation_->model(), mjOBJ_JOINT, "box")];
    Eigen::Map<Eigen::Vector3d>(simulation_->data()->qvel + first) = box.velocity;
    Eigen::Map<Eigen::Vector3d>(simulation_->data()->qvel + first + 3) = box.spin;
    mj_comVel(simulation_->model(), simulation_->data());  // needed by a first tick without a step
  }
  CaseRun(const std::string& scene, const std::string& file, const std::string& model,
          const std::vector<const PadLayout*>& pads) {
    register_plugin_once();
    folder_.write(file, model);
    const Scene read = parsed(SceneFile::from_text(scene, folder_.file("scene.yaml")));
    simulation_ = std::make_unique<DynamicSimulation>(read, pads, std::vector<double>(pads.size(), 1.0 / longest_sample), 0);
  }

  DynamicSimulation* operator->() { return simulation_.get(); }
  // Runs until the tick at `time` [s] has been computed; truth and bodies are those of that tick.
  void to(double time) {
    while (static_cast<double>(done_) * simulation_->time_step(0) <= time + 1e-9) step();
  }
  void to_end() {
    while (done_ < simulation_->ticks(0)) step();
  }
  void step() {
    simulation_->step();
    ++done_;
  }
  [[nodiscard]] const BodyState& body(const std::string& name) const { return body_of(*simulation_, name); }
  // Momentum of the box in the world [N s].
  [[nodiscard]] Eigen::Vector3d momentum() const {
    const BodyState& box = body("box");
    const int id = mj_name2id(simulation_->model(), mjOBJ_BODY, "box");
    return simulation_->model()->body_mass[id] * (box.velocity + box.angular_velocity.cross(box.pose.rotation * centre));
  }
  // Force of the pad's springs on the object, in the world [N].
  [[nodiscard]] Eigen::Vector3d force(std::size_t pad = 0) const {
    return -(body_of_pad(pad).rotation * simulation_->contact(pad).force.rowwise().sum().matrix());
  }

 private:
  [[nodiscard]] const Pose& body_of_pad(std::size_t pad) const { return simulation_->bodies()[pad].state.pose; }

  ModelFolder folder_;
  std::unique_ptr<DynamicSimulation> simulation_;
  std::size_t done_ = 0;
};

// The modes of the box on its pad with all elements sticking: K x = omega^2 M x about the pad's
// origin, for a pad that faces up and the box's initial pose.
struct Modes {
  double fastest, slowest;  // rad/s
};
inline Modes modes_of(const BoxOnPad& box) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  const auto cross = [](const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
  };
  Matrix6 stiffness = Matrix6::Zero(), mass = Matrix6::Zero();
  for (const Element& e : box.pad.elements) {
    // The site's x axis is the world's x or -x; the pad is symmetric, so both give the same result.
    Eigen::Matrix<double, 3, 6> move;  // of the tip, per velocity at the origin and spin
    move << Eigen::Matrix3d::Identity(), -cross({e.tip.x(), e.tip.y(), -e.tip.z()});
    stiffness += move.transpose() * Eigen::Vector3d(e.k_tangential, e.k_tangential, e.k_normal).asDiagonal() * move;
  }
  const double angle = box.turn.norm();
  const Eigen::Matrix3d turn =
      angle > 0.0 ? Eigen::AngleAxisd(angle, box.turn / angle).toRotationMatrix() : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  Eigen::Matrix<double, 3, 6> move;
  move << Eigen::Matrix3d::Identity(), -cross(box.position + turn * centre);
  mass = box.mass * move.transpose() * move;
  mass.bottomRightCorner<3, 3>() += turn * inertia_of(box.mass).asDiagonal() * turn.transpose();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> solver(stiffness, mass, Eigen::EigenvaluesOnly);
  return {std::sqrt(solver.eigenvalues()[5]), std::sqrt(solver.eigenvalues()[0])};
}

// Depth at which the pad carries the box [m].
inline double sag_of(const BoxOnPad& box) {
  double k = 0.0;
  for (const Element& element : box.pad.elements) k += element.k_normal;
  return box.mass * box.gravity / k;
}

inline BoxOnPad put_down(BoxOnPad box) {
  // At the equilibrium height, but askew: a third more on one corner, a third less on the other (at
  // most a tenth of mu, so that the box does not slide off), and 4 mrad about the vertical.
  box.position.z() = -sag_of(box);
  const double askew = std::min(0.2 * sag_of(box) / pitch, 0.1 * box.mu);
  box.turn = {askew, 0.65 * askew, 4e-3};
  // The stiffest mode is damped by zeta = tau omega/2 = 0.2; h tau omega^2 <= 1 then allows the
  // springs' 0.75/omega.
  box.damping = 0.4 / modes_of(box).fastest;
  return box;
}

inline BoxOnPad box_of(double mass, double stiffer, double mu) {
  BoxOnPad box{.mass = mass, .mu = mu, .pad = flat_square(3, pitch, stiffer * k_n, stiffer * k_t)};
  return put_down(box);
}

// Returns the error of a refused scene; empty if it is accepted.
inline std::string refusal(const BoxOnPad& box) {
  return refusal_of([&] { CaseRun run(box); });
}

}  // namespace slipbench::hard

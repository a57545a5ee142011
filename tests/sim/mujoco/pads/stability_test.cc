#include "sim/mujoco/linear/stability.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <Eigen/Geometry>

#include "sim/mujoco/pads/step_probe.h"
#include "tests/oracle/effect_field.h"
#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench {
namespace {

constexpr double k_n = 3000.0, k_t = 500.0, pitch = 0.007;  // nine_flat_pillars(1)

// A model in its initial pose.
struct Bodies {
  explicit Bodies(const std::string& world)
      : model(compile(parse("<mujoco><worldbody>" + world + "</worldbody></mujoco>").get())) {
    data.reset(mj_makeData(model.get()));
    mj_forward(model.get(), data.get());
  }
  int id(const char* body) const { return mj_name2id(model.get(), mjOBJ_BODY, body); }

  Model model;
  Data data;
};

// A pad that faces down (P has the world's axes) at `position`.
Pose at(const Eigen::Vector3d& position) { return {Eigen::Matrix3d::Identity(), position}; }

std::string body(const std::string& name, const std::string& joint, double mass, double inertia) {
  const std::string i = std::to_string(inertia);
  return "<body name='" + name + "'>" + joint + "<inertial pos='0 0 0' mass='" + std::to_string(mass) + "' diaginertia='" + i +
         " " + i + " " + i + "'/></body>";
}

// Against MuJoCo's own Jacobians of both bodies, for every pair in a model with joints of each
// kind, a welded body and a mocap one.
TEST(Stability, RelativeJacobianIsTheDifferenceOfMuJoCos) {
  const std::string inertial = "<inertial pos='.01 .02 .03' mass='1' diaginertia='1 1 1'/>";
  const Bodies bodies("<body pos='.1 .2 .3'><freejoint/>" + inertial + "<body pos='.1 0 0' euler='20 0 0'><joint type='ball'/>" +
                      inertial + "<body pos='0 .1 0'>" + inertial + "</body></body></body><body pos='1 0 0' euler='0 30 0'>" +
                      "<joint axis='1 1 0'/><joint type='slide' axis='0 1 1'/>" + inertial +
                      "</body><body mocap='true' pos='0 0 2'/>");
  const mjModel* m = bodies.model.get();
  const Eigen::Vector3d point(0.4, -0.3, 0.2);
  RowMatrix own(6, m->nv), other(6, m->nv), found(6, m->nv);
  ASSERT_EQ(m->nbody, 6);
  for (int a = 0; a < m->nbody; ++a) {
    for (int b = 0; b < m->nbody; ++b) {
      mj_jac(m, bodies.data.get(), own.data(), own.row(3).data(), point.data(), a);
      mj_jac(m, bodies.data.get(), other.data(), other.row(3).data(), point.data(), b);
      relative_jacobian(m, bodies.data.get(), {a, b, point}, found.data());
      EXPECT_EQ(found, own - other) << "bodies " << a << " and " << b;
    }
  }
}

// Two pads above and below a free body with a large moment of inertia: the stiffness along their
// normals is 2 * 9 k_n.
TEST(Stability, BodyBetweenTwoPads) {
  const Bodies bodies(body("box", "<freejoint/>", 0.1, 10.0));
  const PadLayout layout = nine_flat_pillars(1.0);
  const Eigen::Vector3d above(0.0, 0.0, 0.015), below(0.0, 0.0, -0.015);
  Pose upside_down = at(below);
  upside_down.rotation = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const double tau = 1e-3;
  const std::vector<PadOnBodies> pads{{0, bodies.id("box"), above}, {0, bodies.id("box"), below}};
  const std::vector<PadTangent> tangents{stuck_tangent(layout, at(above), above, tau),
                                         stuck_tangent(layout, upside_down, below, tau)};
  const Vibration vibration = fastest_vibration(bodies.model.get(), bodies.data.get(), pads, tangents);
  const double omega = std::sqrt(2.0 * 9.0 * k_n / 0.1);
  EXPECT_NEAR(vibration.omega / omega, 1.0, 1e-9);
  EXPECT_NEAR(vibration.damping_rate / (tau * omega * omega), 1.0, 1e-9);
  // Half the stiffness with one pad, sqrt(1/2) of the frequency.
  const Vibration one = fastest_vibration(bodies.model.get(), bodies.data.get(), {pads.data(), 1}, {tangents.data(), 1});
  EXPECT_NEAR(one.omega / (omega * std::sqrt(0.5)), 1.0, 1e-9);
}

// The bound is the root of the sum of all omega^4: for a body with a large moment of inertia, K
// along the normal and twice k_t/k_n K across it.
TEST(Stability, BoundIsTheRootOfTheSumOfSquaresOfAllModes) {
  const Bodies bodies(body("box", "<freejoint/>", 0.1, 1e6));
  const Eigen::Vector3d point(0.0, 0.0, 0.0);
  const std::array pads{PadOnBodies{0, bodies.id("box"), point}};
  const double tau = 1e-3, k = 9.0 * k_n / 0.1, across = 9.0 * k_t / 0.1;
  const std::array tangents{stuck_tangent(nine_flat_pillars(1.0), at(point), point, tau)};
  const Vibration bound = vibration_bound(bodies.model.get(), bodies.data.get(), pads, tangents);
  const double squares = std::sqrt(k * k + 2.0 * across * across);
  EXPECT_NEAR(bound.omega / std::sqrt(squares), 1.0, 1e-9);
  EXPECT_NEAR(bound.damping_rate / (tau * squares), 1.0, 1e-9);
  EXPECT_GT(bound.omega, fastest_vibration(bodies.model.get(), bodies.data.get(), pads, tangents).omega);
}

// A disc on a hinge along the pad's normal: sum k_t r^2 with four pillars at r^2 = 2 pitch^2 and
// four at pitch^2. The reference point of the tangent does not matter.
TEST(Stability, RotationAboutTheNormal) {
  const Bodies bodies(body("disc", "<joint type='hinge' axis='0 0 1'/>", 1.0, 1e-4));
  const double omega = std::sqrt(k_t * (4 * 2 + 4) * pitch * pitch / 1e-4);
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.02, -0.01, 0.03)}) {
    const std::array pads{PadOnBodies{0, bodies.id("disc"), point}};
    const std::array tangents{stuck_tangent(nine_flat_pillars(1.0), at(Eigen::Vector3d::Zero()), point, 0.0)};
    const Vibration vibration = fastest_vibration(bodies.model.get(), bodies.data.get(), pads, tangents);
    EXPECT_NEAR(vibration.omega / omega, 1.0, 1e-9);
  }
}

// Two free bodies move against each other with the reduced mass; a welded one drops out.
TEST(Stability, TwoFreeBodies) {
  const Bodies bodies(body("pad", "<freejoint/>", 0.05, 10.0) + body("box", "<freejoint/>", 0.005, 10.0) +
                      body("wall", "", 1.0, 1.0));
  const Eigen::Vector3d point(0.0, 0.0, 0.0);
  const std::array tangents{stuck_tangent(nine_flat_pillars(1.0), at(point), point, 0.0)};
  const auto omega = [&](const char* pad, const char* object) {
    const std::array pads{PadOnBodies{bodies.id(pad), bodies.id(object), point}};
    return fastest_vibration(bodies.model.get(), bodies.data.get(), pads, tangents).omega;
  };
  EXPECT_NEAR(omega("pad", "box") / std::sqrt(9.0 * k_n * (1.0 / 0.05 + 1.0 / 0.005)), 1.0, 1e-9);
  EXPECT_NEAR(omega("wall", "box") / std::sqrt(9.0 * k_n / 0.005), 1.0, 1e-9);
  EXPECT_NEAR(omega("pad", "world") / std::sqrt(9.0 * k_n / 0.05), 1.0, 1e-9);
  EXPECT_EQ(omega("wall", "world"), 0.0);
  EXPECT_EQ(longest_explicit_step({}), std::numeric_limits<double>::infinity());
}

TEST(Stability, DashpotsAreDamping) {
  PadLayout layout = nine_flat_pillars(1.0);
  for (Element& element : layout.elements) element.c_normal = 2.0;
  const Bodies bodies(body("box", "<freejoint/>", 0.1, 10.0));
  const Eigen::Vector3d point(0.0, 0.0, 0.0);
  const std::array pads{PadOnBodies{0, bodies.id("box"), point}};
  const std::array tangents{stuck_tangent(layout, at(point), point, 0.0)};
  EXPECT_NEAR(fastest_vibration(bodies.model.get(), bodies.data.get(), pads, tangents).damping_rate, 9.0 * 2.0 / 0.1, 1e-7);
}

// Wrench of a field about `point` in the world, starting at `state`, after a move (translation,
// rotation vector about the point) of the pad from `pose`; the surface is the world.
Vector6d wrench_after(Field& field, const std::vector<double>& state, const Pose& pose, const Vector6d& move) {
  Pose pad = pose;
  pad.position += move.head<3>();
  if (move.tail<3>().norm() > 0.0) {
    pad.rotation = Eigen::AngleAxisd(move.tail<3>().norm(), move.tail<3>().normalized()).toRotationMatrix() * pad.rotation;
  }
  field.load_state(state);
  field.step(pad, 1e-3);
  const Wrench wrench = field.wrench_on_pad();
  Vector6d all;
  all << pad.rotation * wrench.force, pad.rotation * wrench.torque;
  return all;
}

// Central differences of the wrench against the tangent. Moves of 1e-9 m and 1e-7 rad are far above
// rounding (1e-17 m) and far below the penetration of 1e-7 m. The load turns and shifts with the
// pad, which the tangent leaves out: 27e3 N/m * 1e-7 m * 1 rad is 1e-5 of k_n r.
TEST(Stability, FieldTangentIsTheDerivativeWhileItSticks) {
  Field field(nine_flat_pillars(1.0), Plane{}, {0.5, 0.5});
  Pose pose = at({0.002, -0.001, -1e-7});
  field.step(pose, 1e-3);
  std::vector<double> state(field.state_size());
  field.save_state(state);
  const Matrix6d tangent = field_tangent(field, {}, pose.position, 0.0).stiffness;
  // The tips are 1e-7 m under the contact points: that much less lever.
  EXPECT_LT((tangent - stuck_tangent(field.layout(), pose, pose.position, 0.0).stiffness).norm(), 9.0 * k_n * 1e-7);
  for (int k = 0; k < 6; ++k) {
    const double size = k < 3 ? 1e-9 : 1e-7;
    const Vector6d move = size * Vector6d::Unit(k);
    const Vector6d slope = (wrench_after(field, state, pose, -move) - wrench_after(field, state, pose, move)) / (2.0 * size);
    const double scale = k < 3 ? 9.0 * k_n : 9.0 * k_n * pitch;
    EXPECT_LT((slope - tangent.col(k)).norm(), 1e-4 * scale) << k;
  }
}

// One element dragged along x by 10 um at a penetration of 1 um: trial force k_t * 10 um = 5 mN,
// cone 0.5 * 3 mN. Zero stiffness along the slip, 1.5 mN / 10 um = 150 N/m across it, k_n along the
// normal.
TEST(Stability, SlippingElementIsStiffAcrossItsSlip) {
  PadLayout layout;
  layout.units.push_back({0, 1});
  layout.elements.push_back({.tip = {0.0, 0.0, 0.0}, .k_normal = k_n, .k_tangential = k_t});
  Field field(layout, Plane{}, {0.5, 0.5});
  field.step(at({0.0, 0.0, -1e-6}), 1e-3);
  const Pose dragged = at({10e-6, 0.0, -1e-6});
  field.step(dragged, 1e-3);
  ASSERT_EQ(field.state(0), ElementState::slip);
  const Matrix6d tangent = field_tangent(field, {}, field.contact_point(0), 0.0).stiffness;
  EXPECT_NEAR(tangent(0, 0), 0.0, 1e-9 * k_n);
  EXPECT_NEAR(tangent(1, 1), 150.0, 1e-9 * k_n);
  EXPECT_NEAR(tangent(2, 2), k_n, 1e-9 * k_n);
  EXPECT_LT((tangent - Matrix6d(tangent.diagonal().asDiagonal())).norm(), 1e-9 * k_n);
}

// The same with a rate law, at 10 um in 1 ms: along the slip the force grows with the slip's speed,
// and less of it follows the load.
TEST(Stability, RateLawResistsAlongTheSlip) {
  PadLayout layout;
  layout.units.push_back({0, 1});
  layout.elements.push_back({.tip = {0.0, 0.0, 0.0}, .k_normal = k_n, .k_tangential = k_t});
  for (const double speed : {1e-3, 1.0}) {
    Field field = oracle::field_with_effect(layout, {0.5, 0.5}, "viscous_friction", {{"gain", 1.0}, {"speed", speed}});
    field.step(at({0.0, 0.0, -1e-6}), 1e-3);
    std::vector<double> state(field.state_size());
    field.save_state(state);
    const Pose dragged = at({10e-6, 0.0, -1e-6});
    const auto slope = [&](int k) -> Vector6d {
      const Vector6d move = 1e-10 * Vector6d::Unit(k);
      return (wrench_after(field, state, dragged, -move) - wrench_after(field, state, dragged, move)) / 2e-10;
    };
    const Vector6d along = slope(0), across = slope(1), pressed = slope(2);
    wrench_after(field, state, dragged, Vector6d::Zero());
    ASSERT_EQ(field.state(0), ElementState::slip);
    const Matrix6d tangent = field_tangent(field, {}, field.contact_point(0), 0.0).stiffness;
    EXPECT_GT(tangent(0, 0), 1e-3 * k_t) << "far more than what the differences resolve";
    EXPECT_NEAR(tangent(0, 0), along[0], 1e-6 * k_t);
    EXPECT_NEAR(tangent(1, 1), across[1], 1e-6 * k_t);
    EXPECT_NEAR(-(1.0 - field.sliding_share(0)) * k_n * field.tangential_force(0).x() / field.normal_force(0), pressed[0],
                1e-6 * k_n);
  }
}

TEST(Stability, DetachedFieldHasNoTangent) {
  Field field(nine_flat_pillars(1.0), Plane{}, {0.5, 0.5});
  field.step(at({0.0, 0.0, 1e-3}), 1e-3);
  EXPECT_EQ(field_tangent(field, {}, Eigen::Vector3d::Zero(), 0.0).stiffness.norm(), 0.0);
}

TEST(Stability, LongestExplicitStep) {
  EXPECT_DOUBLE_EQ(longest_explicit_step({1000.0, 0.0}), 0.75e-3);
  // tau 1 ms at 3286 rad/s: 1 / (1e-3 * 3286^2) = 0.0926 ms, under 0.75 / 3286 = 0.228 ms.
  EXPECT_DOUBLE_EQ(longest_explicit_step({3286.0, 1e-3 * 3286.0 * 3286.0}), 1.0 / (1e-3 * 3286.0 * 3286.0));
}

// One degree of freedom of 1 kg: omega^2, tau omega^2 and a joint's damper.
LinearModel one_mode(double omega, double viscous_time, double joint_damping = 0.0) {
  const auto one_by_one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  return {one_by_one(1.0), one_by_one(omega * omega), one_by_one(viscous_time * omega * omega), one_by_one(joint_damping)};
}

constexpr double less = 0.99;  // the reported limit includes a margin of 1 %

// h omega = sqrt(4 + (tau omega)^2) - tau omega. A joint's damper D adds 2 h D to 4: (h omega)^2 +
// 2 h (tau omega^2 - D) = 4.
TEST(Stability, DivergenceOfOneModeSteppedVelocityFirst) {
  const Stepping euler = Stepping::velocity_first;
  EXPECT_NEAR(divergence_step(one_mode(1000.0, 0.0), euler), less * 2e-3, 1e-12);
  for (const double b : {0.1, 0.7, 3.0, 50.0}) {
    EXPECT_NEAR(divergence_step(one_mode(1000.0, b * 1e-3), euler), less * (std::sqrt(4.0 + b * b) - b) * 1e-3, 1e-12);
    EXPECT_NEAR(divergence_step(one_mode(1000.0, b * 1e-3, 300.0), euler),
                less * (std::sqrt(4.0 + std::pow(b - 0.3, 2)) - b + 0.3) * 1e-3, 1e-12);
  }
  EXPECT_EQ(divergence_step(one_mode(0.0, 0.0), euler), std::numeric_limits<double>::infinity());
}

// On the imaginary axis |R|^2 = 1 - y^6/72 + y^8/576, which is 1 at y^2 = 8. On the negative real
// axis 1 + z/2 + z^2/6 + z^3/24 = 0 at z = -2.785294 (R = 1); with b = tau omega = 50 the faster
// root is omega (b + sqrt(b^2 - 4))/2.
TEST(Stability, DivergenceOfOneModeUnderRungeKutta) {
  const Stepping rk4 = Stepping::runge_kutta;
  EXPECT_NEAR(divergence_step(one_mode(1000.0, 0.0), rk4), less * std::sqrt(8.0) * 1e-3, 1e-9);
  const double faster = 1000.0 * (50.0 + std::sqrt(2496.0)) / 2.0;
  EXPECT_NEAR(divergence_step(one_mode(1000.0, 0.05), rk4), less * 2.785293563 / faster, 1e-12);
  // There a joint's damper is explicit, with the same effect as a pad's.
  EXPECT_NEAR(divergence_step(one_mode(1000.0, 0.0, 5e4), rk4), divergence_step(one_mode(1000.0, 0.05), rk4), 1e-15);
  EXPECT_EQ(divergence_step(one_mode(0.0, 0.0), rk4), std::numeric_limits<double>::infinity());
}

// A finger of 0.2 kg on a damped guide over a free box of 0.1 kg, which another pad carries: along
// the normals
//   K = [[9 k_n, 9 k_n], [9 k_n, 18 k_n]] for the guide, which counts downwards, and the box; C = tau K, D of the guide alone.
TEST(Stability, LinearModelHasThePadsSpringsAndTheJointsDampers) {
  Bodies bodies(body("box", "<freejoint/>", 0.1, 10.0) +
                body("finger", "<joint type='slide' axis='0 0 -1' damping='7'/>", 0.2, 1.0));
  const PadLayout layout = nine_flat_pillars(1.0);
  const Eigen::Vector3d above(0.0, 0.0, 0.015), below(0.0, 0.0, -0.015);
  Pose upside_down = at(below);
  upside_down.rotation = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const double tau = 1e-3, k = 9.0 * k_n;
  const std::vector<PadOnBodies> pads{{bodies.id("finger"), bodies.id("box"), above}, {0, bodies.id("box"), below}};
  const std::vector<PadTangent> tangents{stuck_tangent(layout, at(above), above, tau),
                                         stuck_tangent(layout, upside_down, below, tau)};
  const LinearModel model = linear_model(bodies.model.get(), bodies.data.get(), pads, tangents);
  constexpr int up = 2, guide = 6;
  EXPECT_NEAR(model.stiffness(up, up), 2.0 * k, 1e-9 * k);
  EXPECT_NEAR(model.stiffness(up, guide), k, 1e-9 * k);
  EXPECT_NEAR(model.stiffness(guide, guide), k, 1e-9 * k);
  EXPECT_LT((model.damping - tau * model.stiffness).norm(), 1e-12 * model.stiffness.norm());
  EXPECT_NEAR(model.mass(up, up), 0.1, 1e-12);
  EXPECT_NEAR(model.mass(guide, guide), 0.2, 1e-12);
  EXPECT_EQ(model.joint_damping(guide, guide), 7.0);
  EXPECT_EQ(model.joint_damping.sum(), 7.0);
  // Without MuJoCo's implicit dampers only Euler treats them as explicitly as C.
  bodies.model->opt.disableflags |= mjDSBL_EULERDAMP;
  for (const int integrator : {mjINT_EULER, mjINT_IMPLICITFAST}) {
    bodies.model->opt.integrator = integrator;
    const bool explicitly = integrator == mjINT_EULER;
    const LinearModel other = linear_model(bodies.model.get(), bodies.data.get(), pads, tangents);
    EXPECT_NEAR(other.damping(guide, guide), tau * k + (explicitly ? 7.0 : 0.0), 1e-9 * tau * k);
    EXPECT_EQ(other.joint_damping.sum(), explicitly ? 0.0 : 7.0);
  }
  bodies.model->opt.integrator = mjINT_EULER;
  bodies.model->opt.disableflags |= mjDSBL_DAMPER;
  EXPECT_EQ(linear_model(bodies.model.get(), bodies.data.get(), pads, tangents).joint_damping.sum(), 0.0);
  EXPECT_EQ(stepping_of(bodies.model.get()), Stepping::velocity_first);
  bodies.model->opt.integrator = mjINT_RK4;
  EXPECT_EQ(stepping_of(bodies.model.get()), Stepping::runge_kutta);
}

// Spectral radius of a step, the limit of |step^k|^(1/k): by squaring, k = 2^40. GCC would compile
// Eigen's solver for 15 s.
double spectral_radius(Eigen::MatrixXd step) {
  double logarithm = 0.0;
  for (int doublings = 0; doublings < 40; ++doublings) {
    const double size = step.norm();
    logarithm += std::ldexp(std::log(size), -doublings);
    step /= size;
    step = step * step;
  }
  return std::exp(logarithm);
}

// Many modes with different damping: at the limit the step's matrix has the spectral radius 1.
TEST(Stability, DivergenceIsWhereTheStepsSpectralRadiusLeavesOne) {
  constexpr int n = 4;
  using Eigen::MatrixXd;
  const MatrixXd zero = MatrixXd::Zero(n, n), unit = MatrixXd::Identity(n, n), one = MatrixXd::Identity(2 * n, 2 * n);
  std::srand(3);  // Eigen's Random
  for (int trial = 0; trial < 20; ++trial) {
    const auto square = [](double size) -> MatrixXd {
      const MatrixXd root = MatrixXd::Random(n, n);
      return size * root.transpose() * root;
    };
    const MatrixXd mass = square(1.0) + 0.1 * unit;
    const LinearModel model{mass, square(1e6), square(trial % 2 == 0 ? 300.0 : 3e3), square(200.0)};
    // (v, x) after a step of h.
    const auto velocity_first = [&](double h) {
      const MatrixXd damped = (model.mass + h * model.joint_damping).inverse();
      const MatrixXd damping = model.damping + model.joint_damping;
      const MatrixXd of_v = unit - h * (damped * damping), of_x = -h * (damped * model.stiffness);
      MatrixXd step(2 * n, 2 * n);
      step << of_v, of_x, h * of_v, unit + h * of_x;
      return spectral_radius(step);
    };
    const auto runge_kutta = [&](double h) {
      const MatrixXd inverse = model.mass.inverse(), damping = model.damping + model.joint_damping;
      MatrixXd rate(2 * n, 2 * n), sum = one;  // sum: 1 + r (1 + r/2 (1 + r/3 (1 + r/4)))
      rate << -(inverse * damping), -(inverse * model.stiffness), unit, zero;
      rate *= h;
      for (const double order : {4.0, 3.0, 2.0, 1.0}) {
        const MatrixXd next = rate * sum;
        sum = one + next / order;
      }
      return spectral_radius(sum);
    };
    const double euler = divergence_step(model, Stepping::velocity_first) / less,
                 rk4 = divergence_step(model, Stepping::runge_kutta) / less;
    EXPECT_LE(velocity_first(0.9999 * euler), 1.0) << trial;
    EXPECT_GT(velocity_first(1.0001 * euler), 1.0) << trial;
    EXPECT_LE(runge_kutta(0.9999 * rk4), 1.0) << trial;
    EXPECT_GT(runge_kutta(1.0001 * rk4), 1.0) << trial;
  }
}

// A box on a slide with a damper of D = 40 N s/m between two pads, stepped by MuJoCo's Euler:
// omega^2 = 18 k_n/m, d = D/m = 400/s. The limit is (h omega)^2 = 4 + 2 h d, 3.56 ms; with explicit
// dampers it is (h omega)^2 + 2 h d = 4, 2.08 ms. (Pads' dashpots and free bodies:
// tests/tools/cost/stability_map_test.cc.)
TEST(Stability, DampersOfJointsCountAsEulerTakesThem) {
  using testing_plugin::config;
  testing_plugin::register_plugin_once();
  const double square = 18.0 * k_n / 0.1, d = 400.0, root = std::sqrt(d * d + 4.0 * square);
  const auto instance = [](const std::string& name) {
    return "<instance name='" + name + "'>" + config("pad", name) + config("touch", "box") + testing_plugin::nine_pillars() +
           config("friction", "{static: 1}") + config("damping", "0") + "</instance>";
  };
  for (const bool implicitly : {true, false}) {
    const std::string model =
        std::string("<mujoco><option gravity='0 0 0'><flag eulerdamp='") + (implicitly ? "enable" : "disable") +
        "'/></option><extension><plugin plugin='slipbench.field'>" + instance("left") + instance("right") +
        "</plugin></extension><worldbody><body name='box'><joint type='slide' axis='1 0 0' damping='40'/><geom name='box' type='box' size='0.015 0.02 0.06' mass='0.1' contype='0' conaffinity='0'/></body><body pos='-0.01499 0 0' euler='0 -90 0'><site name='left'/></body><body pos='0.01499 0 0' euler='0 90 0'><site name='right'/></body></worldbody></mujoco>";
    const std::array kick{1e-8};  // m/s; 14 pm at 986 rad/s, of 10 um of penetration
    StepProbe probe(model, kick);
    const double limit = (implicitly ? root + d : root - d) / square;
    EXPECT_NEAR(probe.predicted_step(), less * limit, 1e-9 * limit);
    EXPECT_NEAR(probe.measured_step(), limit, 5e-3 * limit);
  }
}

}  // namespace
}  // namespace slipbench

// Implicit springs of a grasp (average_acceleration.h): the law and its accuracy.
#include "sim/mujoco/linear/average_acceleration.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <mujoco/mujoco.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sim/mujoco/modes/free_bodies.h"
#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/grasp_rig.h"
#include "tests/sim/mujoco/pads/models.h"

namespace slipbench {
namespace {

constexpr double h = 5e-4;  // s

// Two fingers and a box with an off-centre mass, all turned and moving.
struct Hand3 {
  Hand3()
      : model(compile(
            parse(
                "<mujoco><option gravity='0 0 -9.81'><flag constraint='disable'/></option><worldbody>"
                "<body name='a' pos='-.05 .01 .02' euler='10 20 30'><freejoint/>"
                "<inertial pos='0 0 0' mass='.08' diaginertia='1.2e-4 1.2e-4 1.2e-4'/></body>"
                "<body name='b' pos='.04 -.02 .01' euler='-40 5 15'><freejoint/>"
                "<geom size='.01' pos='.01 .02 .03' euler='30 10 5' mass='0'/><site pos='.03 .01 -.02' euler='15 25 35'/>"
                "<inertial pos='0 0 0' mass='.08' diaginertia='1.2e-4 1.2e-4 1.2e-4'/></body>"
                "<body name='box' pos='.01 .02 .03' euler='5 -15 70'><freejoint/>"
                "<inertial pos='.004 -.003 .01' euler='20 30 40' mass='.2' diaginertia='1e-4 2e-4 2.5e-4'/>"
                "<geom size='.02' pos='-.01 .03 .01' euler='5 -10 15' mass='0'/><site pos='.01 .02 -.03' euler='35 5 -5'/></body>"
                "</worldbody></mujoco>")
                .get())) {
    data.reset(mj_makeData(model.get()));
    for (int i = 0; i < 18; ++i) data->qvel[i] = std::sin(1.0 + i);
    mj_forward(model.get(), data.get());
  }
  [[nodiscard]] int id(const char* body) const { return mj_name2id(model.get(), mjOBJ_BODY, body); }
  [[nodiscard]] Pose pose(int body) const { return pose_of(data->xpos + 3 * body, data->xmat + 9 * body); }

  Model model;
  Data data;
};

// A stiff, asymmetric 6x6 matrix.
Matrix6d lopsided(int seed, double size) {
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = std::sin(seed + 1.7 * i);
  return size * root.transpose() * root;
}

PadTangent finger_tangent() {
  PadTangent tangent;
  tangent.stiffness.diagonal() << 8e3, 15e3, 15e3, 100.0, 100.0, 100.0;
  tangent.damping.diagonal() << 15.0, 20.0, 20.0, 0.07, 0.07, 0.07;
  return tangent;
}

// S a = f + (h^2/4) K a_c in MuJoCo's own coordinates, with all of MuJoCo's Jacobians, against the
// three bodies in sequence.
TEST(AverageAcceleration, ThreeBodiesAreSolvedAsOneSystem) {
  Hand3 hand;
  mjModel* m = hand.model.get();
  mjData* d = hand.data.get();
  const std::array fingers{hand.id("a"), hand.id("b")};
  const int box = hand.id("box");
  const PadTangent spring = finger_tangent();
  const std::array pads{lopsided(1, 0.02), lopsided(2, 0.05)};
  const Matrix6d ground = lopsided(3, 0.03);
  std::array<Vector6d, 2> carriages;
  carriages[0] << 1.0, -2.0, 0.5, 3.0, -1.0, 2.0;
  carriages[1] << -0.3, 0.7, 1.5, -2.0, 4.0, 1.0;

  RowMatrix whole(18, 18);
  mj_fullM(m, d, whole.data());
  Eigen::VectorXd force = Eigen::Map<Eigen::VectorXd>(d->qfrc_smooth, 18);
  const Eigen::Vector3d origin = hand.pose(box).position;
  // A 6x6 matrix about a body's frame, in world axes: the box's, or a finger's.
  const auto turned = [](const Eigen::Matrix3d& rotation, const Matrix6d& local) {
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = rotation;
    return Matrix6d(turn * local * turn.transpose());
  };
  RowMatrix jacobian(6, 18);
  const auto add = [&](const PadOnBodies& bodies, const Matrix6d& inertia) {
    relative_jacobian(m, d, bodies, jacobian.data());
    whole += jacobian.transpose() * inertia * jacobian;
  };
  add({box, 0, origin}, turned(hand.pose(box).rotation, ground));
  for (std::size_t k = 0; k < 2; ++k) {
    const Pose finger = hand.pose(fingers[k]);
    add({fingers[k], box, origin}, turned(hand.pose(box).rotation, pads[k]));
    add({fingers[k], 0, finger.position}, turned(finger.rotation, 0.5 * h * spring.damping + 0.25 * h * h * spring.stiffness));
    force += jacobian.transpose() * turned(finger.rotation, 0.25 * h * h * spring.stiffness) * carriages[k];
  }
  const Eigen::VectorXd expected = whole.ldlt().solve(force);

  HeldBodies(m, fingers, box, spring, h).solve(m, d, pads, ground, carriages);
  const Eigen::Map<const Eigen::VectorXd> found(d->qacc, 18);
  EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm());
}

// Compares FreeBodies with MuJoCo's own computation, which shares no code with it.
TEST(FreeBodies, AreWhatMuJoCoMakesOfThem) {
  Hand3 hand;
  const mjModel* m = hand.model.get();
  mjData* d = hand.data.get();
  const Data own(mj_makeData(m));
  mju_copy(own->qpos, d->qpos, static_cast<int>(m->nq));
  mju_scl(own->qpos + 3, d->qpos + 3, 1.7, 4);  // a quaternion of another length is the same rotation
  mju_copy(own->qvel, d->qvel, static_cast<int>(m->nv));
  const FreeBodies bodies(m);
  bodies.place(m, own.get());
  const auto expect_same = [&](const char* what, const mjtNum* found, const mjtNum* expected, int size) {
    const auto as_vector = [size](const mjtNum* values) { return Eigen::Map<const Eigen::VectorXd>(values, size); };
    EXPECT_LT((as_vector(found) - as_vector(expected)).norm(), 1e-13 * as_vector(expected).norm()) << what;
  };
  const int several = static_cast<int>(m->nbody) - 1;
  expect_same("xpos", own->xpos + 3, d->xpos + 3, 3 * several);
  expect_same("xmat", own->xmat + 9, d->xmat + 9, 9 * several);
  expect_same("xquat", own->xquat + 4, d->xquat + 4, 4 * several);
  expect_same("xanchor", own->xanchor, d->xanchor, 3 * several);
  expect_same("xipos", own->xipos + 3, d->xipos + 3, 3 * several);
  expect_same("ximat", own->ximat + 9, d->ximat + 9, 9 * several);
  expect_same("subtree_com", own->subtree_com + 3, d->subtree_com + 3, 3 * several);
  expect_same("cdof", own->cdof, d->cdof, 6 * static_cast<int>(m->nv));
  expect_same("cvel", own->cvel + 6, d->cvel + 6, 6 * several);
  expect_same("geom_xpos", own->geom_xpos, d->geom_xpos, 3 * static_cast<int>(m->ngeom));
  expect_same("site_xmat", own->site_xmat, d->site_xmat, 9 * static_cast<int>(m->nsite));
  expect_same("qfrc_bias", own->qfrc_bias, d->qfrc_bias, static_cast<int>(m->nv));
  mju_scl(own->qfrc_smooth, d->qfrc_bias, -1.0, static_cast<int>(m->nv));
  bodies.accelerate(own.get());
  expect_same("qacc", own->qacc, d->qacc_smooth, static_cast<int>(m->nv));
  FreeBodies::factor(m, own.get());
  mj_solveM(m, own.get(), own->qacc, own->qfrc_smooth, 1);
  expect_same("mj_solveM", own->qacc, d->qacc_smooth, static_cast<int>(m->nv));
  mj_energyVel(m, d);
  const Eigen::VectorXd speed = Eigen::Map<const Eigen::VectorXd>(d->qvel, m->nv);
  EXPECT_NEAR(bodies.kinetic_energy(own.get(), speed), d->energy[1], 1e-14 * d->energy[1]);
}

// The sum over a field's elements, in the surface's axes about its origin, against the sum about
// any point in the world's axes.
TEST(AverageAcceleration, FieldAddsWhatItsTangentSays) {
  const PadLayout layout = nine_flat_pillars(1.0);
  Field field(layout, Plane{}, {0.5, 0.5});
  const auto pressed = [](double angle) {
    return Pose{Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {0.02, 0.001, -1e-3}};
  };
  constexpr double tau = 1e-3;
  // Sticking, and after a turn that stretches the corners, 9.9 mm from the middle, to 2 N of 1.5 N,
  // the edges to 1.4 N.
  for (const double angle : {0.0, 0.4}) {
    field.step(pressed(angle), 1e-3);
    const Pose surface{Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix(), {0.1, -0.2, 0.05}};
    const PadTangent tangent = field_tangent(field, surface, surface.position, tau);
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = surface.rotation;
    const Matrix6d expected = turn.transpose() * added_inertia(tangent, h) * turn;
    EXPECT_LT((added_inertia(field, tau, h) - expected).norm(), 1e-12 * expected.norm());
  }
  EXPECT_EQ(field.slipping(), 4U);
  EXPECT_EQ(field.touching(), 9U);
}

// A single finger, 80 g on 8 kN/m without a dashpot, pulled 1 mm aside: omega = 316.2 rad/s. Each
// step of h advances its phase by Omega h = 2 atan(omega h/2), with constant amplitude: after n
// steps of x' = x + h v' its position is A cos(Omega n h) + B sin(Omega n h).
TEST(AverageAcceleration, ModeVibratesAsTheLawSays) {
  Hand3 hand;
  mjModel* m = hand.model.get();
  mjData* d = hand.data.get();
  m->opt.disableflags |= mjDSBL_GRAVITY;
  constexpr double omega = 316.22776601683796, long_step = 5e-3;  // omega h = 1.58
  PadTangent spring;
  spring.stiffness.diagonal() << 8e3, 8e3, 8e3, 0.0, 0.0, 0.0;
  mj_resetData(m, d);
  m->opt.timestep = long_step;
  const int body = hand.id("a");
  const HeldBodies bodies(m, {body, hand.id("b")}, hand.id("box"), spring, long_step);
  const double rest = d->qpos[0], pulled = 1e-3;
  d->qpos[0] += pulled;
  const double turn = 2.0 * std::atan(0.5 * omega * long_step);
  // Its first step begins at rest: x_1 = x_0 + h v' with v' = -h k x_0/(m + h^2 k/4), which
  // determines B.
  std::optional<double> b;
  for (int n = 1; n <= 200; ++n) {
    mj_fwdPosition(m, d);
    mj_fwdVelocity(m, d);
    mju_zero(d->qfrc_smooth, 18);
    d->qfrc_smooth[0] = -8e3 * (d->qpos[0] - rest);
    bodies.solve(m, d, {Matrix6d::Zero(), Matrix6d::Zero()}, Matrix6d::Zero(), {Vector6d::Zero(), Vector6d::Zero()});
    mj_Euler(m, d);
    const double x = d->qpos[0] - rest;
    if (!b) b = (x - pulled * std::cos(turn)) / std::sin(turn);
    EXPECT_NEAR(x, pulled * std::cos(n * turn) + *b * std::sin(n * turn), 1e-9 * pulled) << n;
  }
}

// Two over the faster of a mode's rates: omega below the critical damping c = 2 omega, above it the
// greater root of l^2 - c l + omega^2. With omega = 1 the roots 5 and 1/5 belong to c = 5.2.
TEST(AverageAcceleration, LongestStepFollowsTheFasterRate) {
  EXPECT_DOUBLE_EQ(longest_averaged_step({4.0, 0.0}), 0.5);
  EXPECT_DOUBLE_EQ(longest_averaged_step({4.0, 8.0}), 0.5);
  EXPECT_DOUBLE_EQ(longest_averaged_step({1.0, 5.2}), 0.4);
  EXPECT_TRUE(std::isinf(longest_averaged_step({})));
}

struct Outcome {
  double slip, peak, final;
};

Outcome outcome(const std::string& text) {
  GraspRig rig(text);
  Outcome result{0.0, 0.0, 0.0};
  while (rig->truth().time < 3.0) {
    rig.step();
    result.peak = std::max({result.peak, rig->truth().pad_force[0], rig->truth().pad_force[1]});
  }
  result.slip = rig->truth().slip.norm();
  result.final = rig->truth().grip_force;
  EXPECT_FALSE(rig->truth().dropped);
  return result;
}

const std::string felt =
    "surface: {material: felt}\neffects: [{anisotropic_friction: {ratio: 0.6}}, {patchy_friction: {sd: 0.2, shortest: 8 mm, longest: 20 mm}}]\n";

// Limits: slip within 0.5 %, peak force within 0.1 %. Cases: surfaces that hold; PTFE at 0.2, where
// pillars slip on the way up; a friction that holds the weight plus 2 %, but not the 4 % of the
// arm's acceleration, so that the box slips during that; and a heavy box. The references are the
// implicit solver at 0.125 ms and the explicit one at 0.05 ms, each exact to 0.1 %.
TEST(GraspSolver, AutomaticStepIsRightToHalfAPercent) {
  for (const std::string& surface : {std::string("surface: {material: rubber}\n"), std::string("surface: {material: ptfe}\n"),
                                     felt, std::string("surface: {material: ptfe}\nfriction: {static: 0.2, kinetic: 0.2}\n"),
                                     std::string("friction: {static: 0.193, kinetic: 0.193}\n"),
                                     std::string("surface: {material: rubber}\nbox: {mass: 0.5 kg}\n"),
                                     std::string("surface: {material: ptfe}\nbox: {mass: 0.5 kg}\neffects: [elastic_skin]\n")}) {
    const std::string scene = surface + "grip: {}\nmotion: {kind: lift, settle: 1 s}\n";
    const Outcome automatic = outcome(scene);
    for (const char* how : {"field_solver: implicit\ntime_step: 0.125 ms\n", "field_solver: explicit\ntime_step: 0.05 ms\n"}) {
      const Outcome fine = outcome(scene + how);
      EXPECT_NEAR(automatic.slip, fine.slip, 5e-3 * fine.slip) << surface << how;
      EXPECT_NEAR(automatic.peak, fine.peak, 1e-3 * fine.peak) << surface << how;
      EXPECT_NEAR(automatic.final, fine.final, 1e-3 * fine.final) << surface << how;
    }
  }
}

// Elements that hold while the box is squeezed must not slip in the labels: pads of both fingers
// before the lift.
TEST(GraspSolver, TouchMakesNoSlipThatIsNone) {
  const auto slips = [](const std::string& how) {
    GraspRig rig("surface: {material: rubber}\nbox: {mass: 0.5 kg}\ngrip: {}\nmotion: {kind: lift, settle: 1 s}\n" + how);
    std::size_t count = 0;
    while (rig->truth().time < 0.99) {
      rig.step();
      count += static_cast<std::size_t>(std::ranges::count(rig->contact(0).unit_state, UnitState::slip));
    }
    return count;
  };
  EXPECT_EQ(slips("field_solver: explicit\ntime_step: 0.05 ms\n"), 0U);
  EXPECT_EQ(slips(""), 0U);
}

// Soft skins carry the weight without creep: the limit is 0.01 um/s. Six times the slip load, so
// that no element is near its cone.
TEST(GraspSolver, SoftSkinsHoldWithoutCreep) {
  GraspRig rig(
      "surface: {material: rubber}\ngrip: {second_pad: same}\nmotion: {kind: lift, settle: 1 s}\nduration: 63 s\neffects: [elastic_skin]\n");
  rig.run_to(4.0);
  const Eigen::Vector3d before = rig.box_in_arm();
  EXPECT_NEAR(rig.pads_on_box().z() / (0.2 * 9.81), 1.0, 1e-3);
  rig.run_to(62.0);
  EXPECT_LT((rig.box_in_arm() - before).norm() / 58.0, 0.01e-6);
}

// By default the cheaper solver is chosen. At 100 Hz 44 explicit steps per sample compare with 17
// implicit ones, at 1 kHz 5 with 2. A step given by the scene is implicit, which is second order.
// (The nib pad has a sampling time as short: scenes/nib_pad/reorient.yaml.)
TEST(GraspSolver, AutomaticTakesTheCheaperOne) {
  const std::string scene = "grip: {}\nmotion: {kind: lift, settle: 1 s, distance: 10 mm}\nduration: 1.5 s\n";
  const auto slip = [&](const std::string& rate, const std::string& how) {
    GraspRig rig(scene + how, 0, {}, ", rate: " + rate);
    rig.run();
    return rig->truth().slip;
  };
  const auto gives = [&](const std::string& rate, const std::string& how, const std::string& solver) {
    return slip(rate, how) == slip(rate, how + "field_solver: " + solver + "\n");
  };
  EXPECT_TRUE(gives("100 Hz", "", "implicit"));
  EXPECT_TRUE(gives("1 kHz", "", "implicit"));
  EXPECT_FALSE(gives("1 kHz", "", "explicit"));
  EXPECT_TRUE(gives("100 Hz", "time_step: 0.2 ms\n", "implicit"));
  EXPECT_TRUE(gives("100 Hz", "time_step: 0.5 ms\n", "implicit"));
  EXPECT_FALSE(gives("100 Hz", "time_step: 0.2 ms\n", "explicit"));
}

// Springs of unknown stiffness are stepped explicitly; a scene that asks for the implicit solver
// gets an error.
TEST(GraspSolver, EffectsWithoutAKnownStiffnessGoExplicitly) {
  const std::string scene = "effects: [viscoelastic]\ngrip: {}\nmotion: {kind: lift, settle: 1 s}\n";
  const auto step_of = [](const std::string& text, const std::string& sensor = "") {
    return GraspRig(text, 0, {}, sensor)->time_step(0);
  };
  const double chosen = step_of(scene);
  EXPECT_EQ(chosen, step_of(scene + "field_solver: explicit\n"));
  EXPECT_GT(step_of("grip: {}\nmotion: {kind: lift, settle: 1 s}\n"), 2.0 * chosen);
  EXPECT_THAT(scene_refusal_of([&] { GraspRig refused(scene + "field_solver: implicit\n"); }),
              AllOf(StartsWith("field_solver | "), HasSubstr("change their stiffness")));
}

}  // namespace
}  // namespace slipbench

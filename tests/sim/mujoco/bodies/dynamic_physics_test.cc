// Scenes whose bodies move by forces, against closed forms and against the same model without the
// bench.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "sim/api/motion.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/stage/stage_setup.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"
#include "tests/sim/mujoco/bodies/dynamic_scenes.h"

namespace slipbench {
namespace {

constexpr double g = 9.81;  // m/s2

// MuJoCo's own loop over the model that the scene should give, written by hand.
TEST(DynamicSimulation, HeldBoxIsTheModelWrittenByHandToTheBit) {
  const std::string fingers = two_fingers("integrator='implicitfast'");
  const ModelFolder folder;
  folder.write("fingers.xml", fingers);
  DynamicRig rig(
      held_box(
          "duration: 0.5 s\ntime_step: 250 us\ncontrols: {left: [[0.25 s, 4 N], [0.5 s, 0.5 N]], right: [[0.25 s, 4 N], [0.5 s, 0.5 N]]}\n"),
      folder.file("scene.yaml"));

  std::string xml = fingers;
  const auto insert = [&xml](const std::string& before, const std::string& text) { xml.insert(xml.find(before), text); };
  std::string instances;
  for (const std::string side : {"left", "right"}) {
    instances +=
        "<instance name='" + side + "'><config key='pad' value='" + side +
        "_pad'/><config key='touch' value='box'/><config key='sensor' value='{type: papillarray}'/><config key='friction' value='{static: 0.5, kinetic: 0.5}'/></instance>";
  }
  insert("<worldbody>", "<extension><plugin plugin='slipbench.field'>" + instances + "</plugin></extension>");
  insert("</worldbody>",
         "<body name='box' pos='0 0 0.1'><freejoint/><geom name='box' type='box' size='0.02 0.02 0.03' mass='0.1'/></body>");
  insert("<actuator>",
         "<contact><exclude body1='left_finger' body2='box'/><exclude body1='right_finger' body2='box'/></contact>");
  xml.replace(xml.find("<option "), 8, "<option timestep='0.00025' ");
  char error[500] = "";
  const SpecPointer spec(mj_parseXMLString(xml.c_str(), nullptr, error, sizeof error));
  ASSERT_TRUE(spec) << error;
  const ModelPointer model(mj_compile(spec.get(), nullptr));
  ASSERT_TRUE(model) << mjs_getError(spec.get());
  const DataPointer data(mj_makeData(model.get()));

  ASSERT_EQ(model->nq, rig->model()->nq);
  for (std::size_t tick = 0; tick < rig->ticks(0); ++tick) {
    rig->step();
    const double t = static_cast<double>(tick) / 4000.0;
    data->ctrl[0] = data->ctrl[1] = t <= 0.25 ? 4.0 : 4.0 + (0.5 - 4.0) * ((t - 0.25) / 0.25);
    mj_step(model.get(), data.get());
    ASSERT_EQ(std::memcmp(data->qpos, rig->data()->qpos, static_cast<std::size_t>(model->nq) * sizeof(mjtNum)), 0)
        << "tick " << tick;
    ASSERT_EQ(std::memcmp(data->qvel, rig->data()->qvel, static_cast<std::size_t>(model->nv) * sizeof(mjtNum)), 0)
        << "tick " << tick;
  }
  EXPECT_LT(data->qpos[4], 0.0998) << "the box has slipped: the comparison has seen more than a hold";
}

// The pad's force at tick k is that of the poses recorded for tick k, and a pose is the previous
// one moved by the velocity recorded with it.
TEST(DynamicSimulation, TruthAndBodiesAreOfTheSameInstant) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  DynamicRig rig(held_box("duration: 0.4 s\ntime_step: 250 us\ncontrols: {left: [[0 s, 4 N], [0.4 s, 8 N]], right: 4 N}\n"),
                 folder.file("scene.yaml"));
  constexpr Eigen::Index middle = 4;  // the tallest pillar: its undeformed tip is the origin of the pad frame
  double stiffness = 0.0;
  Pose before;
  for (std::size_t tick = 0; tick < rig->ticks(0); ++tick) {
    rig->step();
    EXPECT_EQ(rig->contact(0).time, static_cast<double>(tick) / 4000.0);
    const Pose& box = rig.body("box").pose;
    const double depth = 0.02 + (box.inverse() * rig.body("left").pose.position).x();
    const double force = rig->contact(0).contact_force(2, middle);
    if (tick == 0) stiffness = force / depth;
    // One tick would make a difference of 0.5 mm/s * 250 us * 7 kN/m, about 1 mN.
    EXPECT_NEAR(force, stiffness * depth, 1e-9);
    if (tick > 0) {
      EXPECT_NEAR((box.position - before.position - 0.00025 * rig.body("box").velocity).norm(), 0.0, 1e-15);
    }
    before = box;
  }
}

TEST(DynamicSimulation, HeldBoxHangsOnItsPadsAndOnNothingElse) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  DynamicRig rig(held_box("duration: 0.6 s\ncontrols: {left: 4 N, right: 4 N}\n"), folder.file("scene.yaml"));
  rig.run();
  EXPECT_EQ(rig->data()->ncon, 0) << "the fingers' boxes overlap nothing, and the pads' bodies meet the box as fields only";
  // +Z of the left site is -x, its x axis is the world's z (zaxis gives the shortest turn).
  const auto force = [&](std::size_t pad) { return rig->contact(pad).force.rowwise().sum().eval(); };
  EXPECT_NEAR(force(0)[2], 4.0, 1e-6);
  EXPECT_NEAR(std::abs(force(0)[0]) + std::abs(force(1)[0]), weight_of_100_g, 1e-6 * weight_of_100_g);
}

// From 0.501 s on the block slides by its momentum: all pillars slip, so the friction is mu_k m g
// for any distribution of loads.
TEST(DynamicSimulation, SlidingBlockSlowsDownAtMuKineticTimesG) {
  const ModelFolder folder;
  folder.write("block.xml", guided_block("integrator='implicitfast'"));
  DynamicRig rig(block_on_table("duration: 0.62 s\nfriction: {static: 0.5, kinetic: 0.4}\n"
                                "controls: {push: [[0.3 s, 0 N], [0.35 s, 8 N], [0.5 s, 8 N], [0.501 s, 0 N]]}\n"),
                 folder.file("scene.yaml"));
  rig.run_to(0.52);
  const double from = rig.body("sole").velocity.x();
  rig.run_to(0.6);
  const double to = rig.body("sole").velocity.x();
  EXPECT_EQ(rig->contact(0).state, PadState::gross);
  EXPECT_NEAR((from - to) / 0.08, 0.4 * g, 1e-4 * 0.4 * g);
}

// The block on an incline of angle a: mg cos a presses it on, mg sin a pulls. mu_k = mu_s, because
// with mu_k < mu_s pillars of unequal load slip one after the other, below mu_s of the whole. tan a
// = mu makes it slip: 0.2 % less does not, 0.2 % more does.
TEST(DynamicSimulation, BlockBreaksLooseOnAnInclineOfMu) {
  for (const double share : {0.998, 1.002}) {
    const double angle = std::atan(share * 0.5);
    const std::string gravity = "gravity='0 0 " + std::to_string(-g * std::cos(angle)) + "'";
    const ModelFolder folder;
    folder.write("block.xml", guided_block(gravity));
    // The pull grows within 1 s, so that nothing bounces.
    DynamicRig rig(
        block_on_table("duration: 4 s\nfriction: {static: 0.5, kinetic: 0.5}\ncontrols: {push: [[0.5 s, 0 N], [1.5 s, " +
                       std::to_string(g * std::sin(angle)) + " N]]}\n"),
        folder.file("scene.yaml"));
    rig.run_to(3.4);  // sticking blocks are at rest by then
    const double from = rig.body("sole").velocity.x();
    rig.run_to(3.9);
    const double gained = rig.body("sole").velocity.x() - from;
    const double expected = share < 1.0 ? 0.0 : 0.5 * g * (std::sin(angle) - 0.5 * std::cos(angle));
    EXPECT_NEAR(gained, expected, 1e-5) << share;  // m/s, of 4.4 mm/s
  }
}

// The pad drags the box at the stage's speed against the friction of the table under both loads.
// The stage reaches 8 mm/s within 0.2 s.
TEST(DynamicSimulation, StageDragsAFreeBoxOverATable) {
  DynamicRig rig(pressed_box("duration: 2 s\nmotion: {compression: 0.8 mm, speed: 8 mm/s, start: 1 s}\n"));
  rig.run_to(1.9);
  const auto force = rig->contact(0).force.rowwise().sum().eval();
  EXPECT_NEAR(rig.body("box").velocity.x(), 0.008, 1e-6);
  EXPECT_NEAR(-force[0], 0.3 * (weight_of_100_g + force[2]), 1e-4 * -force[0]);
  for (int i = 0; i < rig->data()->ncon; ++i) {
    const mjContact& contact = rig->data()->contact[i];
    const int table = mj_name2id(rig->model(), mjOBJ_GEOM, "table"), box = mj_name2id(rig->model(), mjOBJ_GEOM, "box");
    EXPECT_EQ(contact.geom[0], table);
    EXPECT_EQ(contact.geom[1], box);
  }
  EXPECT_GT(rig->data()->ncon, 0);
}

// Implicit fields exclude a noslip pass; bodies on MuJoCo's own contacts must not lose friction
// because of that.
TEST(DynamicSimulation, ImplicitPadDragsABoxAgainstAllOfTheTablesFriction) {
  for (const std::string mass : {"100 g", "5 g"}) {
    std::string scene = pressed_box(
        "field_solver: implicit\ntime_step: 1 ms\nduration: 1.6 s\n"
        "motion: {compression: 0.8 mm, speed: 8 mm/s, start: 1 s}\n");
    scene.replace(scene.find("mass: 100 g"), 11, "mass: " + mass);
    DynamicRig rig(scene);
    rig.run_to(1.4);
    const double weight = mass == "5 g" ? 0.05 * weight_of_100_g : weight_of_100_g;
    double dragged = 0.0, held = 0.0;
    for (int tick = 0; tick < 100; ++tick) {
      rig->step();
      const auto force = rig->contact(0).force.rowwise().sum().eval();
      dragged -= force[0];
      held += 0.3 * (weight + force[2]);
    }
    EXPECT_NEAR(dragged, held, 2e-3 * held) << mass;
  }
}

// At half of the table's friction limit the box must not creep. Limit of the issue for held
// objects: 0.5 um/s.
TEST(DynamicSimulation, BoxOnATableDoesNotCreepUnderAPad) {
  for (const std::string solver : {"explicit", "implicit"}) {
    DynamicRig rig(pressed_box("field_solver: " + solver +
                               "\ntime_step: auto\nduration: 2 s\n"
                               "motion: {compression: 0.8 mm, speed: 1 mm/s, start: 1 s, stop: 0.145 s}\n"));
    rig.run_to(1.3);
    const Eigen::Vector3d before = rig.body("box").pose.position;
    const auto force = rig->contact(0).force.rowwise().sum().eval();
    EXPECT_NEAR(-force[0], 0.5 * 0.3 * (weight_of_100_g + force[2]), 0.1 * -force[0]) << "the drag is what it should be";
    rig.run_to(1.9);
    EXPECT_LT((rig.body("box").pose.position - before).norm() / 0.6, 0.5e-6) << solver;
  }
}

TEST(DynamicSimulation, StageIsWhereItsMotionSaysAtEveryTick) {
  DynamicRig rig(pressed_box(
      "duration: 1.5 s\nmotion: {compression: 0.8 mm, speed: 8 mm/s, rotation: 40 deg/s, pivot: [5 mm, 0 mm], start: 0.5 s, tilt: [1 deg, 0 deg]}\n"));
  const std::unique_ptr<Motion> motion = make_motion(rig.scene(), 0);
  for (std::size_t tick = 0; tick < rig->ticks(0); ++tick) {
    rig->step();
    const BodyState planned = motion->pad_at(static_cast<double>(tick) / std::round(1.0 / rig->time_step(0)));
    const BodyState& actual = rig.body("pad");
    ASSERT_EQ((actual.pose.position - planned.pose.position).norm(), 0.0) << tick;
    // Rounding, because the rotation passes through a quaternion.
    ASSERT_LT((actual.pose.rotation - planned.pose.rotation).norm(), 1e-15) << tick;
    ASSERT_LT((actual.velocity - planned.velocity).norm(), 1e-15) << tick;
    ASSERT_LT((actual.angular_velocity - planned.angular_velocity).norm(), 1e-15) << tick;
  }
  EXPECT_TRUE(rig->rotating());
}

// A fingertip's sensor reads between its units: the pad's truth includes each element's state, and
// the elements' springs add up to its force.
TEST(DynamicSimulation, TellsOfEachElementWhereAPadAsksForIt) {
  DynamicRig rig(
      "duration: 0.5 s\nfriction: {static: 0, kinetic: 0}\nbodies: {table: {shape: plane}}\n"
      "motion: {kind: stage, compression: 1 mm, approach_speed: 20 mm/s}\nsensors: {finger: {type: biotac_sp, touches: [table]}}\n");
  rig.run();
  const ContactFrame& truth = rig->contact(0);
  const auto finger = make_sensor(rig.scene().sensors[0], rig.scene().seed, 0);
  const std::vector<Element>& elements = finger->layout().elements;
  ASSERT_EQ(truth.element_depth.size(), static_cast<Eigen::Index>(elements.size()));
  double force = 0.0;
  for (std::size_t i = 0; i < elements.size(); ++i)
    force += elements[i].k_normal * truth.element_depth[static_cast<Eigen::Index>(i)];
  EXPECT_GT(force, 1.0);
  EXPECT_NEAR(force, truth.contact_force.row(2).sum(), 1e-9 * force);
  // Without friction nothing is dragged, up to the 1e-13 m that do not count as slip
  // (kernel::shortest_slip).
  ASSERT_EQ(truth.element_shear.rows(), truth.element_depth.size());
  EXPECT_LE(truth.element_shear.abs().maxCoeff(), 1e-13);
}

// A box of every shape on a table stays at rest and is recorded.
TEST(DynamicSimulation, EveryShapeComesToRestOnATable) {
  for (const std::string shape :
       {"box, size: [30 mm, 30 mm, 20 mm]", "sphere, radius: 10 mm", "cylinder, radius: 15 mm, length: 20 mm",
        "capsule, radius: 10 mm, length: 30 mm, rotation: [90 deg, 0, 0]", "ellipsoid, size: [40 mm, 30 mm, 20 mm]"}) {
    DynamicRig rig("duration: 0.5 s\nbodies:\n  table: {shape: plane}\n  thing: {shape: " + shape +
                   ", mass: 200 g, position: [0, 0, 0.01]}\nsensors: {pad: {type: papillarray, touches: [thing]}}\n"
                   "motion: {gap: 50 mm, compression: 0.1 mm, start: 40 s}\n");
    rig.run();
    EXPECT_NEAR(rig.body("thing").pose.position.z(), 0.01, 1e-5) << shape;
    EXPECT_NEAR(rig.body("thing").velocity.norm(), 0.0, 1e-6) << shape;
  }
}

// MuJoCo disables sensors only for models without any: a force sensor reads the motor's command.
TEST(DynamicPhysics, SensorsOfTheModelAreRead) {
  const ModelFolder folder;
  std::string fingers = two_fingers("");
  folder.write("bare.xml", fingers);
  folder.write("fingers.xml", fingers.insert(fingers.rfind("</mujoco>"), "<sensor><actuatorfrc actuator='left'/></sensor>"));
  const std::string scene = held_box("duration: 0.1 s\ncontrols: {left: 4 N, right: 4 N}\n");
  DynamicRig rig(scene, folder.file("scene.yaml"));
  rig.run();
  ASSERT_EQ(rig->model()->nsensordata, 1);
  EXPECT_EQ(rig->data()->sensordata[0], 4.0);
  std::string without = scene;
  without.replace(without.find("fingers.xml"), std::string("fingers.xml").size(), "bare.xml");
  DynamicRig bare(without, folder.file("scene.yaml"));
  EXPECT_NE(bare->model()->opt.disableflags & mjDSBL_SENSOR, 0);
}

// A model whose flag disables gravity, and a scene that sets its own.
TEST(DynamicPhysics, GravityIsThatOfMuJoCo) {
  for (const std::string fidelity : {"field", "articulated"}) {
    for (const double g : {0.0, 9.81}) {
      const ModelFolder folder;
      folder.write("fingers.xml", two_fingers("> <flag gravity='disable'/></option><option "));
      DynamicRig rig(held_box("duration: 0.5 s\ncontrols: {left: 4 N, right: 4 N}\nfidelity: " + fidelity +
                              (g > 0.0 ? "\ngravity: 9.81\n" : "\n")),
                     folder.file("scene.yaml"));
      rig.run();
      EXPECT_NEAR(rig->contact(0).force.row(0).sum(), -0.5 * 0.1 * g, 1e-4) << fidelity;
    }
  }
}

// A free body's own velocity with gravity 0: it moves in a straight line.
TEST(DynamicSimulation, BodyStartsWithItsVelocityAndWithoutGravityKeepsIt) {
  DynamicRig rig(
      "duration: 0.5 s\ngravity: 0\nbodies: {ball: {shape: sphere, velocity: [10 mm/s, 0, -20 mm/s], position: [0, 0, -1]}}\n"
      "sensors: {pad: {type: papillarray, touches: [ball]}}\n");
  rig.run_to(0.4);
  EXPECT_NEAR((rig.body("ball").pose.position - Eigen::Vector3d(0.004, 0.0, -1.008)).norm(), 0.0,
              1e-13);  // 400 additions rounded to 1e-16 of 1 m
}

}  // namespace
}  // namespace slipbench

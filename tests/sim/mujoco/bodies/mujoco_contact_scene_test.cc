// `fidelity: mujoco_contact` and `integrator` in scenes whose bodies move by forces.
#include <cmath>

#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"
#include "tests/sim/mujoco/bodies/dynamic_scenes.h"
#include "tests/sim/mujoco/bodies/grasp_rig.h"

namespace slipbench::mujoco_contact_scene_test {
namespace {

// A stable hold: noslip, stiff contacts, and tips heavy enough for their springs, 2/sqrt(7.1 kN/m /
// 10 g) = 2.4 ms.
const std::string careful =
    "fidelity: mujoco_contact\n"
    "contact: {cone: elliptic, noslip: 10, solref: [0.002, 1], solimp: [0.99, 0.999, 0.001], tip_mass: 10 g}\n";

double vertical(const DynamicRig& rig, const ContactFrame& frame, const std::string& pad) {
  return -(rig.body(pad).pose.rotation * frame.force.rowwise().sum().matrix()).z();
}

// Two pads carry m g/2 each, and the box does not sink; with MuJoCo's impratio of 1 and without
// noslip it does. There a tip of 10 g has 2 m impratio/(t_c (1 - d)) >= 1 kN s/m at d = 0.99
// (mujoco_contact_test.cc), reduced by the box's effective mass in the contact; ten tips touch: 100
// g sink by 0.98 N/10 kN s/m = 0.1 mm/s or more.
TEST(MujocoContactScene, HeldBoxCreepsByTheSettings) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  const auto creep = [&](const std::string& contact) {
    DynamicRig rig(held_box(contact + "time_step: 1 ms\nduration: 1 s\ncontrols: {left: 4 N, right: 4 N}\n"),
                   folder.file("scene.yaml"));
    rig.run_to(0.5);
    const double before = rig.body("box").pose.position.z();
    rig.run_to(0.9);
    for (const auto& [index, pad] : {std::pair{0, "left"}, std::pair{1, "right"}}) {
      EXPECT_NEAR(vertical(rig, rig->contact(static_cast<std::size_t>(index)), pad), 0.5 * weight_of_100_g, 1e-3) << pad;
    }
    return (before - rig.body("box").pose.position.z()) / 0.4;
  };
  EXPECT_LT(std::abs(creep(careful)), 1e-6) << "m/s";
  std::string soft = careful;
  soft.replace(soft.find("noslip: 10"), 10, "noslip: 0");
  const double without = creep(soft);
  EXPECT_GT(without, 0.98 / 10e3);
  EXPECT_LT(without, 10.0 * 0.98 / 10e3);
}

// Contacts without a pad are also MuJoCo's: a box on a table, which articulated pads refuse.
TEST(MujocoContactScene, OtherContactsAreAllowed) {
  DynamicRig rig(pressed_box(careful + "time_step: 1 ms\nduration: 1 s\n"));
  const mjModel* m = rig->model();
  EXPECT_EQ(m->geom_solimp[mjNIMP * mj_name2id(m, mjOBJ_GEOM, "box")], 0.99) << "the settings are those of all contacts";
  rig.run_to(0.9);
  EXPECT_NEAR(rig.body("box").pose.position.z(), -0.01, 1e-4);
  EXPECT_NE(rig->contact(0).state, PadState::no_contact);
  EXPECT_GT(rig->contact_normal_force("box", "table"), weight_of_100_g) << "its weight and the pad's press";
}

// RK4 leaves the bodies at its last stage, which the checks must not take for a jump: pads that
// hold, and one that comes down on a box. Explicit tips of 10 g on 7.1 kN/m are stable up to
// 2.8/843 s = 3.3 ms, less with 10 N s/m of damping.
TEST(MujocoContactScene, Rk4HoldsABoxAndPressesOne) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  std::string settings = careful;
  settings.insert(settings.find("cone:"), "integrator: RK4, ");
  DynamicRig held(held_box(settings + "time_step: 0.5 ms\nduration: 1 s\ncontrols: {left: 4 N, right: 4 N}\n"),
                  folder.file("scene.yaml"));
  EXPECT_EQ(held->model()->opt.integrator, mjINT_RK4);
  held.run_to(0.5);
  const double before = held.body("box").pose.position.z();
  held.run();
  EXPECT_LT(std::abs(held.body("box").pose.position.z() - before) / 0.5, 1e-6) << "m/s";
  EXPECT_NEAR(vertical(held, held->contact(0), "left"), 0.5 * weight_of_100_g, 1e-3);

  DynamicRig pressed(pressed_box(settings + "time_step: 0.5 ms\nduration: 1 s\n"));
  pressed.run();
  EXPECT_NE(pressed->contact(0).state, PadState::no_contact);
  EXPECT_NEAR(pressed.body("box").pose.position.z(), -0.01, 1e-4);
}

// A box that begins 2 mm deep in the table leaves it at some 2 mm/t_c = 1 m/s, although nothing has
// given it 50 mJ.
TEST(MujocoContactScene, WatchSeesABoxThrownOutByRk4Too) {
  for (const std::string integrator : {"implicitfast", "RK4"}) {
    std::string scene = pressed_box(careful + "time_step: 0.5 ms\nduration: 1 s\n");
    scene.replace(scene.find("0, 0, -0.01]"), 12, "0, 0, -0.012]");
    scene.insert(scene.find("cone:"), "integrator: " + integrator + ", ");
    DynamicRig rig(scene);
    const std::string said = refusal_of([&] { rig.run(); });
    EXPECT_THAT(said, HasSubstr("body 'box' has ")) << integrator;
    EXPECT_THAT(said, HasSubstr("the contact has thrown it out")) << integrator;
  }
}

// Tips of 0.1 g are stable up to 0.24 ms (mujoco_contact_test.cc): at 1 ms they diverge as soon as
// they are pressed in.
TEST(MujocoContactScene, TipsThatDoNotComeToRestAreSaidToBeThat) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  EXPECT_THAT(refusal_of([&] {
                DynamicRig rig(held_box("fidelity: mujoco_contact\ncontact: {}\ntime_step: 1 ms\nduration: 1 s\n"),
                               folder.file("scene.yaml"));
              }),
              mentions({"tips", "MuJoCo", "Nan, Inf or huge"}));
}

// 10 time constants of 300 s in steps of 1 ms are 3,000,000 steps, and 10 of 2/(0.01 /s) are
// 2,000,000; 100,000 are allowed, those of 10,000 steps.
TEST(MujocoContactScene, RefusesAContactThatTakesTooLongToSettle) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  const auto refusal = [&](const std::string& solref) -> std::string {
    try {
      DynamicRig rig(held_box("fidelity: mujoco_contact\ncontact: {tip_mass: 10 g, solref: " + solref +
                              "}\ntime_step: 1 ms\nduration: 1 s\n"),
                     folder.file("scene.yaml"));
    } catch (const SceneValueError& error) {
      return error.path() == "contact.solref" ? error.what() : "blames " + error.path();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("[300, 1]"), refused_at("contact.solref", {"300 s", "3000000", "1 ms", "100000", "10 s"}));
  EXPECT_THAT(refusal("[-1, -0.01]"), refused_at("contact.solref", {"0.01 /s", "2000000", "1 ms", "100000", "0.2 /s"}));
  EXPECT_EQ(refusal("[1, 1]"), "accepted");
  EXPECT_NE(refusal("[10.001, 1]"), "accepted");
}

class Integrators : public testing::TestWithParam<std::pair<std::string, mjtIntegrator>> {};

// For any model, and no box creeps with any integrator: limit 0.05 um/s.
TEST_P(Integrators, StepTheSceneInPlaceOfTheModels) {
  const auto& [name, integrator] = GetParam();
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(integrator == mjINT_EULER ? "integrator='RK4'" : "integrator='Euler'"));
  DynamicRig rig(held_box("integrator: " + name + "\nduration: 2 s\ncontrols: {left: 4 N, right: 4 N}\n"),
                 folder.file("scene.yaml"));
  EXPECT_EQ(rig->model()->opt.integrator, integrator);
  rig.run_to(1.0);
  const double before = rig.body("box").pose.position.z();
  rig.run_to(1.9);
  EXPECT_LT(std::abs(rig.body("box").pose.position.z() - before) / 0.9, 0.05e-6) << "m/s";
  EXPECT_NEAR(vertical(rig, rig->contact(0), "left"), 0.5 * weight_of_100_g, 1e-6);
}
INSTANTIATE_TEST_SUITE_P(All, Integrators,
                         testing::Values(std::pair{"Euler", mjINT_EULER}, std::pair{"implicit", mjINT_IMPLICIT},
                                         std::pair{"implicitfast", mjINT_IMPLICITFAST}, std::pair{"discrete", mjINT_DISCRETE},
                                         std::pair{"RK4", mjINT_RK4}));

const std::string lift = "box: {mass: 0.2 kg}\nfriction: {static: 0.5, kinetic: 0.5}\nduration: 4 s\n";

// A grasp's forces are all explicit, without damping or constraints: single-stage integrators
// differ only in the rotation of bodies, and none rotates here.
TEST(GraspIntegrators, OfOneStageGiveTheSameLift) {
  const auto slip = [](const std::string& integrator) {
    GraspRig rig(lift + integrator);
    rig.run();
    EXPECT_FALSE(rig->truth().dropped) << integrator;
    return rig->truth().slip.z();
  };
  const double euler = slip("field_solver: explicit\n");
  EXPECT_EQ(slip("integrator: Euler\n"), euler);
  for (const std::string name : {"implicit", "implicitfast", "discrete"}) {
    EXPECT_NEAR(slip("integrator: " + name + "\n"), euler, 1e-9) << name;
  }
}

// The box stands on the table by MuJoCo's contact, is gripped by tips and lifted.
TEST(MujocoContactScene, LiftRunsToItsEndAndHolds) {
  GraspRig rig(
      lift +
      "fidelity: mujoco_contact\ntime_step: 0.5 ms\ncontact: {integrator: discrete, cone: elliptic, noslip: 10, solref: [0.001, 1], solimp: [0.99, 0.999, 0.001], tip_mass: 1 g}\n");
  const double weight = 0.2 * 9.81;
  rig.run_to(0.2);
  EXPECT_NEAR(rig->truth().table_force, weight, 1e-3 * weight);
  EXPECT_EQ(rig->truth().grip_force, 0.0) << "the fingers are open";
  rig.run();
  EXPECT_FALSE(rig->truth().dropped);
  EXPECT_EQ(rig->truth().table_force, 0.0);
  // At rest the pads press equally and carry the weight.
  EXPECT_NEAR(rig->truth().pad_force[0], rig->truth().pad_force[1], 0.02 * rig->truth().pad_force[0]);
  EXPECT_GT(rig->truth().grip_force, 0.5 * weight / 0.5);
  EXPECT_GT(rig->truth().box_height, 0.09);
  EXPECT_LT(rig->truth().slip.norm(), 0.5e-3);
}

// In steady motion an empty finger has no load and moves with its carriage; a spring to the
// carriage's position a step later would make it lead by v h = 21 um. The arm rises at 43 mm/s from
// 1.5 s on, accelerates for 0.11 s at 400 mm/s2, and a finger's springs settle with 0.3 sqrt(15
// N/mm / 80 g) = 130 /s: e^-25 in 0.2 s. Limit: a hundredth of v h.
TEST(MujocoContactScene, LiftDrivesFingersFromWhereTheyAre) {
  const double rising = 43e-3, step = 0.5e-3;
  GraspRig rig(lift + "fidelity: mujoco_contact\ntime_step: 0.5 ms\ncontact: {integrator: discrete, tip_mass: 1 g}\n");
  const auto run_to = [&](double time) {  // without a command to the gripper
    while (rig->truth().time < time - 1e-9) rig->step();
    return (rig.body("arm").pose.inverse() * rig.body("pad").pose).position;
  };
  const Eigen::Vector3d resting = run_to(1.4);
  const double height = rig.body("arm").pose.position.z();
  const Eigen::Vector3d moving = run_to(1.9);
  ASSERT_NEAR(rig.body("arm").pose.position.z() - height, rising * (1.9 - 1.5 - 0.5 * rising / 0.4), 1e-6);
  EXPECT_EQ(rig->truth().grip_force, 0.0);
  EXPECT_LT((moving - resting).norm(), 0.01 * rising * step);
}

// A finger turns on its spring at sqrt(100 N m/(1.2e-4 kg m2)) = 913 rad/s, which allows steps of
// 0.75/913 s = 0.82 ms.
TEST(MujocoContactScene, LiftRefusesAStepThatTheFingersSpringsDoNotBear) {
  EXPECT_THAT(refusal_of([&] { GraspRig rig(lift + "fidelity: mujoco_contact\ntime_step: 1 ms\n"); }),
              refused_at("time_step", {"1 ms", "0.821 ms"}));
}

}  // namespace
}  // namespace slipbench::mujoco_contact_scene_test

// What a scene with bodies is answered when it and its model do not suit each other, before the first step.

#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"
#include "tests/sim/mujoco/bodies/dynamic_scenes.h"

namespace slipbench {
namespace {

std::string answer(const std::string& scene, const std::string& model = two_fingers("")) {
  const ModelFolder folder;
  folder.write("fingers.xml", model);
  return refusal_of([&] { DynamicRig rig(scene, folder.file("scene.yaml")); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

const std::string good = held_box("duration: 0.1 s\n");

TEST(DynamicRefusal, GoodSceneIsTaken) { EXPECT_EQ(answer(good), "accepted"); }

TEST(DynamicRefusal, NamesThatTheModelDoesNotHave) {
  EXPECT_EQ(answer(replaced(good, "site: left_pad", "site: left_pat")),
            "sensors.left.site: the model has no site 'left_pat'; did you mean 'left_pad'? allowed: left_pad, right_pad");
  EXPECT_EQ(answer(replaced(good, "touches: [box]", "touches: [bix]")),
            "sensors.left.touches.0: no geom or body 'bix'; did you mean 'box'? allowed: box, world, left_finger, right_finger");
  EXPECT_EQ(answer(good + "controls: {lift: 4 N}\n"),
            "controls.lift: the model has no actuator 'lift'; did you mean 'left'? allowed: left, right");
  EXPECT_EQ(answer(good + "controls: {left: 21 N}\n"), "controls.left: 21 is beyond the actuator's range; allowed: 0 to 20");
  EXPECT_EQ(answer(replaced(good, "touches: [box]", "touches: [left_finger]")),
            "sensors.left.touches: the pad is mounted on a body that it touches; allowed: other bodies");
  EXPECT_EQ(answer(replaced(good, "{box: {shape", "{left_finger: {shape")),
            "bodies.left_finger: the model has a body or geom of this name already; allowed: another name");
  EXPECT_EQ(answer(replaced(good, "position: [0, 0, 0.1]", "free: false, velocity: [1, 0, 0]")),
            "bodies.box.velocity: the body is not free; allowed: no velocity");
}

TEST(DynamicRefusal, ModelsThatCannotBeRead) {
  EXPECT_THAT(answer(replaced(good, "fingers.xml", "fingres.xml")), EndsWith("fingres.xml' cannot be read"));
  EXPECT_THAT(answer(good, "<mujoco><worldbody><geom tipe='box'/></worldbody></mujoco>"),
              AllOf(StartsWith("model: MuJoCo cannot read it: "), HasSubstr("tipe"), HasSubstr("Element 'geom', "),
                    HasSubstr("fingers.xml:1")));
  EXPECT_THAT(answer(good, replaced(two_fingers(""), "type='slide'",
                                    "type='hinge' springref='1' stiffness='1' range='1 -1' limited='true'")),
              StartsWith("model: MuJoCo cannot compile it: "));
}

// The pads' 9 pillars have 64 kN/m together, and a box of 5 g between two of them vibrates at sqrt(2 * 64e3/0.005) = 5060 rad/s at
// least; fingers of 50 g hardly change that, so the dashpots of 1 ms bear no step over 1/(1e-3 s * 5060^2/s2) = 39 us.
TEST(DynamicRefusal, StepTooLongForExplicitSprings) {
  const std::string light = replaced(good, "mass: 100 g", "mass: 5 g");
  const std::string text = answer(light + "time_step: 1 ms\n");
  EXPECT_THAT(text, StartsWith("time_step: 1 ms is too long for explicit springs of the pads"));
  const std::string allowed = text.substr(text.find("allowed are up to ") + 18);
  EXPECT_LT(parse_quantity(allowed, Quantity::time), 39e-6);
  // What the message allows is allowed; 20 us divides 1 ms.
  EXPECT_GT(parse_quantity(allowed, Quantity::time), 5e-6);
  EXPECT_EQ(answer(light + "time_step: 5 us\n"), "accepted");
}

TEST(DynamicRefusal, AutomaticStepIsTheLongestThatFits) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  DynamicRig rig(good, folder.file("scene.yaml"));
  const double divisor = 1e-3 / rig->time_step(0);
  EXPECT_NEAR(divisor, std::round(divisor), 1e-9);
  // One divisor less would be a longer step: it is refused.
  EXPECT_THAT(answer(good + "time_step: " + std::to_string(1.0 / (std::round(divisor) - 1.0)) + " ms\n"),
              HasSubstr("too long for explicit springs"));
}

}  // namespace
}  // namespace slipbench

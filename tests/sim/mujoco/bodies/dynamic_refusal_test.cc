// Errors before the first step for scenes that do not fit their model.

#include <filesystem>

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
  EXPECT_THAT(answer(replaced(good, "site: left_pad", "site: left_pat")),
              refused_at("sensors.left.site", {"left_pat", "left_pad"}));
  EXPECT_THAT(answer(replaced(good, "touches: [box]", "touches: [bix]")), refused_at("sensors.left.touches.0", {"bix", "box"}));
  EXPECT_THAT(answer(good + "controls: {lift: 4 N}\n"), refused_at("controls.lift", {"lift", "left"}));
  EXPECT_THAT(answer(good + "controls: {left: 21 N}\n"), refused_at("controls.left", {"21", "0", "20"}));
  EXPECT_THAT(answer(replaced(good, "touches: [box]", "touches: [left_finger]")),
              refused_at("sensors.left.touches", {"pad", "body"}));
  EXPECT_THAT(answer(replaced(good, "{box: {shape", "{left_finger: {shape")), refused_at("bodies.left_finger", {"body", "geom"}));
  EXPECT_THAT(answer(replaced(good, "position: [0, 0, 0.1]", "free: false, velocity: [1, 0, 0]")),
              refused_at("bodies.box.velocity", {"body", "free"}));
}

TEST(DynamicRefusal, ModelsThatCannotBeRead) {
  EXPECT_THAT(answer(replaced(good, "fingers.xml", "fingres.xml")), mentions({"fingres.xml"}));
  EXPECT_THAT(answer(good, "<mujoco><worldbody><geom tipe='box'/></worldbody></mujoco>"),
              AllOf(StartsWith("model: MuJoCo cannot read the model: "), HasSubstr("tipe"), HasSubstr("Element 'geom', "),
                    HasSubstr("fingers.xml:1")));
  EXPECT_THAT(answer(good, replaced(two_fingers(""), "type='slide'",
                                    "type='hinge' springref='1' stiffness='1' range='1 -1' limited='true'")),
              refused_at("model", {"compile"}));
}

// MuJoCo itself takes NaN, with a warning that it would write into MUJOCO_LOG.TXT here.
TEST(DynamicRefusal, ModelsWithNan) {
  const std::string model = two_fingers("");
  for (const std::string mass : {"nan", "NaN", " nan "}) {
    const std::string bad =
        replaced(model, "</worldbody>", "<body name='nan'><geom size='1' mass='" + mass + "'/></body></worldbody>");
    EXPECT_THAT(answer(good, bad), AllOf(refused_at("model", {"fingers.xml:1", "<geom>", "mass", "finite"}), HasSubstr(mass)));
  }
  EXPECT_EQ(answer(good, replaced(model, "</worldbody>", "<body name='nan'/></worldbody>")), "accepted");
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
}

// The pads' 9 pillars have 64 kN/m together, and a box of 5 g between two of them vibrates at
// sqrt(2 * 64e3/0.005) = 5060 rad/s or more; fingers of 50 g hardly change that. With dashpots of 1
// ms no step over 1/(1e-3 s * 5060^2/s2) = 39 us is stable.
TEST(DynamicRefusal, StepTooLongForExplicitSprings) {
  const std::string light = replaced(good, "mass: 100 g", "mass: 5 g");
  const std::string text = answer(light + "time_step: 1 ms\n");
  EXPECT_THAT(text, StartsWith("time_step: 1 ms is too long for explicit springs of the pads"));
  const std::string allowed = text.substr(text.find("allowed: up to ") + std::string_view("allowed: up to ").size());
  EXPECT_LT(parse_quantity(allowed, Quantity::time), 39e-6);
  // The step that the message allows is accepted; 20 us divides 1 ms.
  EXPECT_GT(parse_quantity(allowed, Quantity::time), 5e-6);
  EXPECT_EQ(answer(light + "time_step: 5 us\n"), "accepted");
}

TEST(DynamicRefusal, AutomaticStepIsTheLongestThatFits) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  DynamicRig rig(good, folder.file("scene.yaml"));
  const double divisor = 1e-3 / rig->time_step(0);
  EXPECT_NEAR(divisor, std::round(divisor), 1e-9);
  // One divisor less gives a longer step, which is refused.
  EXPECT_THAT(answer(good + "time_step: " + std::to_string(1.0 / (std::round(divisor) - 1.0)) + " ms\n"),
              mentions({"explicit springs"}));
}

}  // namespace
}  // namespace slipbench

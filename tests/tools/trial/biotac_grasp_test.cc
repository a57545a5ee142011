// Grasps with three BioTac SP, scenes/biotac_sp/grasp.yaml: invariants of the file, and how a grasp
// ends.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/scenes.h"
#include "tools/trial/run_trial.h"

namespace slipbench::biotac_grasp_test {
namespace {

const Parameters& body_of(const Scene& scene, const std::string& name) {
  return std::ranges::find(scene.bodies, name, &BodyScene::name)->shape.parameters;
}

TEST(BioTacGrasps, StandOnTheTableInFrontOfTheThumb) {
  const TrialPlan plan(shipped("biotac_sp/grasp.yaml"), catalogues(), 20, 1);  // for each palm in each of three sessions
  std::map<std::string, int> models;
  std::set<std::string> shapes;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const Scene scene = plan.trial(i).scene;
    ++models[scene.model.substr(scene.model.rfind('/') + 1)];
    ASSERT_EQ(scene.sensors.size(), 3u);
    std::set<std::string> names;
    for (const SensorScene& sensor : scene.sensors) {
      EXPECT_EQ(sensor.type, "biotac_sp");
      EXPECT_EQ(sensor.parameters.choice("device"), "fixed");
      EXPECT_EQ(sensor.parameters.integer("device_number"), scene.sensors[0].parameters.integer("device_number")) << "a session";
      names.insert(sensor.name);
    }
    EXPECT_EQ(names, (std::set<std::string>{"ff", "mf", "th"}));

    const auto object = std::ranges::find(scene.bodies, "object", &BodyScene::name);
    const Parameters& values = object->shape.parameters;
    shapes.insert(object->shape.name);
    const bool sized = object->shape.name == "box" || object->shape.name == "ellipsoid";
    const double across = sized ? values.vector("size")[1] : 2.0 * values.number("radius");
    const double high = sized ? values.vector("size")[2] : object->shape.name == "sphere" ? across : values.number("length");
    EXPECT_NEAR(values.vector("position")[1] - 0.5 * across, -25e-3, 1e-9) << "the face that the thumb meets";
    EXPECT_NEAR(body_of(scene, "table").vector("position")[2], -0.5 * high, 1e-9);
  }
  EXPECT_EQ(models, (std::map<std::string, int>{{"hand_45.xml", 60}, {"hand_down.xml", 60}, {"hand_side.xml", 60}}));
  EXPECT_EQ(shapes, (std::set<std::string>{"box", "cylinder", "ellipsoid", "sphere"}));
}

// Returns how it ended when both fingers together press the object with `force` [N].
HoldOutcome hold_at(double force) {
  SceneFile file = shipped("biotac_sp/grasp.yaml");
  file.apply({"sweep", "{}"});
  file.apply({"bodies.object.mass", "400 g"});
  file.apply({"controls.first", "[[0.7 s, 0.5 N], [1.1 s, " + std::to_string(0.5 * force) + " N]]"});
  file.apply({"controls.middle", "[[0.7 s, 0.5 N], [1.1 s, " + std::to_string(0.5 * force) + " N]]"});
  return *run_trial(parsed(file), 0, Recording::outcome).record.outcome.hold;
}

TEST(BioTacGrasps, HoldFromTheForceOnThatCarriesTheWeight) {
  // 400 g between a thumb and two fingers that press equally: F = m g/(2 mu_s) = 6.54 N with mu_s
  // 0.3 holds it at rest. But the lift starts at 20 mm/s and continues at v = 60 mm/s, each reached
  // within some 10 ms, 2 to 4 m/s2, for which 1.2 to 1.4 F would be needed: it slips. A slip has
  // mu_k = 0.28: below mu_s/mu_k = 1.07 F the weight exceeds the friction, and the object stays on
  // the table, 40 mm behind, within the lift's own millimetre. Sideways it may move by at most the
  // fingers' travel, 2 x 6 mm, once they have left its top.
  constexpr double across = 12e-3, mass = 0.4, g = 9.81, mu_s = 0.3, mu_k = 0.28, v = 60e-3;
  constexpr double force = mass * g / (2.0 * mu_s);
  const HoldOutcome lost = hold_at(1.02 * force);
  EXPECT_FALSE(lost.held);
  EXPECT_GE(lost.moved, 39e-3);
  EXPECT_LT(lost.moved, std::hypot(41e-3, across));
  // Above, the object accelerates with a = (share mu_k/mu_s - 1) g until it is as fast as the
  // thumb. Its lag is largest if it has to reach all of v at once, v^2/(2 a) = 1.53 mm at 1.2 F,
  // plus the skin's stretch, m g/(2 k_t) = 0.49 mm with k_t of some 4 N/mm per side.
  constexpr double share = 1.2, a = (share * mu_k / mu_s - 1.0) * g, k_t = 4e3;
  const HoldOutcome held = hold_at(share * force);
  EXPECT_TRUE(held.held);
  EXPECT_LT(held.moved, v * v / (2.0 * a) + mass * g / (2.0 * k_t));
}

}  // namespace
}  // namespace slipbench::biotac_grasp_test

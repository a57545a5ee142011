#include "tools/trial/recorded_scene.h"

#include "sim/motion/motion_catalogue.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench {
namespace {

using Swept = std::vector<std::pair<std::string, std::string>>;

constexpr const char* text = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

TEST(Experiment, IsWhatChangesTheContact) {
  const Scene scene = parsed(text);
  const std::string slow = experiment_of(scene, {{"motion.speed", "0.004"}});
  EXPECT_NE(slow, "");
  EXPECT_EQ(experiment_of(scene, {{"motion.speed", "0.004"}}), slow);
  EXPECT_NE(experiment_of(scene, {{"motion.speed", "0.008"}}), slow);
  // How the contact is read or computed does not distinguish experiments.
  for (const char* key : {"sensors.pad.rate", "sensors.pad.electronics", "sensors.pad.electronics.0", "detector", "detector.type",
                          "time_step", "fidelity", "seed", "duration"}) {
    EXPECT_EQ(experiment_of(scene, {{"motion.speed", "0.004"}, {key, "1"}}), slow) << key;
  }
  for (const char* key : {"sensors.pad.bristles", "surface.material", "effects", "sensors.pad.rates"})
    EXPECT_NE(experiment_of(scene, {{"motion.speed", "0.004"}, {key, "1"}}), slow) << key;
}

// The detector of a controlled grasp changes the forces.
TEST(Experiment, OfAControlledGraspIncludesItsDetector) {
  const std::string grasp =
      std::string(text) + "box: {mass: 100 g}\ndetector: {type: force_ratio}\ncontroller: {type: step_on_slip}\n";
  const Scene scene = parsed(grasp);
  EXPECT_NE(experiment_of(scene, {{"detector.type", "1"}}), experiment_of(scene, {{"detector.type", "2"}}));
  EXPECT_EQ(experiment_of(parsed(grasp + "scatter: {yaw: 1 deg}\n"), {}), "");
  EXPECT_EQ(experiment_of(parsed(grasp + "grip: {drift: 0.1 mm}\n"), {}), "");
}

// One contact that is read at two rates has two digests, but the same swept values. Without such a
// key the digest decides: trials with equal values may differ by an effect's random numbers.
TEST(Experiment, IsKnownByItsTruth) {
  const Scene scene = parsed(text);
  EXPECT_THAT(experiments_of(scene, {{"motion.speed", "0.004"}}, "d"), ::testing::ElementsAre("truth d"));
  EXPECT_THAT(experiments_of(scene, {}, ""), ::testing::IsEmpty());
  const auto slow = experiments_of(scene, {{"motion.speed", "0.004"}, {"sensors.pad.rate", "1"}}, "d");
  const auto slow_again = experiments_of(scene, {{"motion.speed", "0.004"}, {"sensors.pad.rate", "2"}}, "e");
  ASSERT_EQ(slow.size(), 2U);
  EXPECT_EQ(slow[1], slow_again[1]);
}

// Version 0.3.0 wrote scenes with the key `accuracy` and the override that removed it.
TEST(RecordedScene, WithARequiredAccuracyIsRead) {
  const std::string accurate = std::string(text) + "accuracy: {onset: 1 %}\n";
  for (const Json& overrides : {Json{{"accuracy", "none"}, {"time_step", "10 ms"}}, Json{{"time_step", "10 ms"}}}) {
    const SceneFile file = recorded_file(accurate, overrides, "old.h5");
    EXPECT_EQ(parse_scene(file, program_catalogues()).time_step, 0.01);
  }
}

// A motion that draws its path has no repeats: two trials are at different places at some time.
TEST(Experiment, OfADrawnMotionIsUnique) {
  for (const MotionKind& kind : motion_catalogue()) {
    Parameters parameters = defaults_of(kind.about.parameters);
    if (kind.about.name == "rub") parameters.set("speed", 0.01);
    const auto one = kind.create(parameters, {.seed = 1, .trial = 1}), other = kind.create(parameters, {.seed = 1, .trial = 2});
    bool drawn = false;
    for (int k = 0; k < 200 && !drawn; ++k) {
      const double time = 0.02 * k;
      const Pose here = one->pad_at(time).pose, there = other->pad_at(time).pose;
      drawn = !here.position.isApprox(there.position, 1e-9) || !here.rotation.isApprox(there.rotation, 1e-9);
    }
    Scene scene = parsed(text);
    scene.motion = {kind.about.name, parameters};
    EXPECT_EQ(experiment_of(scene, {}).empty(), drawn) << kind.about.name;
  }
}

}  // namespace
}  // namespace slipbench

// The controller that follows a target force.
#include <gtest/gtest.h>

#include "tests/controllers/rig.h"

namespace slipbench::controllers {
namespace {

// 3 N on the pad, assumed mu 0.5, margin 0.8: 3/(0.5 * 0.8) = 7.5 N, for which counts of 1.2 N give
// 8.4 N. Without load the target is the preset, 4.8 N, which holds the load in the meantime because
// the real mu is 0.8.
TEST(ForceRatio, GripsInProportionToTheLoad) {
  ToyPlant plant;
  plant.load = 6.0;
  plant.load_from = 30;
  plant.mu = 0.8;
  const auto history = plant.run(*make("force_ratio", {{"mu", "0.5"}, {"margin", "0.8"}, {"force_per_count", "1.2 N"}}), 100);
  for (std::size_t tick = 0; tick < 100; ++tick) {
    EXPECT_EQ(history[tick].command, tick < 30 ? 14 : 17) << "update " << tick;  // ceil(4/1.2) = 4, then ceil(2.7/1.2) = 3
  }
  EXPECT_DOUBLE_EQ(plant.grip(), 7 * 1.2);
}

// Counts of 0.4 N that the controller takes for 1.6 N: ceil((4 - F)/1.6) counts at a time, 0 + 3, 3
// + 2, then single ones up to 10.
TEST(ForceRatio, ReachesTheTargetFromBelowWhereACountIsWorthLess) {
  ToyPlant plant;
  plant.per_count = 0.4;
  plant.run(*make("force_ratio"), 200);
  EXPECT_EQ(plant.position, 20);
}

// Beyond the friction limit the measured load is mu F = 0.3 F, for which 0.3 F/(0.5 * 0.8) = 0.75 F
// would suffice.
TEST(ForceRatio, DropsTheBoxWhenItBelievesInTooMuchFriction) {
  ToyPlant plant;
  plant.load = 6.0;
  plant.load_from = 30;
  plant.mu = 0.3;
  plant.run(*make("force_ratio", {{"mu", "0.5"}, {"margin", "0.8"}}), 200);
  EXPECT_FALSE(plant.holds());
  EXPECT_DOUBLE_EQ(plant.grip(), 4.8);
}

// Seven pillars of 1 N and 0.1 N, one of 0.5 N and 0.3 N, one of 0.04 N and 0.04 N, which does not
// count as touching. largest: F = 7.54 N, ratio 0.6, target 7.54 * 0.6/0.4 = 11.31 N:
// ceil(3.77/1.6) = 3 counts. sum: 1.04 N, target 1.04/0.4 = 2.6 N, below the preset of 4 N: no
// counts.
TEST(ForceRatio, TakesTheLargestRatioOrTheSum) {
  PillarFrame frame = PillarFrame::of_forces(9.0, 0.9);
  frame.set_force(3, 0.5, 0.3);
  frame.set_force(7, 0.04, 0.04);
  for (const auto& [ratio, position] : {std::pair{"largest", 33}, std::pair{"sum", 30}}) {
    const auto controller = make("force_ratio", {{"ratio", ratio}, {"mu", "0.5"}, {"margin", "0.8"}});
    EXPECT_EQ(controller->update(input_of(frame, 30)).position, position) << ratio;
  }
}

// The ratio asks for 1000 N. From 4.8 N a ceiling of 11 N leaves floor(6.2/1.2) = 5 counts: 10.8 N.
TEST(ForceRatio, NeverExceedsTheCeiling) {
  ToyPlant plant;
  plant.load = 800.0;
  plant.load_from = 30;
  plant.mu = 2000.0;
  const auto history =
      plant.run(*make("force_ratio", {{"mu", "0.5"}, {"margin", "0.8"}, {"force_per_count", "1.2 N"}, {"ceiling", "11 N"}}), 100);
  double most = 0.0;
  for (const ToyPlant::Update& update : history) most = std::max(most, update.force);
  EXPECT_DOUBLE_EQ(most, 9 * 1.2);
}

// The grip is 10.3 N, the target 4 N, a count 1.2 N: floor(6.3/1.2) = 5 counts are too many.
TEST(ForceFollower, OpensOnlyWhenTold) {
  const PillarFrame tight = PillarFrame::of_forces(10.3);
  EXPECT_EQ(make("force_ratio", {{"force_per_count", "1.2 N"}})->update(input_of(tight, 30)).position, 30);
  const auto loose = make("force_ratio", {{"force_per_count", "1.2 N"}, {"loosen", "true"}});
  EXPECT_EQ(loose->update(input_of(tight, 30)).position, 25);
  EXPECT_EQ(loose->update(input_of(PillarFrame::of_forces(9.1), 29)).position, 25);  // in motion: floor(5.1/1.2) = 4 of 29
  EXPECT_EQ(loose->update(input_of(PillarFrame::of_forces(5.1), 26)).position, 25);  // less than a count too much: unchanged
  EXPECT_EQ(loose->update(input_of(PillarFrame::of_forces(3.9), 24)).position, 25);
  EXPECT_EQ(loose->update(input_of(PillarFrame::of_forces(3.9), 20)).position, 21);  // from where the fingers are
}

TEST(ForceFollower, TakesBackNoCountThatIsOnItsWay) {
  const auto controller = make("force_ratio");
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(1.0), 30)).position, 32);  // ceil(3/1.6) = 2
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(3.9), 30)).position, 32);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(4.1), 31)).position, 32);
}

TEST(ForceFollower, StaysClosedAtTheLastPosition) {
  EXPECT_EQ(make("force_ratio")->update(input_of(PillarFrame::of_forces(0.0), 254)).position, 255);
  EXPECT_EQ(make("force_ratio")->update(input_of(PillarFrame::of_forces(0.0), 255)).position, 255);
  EXPECT_EQ(make("force_ratio", {{"loosen", "true"}})->update(input_of(PillarFrame::of_forces(50.0), 3)).position, 0);
}

}  // namespace
}  // namespace slipbench::controllers

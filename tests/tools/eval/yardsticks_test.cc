#include "tools/eval/yardsticks.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/expect.h"
#include "tools/eval/replay.h"

namespace slipbench::eval::yardsticks_test {
namespace {

constexpr double rate = 10.0;  // Hz; the window of 0.5 s holds 5 samples

// Values 0, a, 0, a, ... In any 5 of them the mean is 2/5 a or 3/5 a and the variance 6/25 a2, so
// that the standard deviation is a sqrt(6)/5.
double deviation_of(double amplitude) { return amplitude * std::sqrt(6.0) / 5.0; }

// 20 samples of one value, which slip in all of them or in none.
RecordedTrial trial(std::size_t number, double amplitude, bool slips) {
  RecordedTrial result;
  result.record.trial = number;
  SensorRecord& sensor = result.sensors.emplace_back();
  sensor.name = "pad";
  sensor.rate = rate;
  sensor.labels.truth = false;
  SensorColumn values{"force", "N", {1}, {}};
  for (int row = 0; row < 20; ++row) {
    sensor.time.push_back(row / rate);
    values.values.push_back(row % 2 == 0 ? 0.0F : static_cast<float>(amplitude));
    sensor.labels.state_paper.push_back(static_cast<std::uint8_t>(slips ? PadState::gross : PadState::non_slip));
  }
  sensor.channels.push_back(std::move(values));
  return result;
}

void add(YardstickScores& scores, const RecordedTrial& one, const std::string& twin, const std::string& object = "") {
  scores.add(one, one.truth(LabelRule::recorded), twin, object);
}

// In half 0 slips have the amplitude 2, in half 1 the amplitude 4, all others 1. All samples of a
// slip have one score and all others a smaller one, so any threshold between the two is best in a
// half, and the middle is chosen: (2 + 1)/2 and (4 + 1)/2. A trial gets that of the other half.
TEST(Yardsticks, ThresholdsComeFromTheOtherHalf) {
  YardstickScores scores;
  add(scores, trial(0, 2.0, true), "a");
  add(scores, trial(1, 4.0, true), "b");
  add(scores, trial(2, 1.0, false), "c");
  add(scores, trial(3, 1.0, false), "d");
  const ChosenYardstick best = scores.best().value();
  EXPECT_TRUE(best.by_halves);
  EXPECT_EQ(best.detector.type, "deviation") << "the first of those with the greatest area";
  EXPECT_EQ(best.part, (std::vector<std::size_t>{0, 1, 0, 1}));
  ASSERT_EQ(best.thresholds.size(), 2U);
  // float32 values and sums over a window
  EXPECT_NEAR(best.thresholds[0], deviation_of(2.5), 1e-5);
  EXPECT_NEAR(best.thresholds[1], deviation_of(1.5), 1e-5);
  EXPECT_EQ(best.areas.at("deviation").value, 1.0);
  // The mean alternates as the values do, so relative_deviation does not depend on the amplitude
  // and its two values occur equally often in both classes.
  EXPECT_NEAR(best.areas.at("relative_deviation").value, 0.5, 0.1);
  EXPECT_THAT(best.left_out.at("shear_ratio"), mentions({"three axes", "force"}));
}

// Trials that share the true forces are one experiment and belong to one half.
TEST(Yardsticks, TwinsAreInTheSameHalf) {
  YardstickScores scores;
  for (const auto& [number, twin] : std::vector<std::pair<std::size_t, std::string>>{{0, "a"}, {1, "a"}, {2, "b"}, {3, "b"}})
    add(scores, trial(number, number % 2 == 0 ? 2.0 : 1.0, number % 2 == 0), twin);
  EXPECT_EQ(scores.best().value().part, (std::vector<std::size_t>{0, 0, 1, 1}));
}

// Recordings of one object are in one half, whatever their experiments are.
TEST(Yardsticks, RecordingsOfAnObjectAreInTheSameHalf) {
  YardstickScores scores;
  add(scores, trial(0, 2.0, true), "", "mug");
  add(scores, trial(1, 1.0, false), "", "mug");
  add(scores, trial(2, 3.0, true), "", "box");
  add(scores, trial(3, 1.0, false), "", "box");
  const ChosenYardstick best = scores.best().value();
  EXPECT_EQ(best.part, (std::vector<std::size_t>{0, 0, 1, 1}));
  EXPECT_NEAR(best.thresholds[0], deviation_of(2.0), 1e-5) << "the middle of 3 and 1";
  EXPECT_NEAR(best.thresholds[1], deviation_of(1.5), 1e-5) << "the middle of 2 and 1";
}

// A threshold separates the samples that it was chosen on, whatever the rounding of their scores.
TEST(Yardsticks, AChosenThresholdAcceptsTheSamplesThatChoseIt) {
  for (int step = 1; step <= 60; ++step) {
    const double amplitude = 1.0 + 0.27 * step;
    YardstickScores scores;
    for (const std::size_t number : {0U, 1U}) add(scores, trial(number, amplitude, true), number == 0 ? "a" : "b");
    for (const std::size_t number : {2U, 3U}) add(scores, trial(number, 1.0, false), number == 2 ? "c" : "d");
    const ChosenYardstick best = scores.best().value();
    const RecordedTrial slip = trial(0, amplitude, true);
    const Replayed replayed = replay(with_yardstick_threshold(best.detector, best.thresholds[0]), slip.sensors, 0, 0, 0);
    EXPECT_EQ(replayed.seen.back(), PadState::gross) << amplitude;
  }
}

// With one experiment the threshold is chosen on it, and the result says so.
TEST(Yardsticks, OneThresholdIfAHalfHasOneClass) {
  YardstickScores scores;
  add(scores, trial(0, 2.0, true), "a");
  add(scores, trial(1, 1.0, false), "b");
  const ChosenYardstick best = scores.best().value();
  EXPECT_FALSE(best.by_halves);
  ASSERT_EQ(best.thresholds.size(), 1U);
  EXPECT_NEAR(best.thresholds[0], deviation_of(1.5), 1e-5);
  EXPECT_EQ(best.part, (std::vector<std::size_t>{0, 0}));
}

TEST(Yardsticks, NoneWithoutBothClasses) {
  YardstickScores scores;
  add(scores, trial(0, 2.0, true), "a");
  add(scores, trial(1, 4.0, true), "b");
  EXPECT_FALSE(scores.best().has_value());
  EXPECT_FALSE(YardstickScores().best().has_value());
}

// s/(s + t) = p at s = t p/(1 - p).
TEST(Yardsticks, ScoreOfAProbability) {
  const DetectorScene yardstick = with_yardstick_threshold(chosen_detector("deviation", {}), 3.0);
  EXPECT_EQ(yardstick_score(yardstick, 0.5), 3.0);
  EXPECT_NEAR(yardstick_score(yardstick, 0.75), 9.0, 1e-14);
  EXPECT_TRUE(std::isinf(yardstick_score(yardstick, 1.0)));
}

}  // namespace
}  // namespace slipbench::eval::yardsticks_test

#include "tools/train/network/operating_point.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tools/train/network/examples.h"

namespace slipbench::train::operating_point_test {
namespace {

constexpr double period = 0.1;  // s: 600 frames a minute

// 100 frames of hold at .2, every tenth a single one at .9, and 20 frames of slip at .8.
std::vector<SlipSeries> spiky() {
  SlipSeries series;
  for (int t = 0; t < 120; ++t) {
    series.truth.push_back(t < 100 ? 0 : 1);
    series.probability.push_back(t >= 100 ? 0.8 : t % 10 == 5 ? 0.9 : 0.2);
  }
  return {series};
}

// 10 alarms in 10 s of hold are 60 per minute. A masked frame counts nowhere, and an alarm that
// began in it is not false.
TEST(AlarmCounts, AreOfAlarmsThatBeginInHold) {
  std::vector<SlipSeries> series = spiky();
  EXPECT_EQ(counts_at(series, period, 0.5, {}).false_alarms, 10U);
  EXPECT_DOUBLE_EQ(counts_at(series, period, 0.5, {}).alarms_per_minute(period), 60.0);
  EXPECT_DOUBLE_EQ(balanced_slip_accuracy(counts_at(series, period, 0.5, {}).frames), 0.5 * (1.0 + 0.9));
  series[0].truth[5] = masked;
  EXPECT_EQ(counts_at(series, period, 0.5, {}).false_alarms, 9U);
  EXPECT_TRUE(std::isnan(counts_at({}, period, 0.5, {}).alarms_per_minute(period)));
}

// Above .8 nothing is slip, so no threshold limits the alarms: two consecutive frames do, at the
// cost of the slip's first frame.
TEST(OperatingPoint, TakesFramesInARowWhereNoThresholdWillDo) {
  const OperatingPoint point = best_point(spiky(), period, 1.0);
  EXPECT_EQ(point.alarm.on, 2U);
  EXPECT_DOUBLE_EQ(point.threshold, 0.5);  // between hold's .2 and slip's .8
  EXPECT_EQ(point.alarms_per_minute, 0.0);
  EXPECT_DOUBLE_EQ(balanced_slip_accuracy(counts_at(spiky(), period, point.threshold, point.alarm).frames), 0.5 * (1.0 + 0.95));
}

TEST(OperatingPoint, HasNoMoreAlarmsThanAreBorneAndUsesThem) {
  const OperatingPoint none = best_point(spiky(), period, 0.0), all = best_point(spiky(), period, 60.0);
  EXPECT_EQ(none.alarms_per_minute, 0.0);
  EXPECT_LE(all.alarms_per_minute, 60.0);
  EXPECT_GE(balanced_slip_accuracy(counts_at(spiky(), period, all.threshold, all.alarm).frames),
            balanced_slip_accuracy(counts_at(spiky(), period, none.threshold, none.alarm).frames));
}

// 60 frames of hold at .1, slip at .6, .6, .9, .9, and another 60 of hold with a spike of .7. At .5
// the first slip is detected at once (credit 1) and the spike is the only alarm in 12 s of hold, 5
// per minute: 1/5 minus 1/120. At .8, between .7 and .9, the slip is detected .2 s late, T/(T + .2
// s) = 1/3, without an alarm.
TEST(OperatingPoint, OfTheGreatestScoreWeighsDelayAgainstAlarms) {
  SlipSeries slip{std::vector<double>(60, 0.1), std::vector<std::uint8_t>(60, 0)};
  SlipSeries hold = slip;
  hold.probability[30] = 0.7;
  slip.probability.insert(slip.probability.end(), {0.6, 0.6, 0.9, 0.9});
  slip.truth.insert(slip.truth.end(), 4, 1);
  const std::vector<SlipSeries> series{slip, hold};
  EXPECT_DOUBLE_EQ(counts_at(series, period, 0.5, {}).score(period), 1.0 / 5.0 - 1.0 / 120.0);
  EXPECT_DOUBLE_EQ(counts_at(series, period, 0.8, {}).score(period), 1.0 / 3.0);
  const OperatingPoint point = best_point(series, period, std::nullopt);
  // Two consecutive frames at .5 skip the spike and detect the slip .1 s late, which earns 1/2.
  EXPECT_EQ(point.alarm.on, 2U);
  EXPECT_DOUBLE_EQ(counts_at(series, period, point.threshold, point.alarm).score(period), 0.5);
  slip.probability[59] = 0.9;  // reported before it slips: nothing is earned
  EXPECT_LT(counts_at(std::vector{slip}, period, 0.8, {}).score(period), 0.0);
}

// Hold .1 .3, slip .2 .7: at .5 half of slip and all of hold are right; at .15 all of slip, half of
// hold; the threshold nearer to 1/2 is used.
TEST(OperatingPoint, MostAccurateIsTheMiddleNearestToAHalf) {
  const std::vector<SlipSeries> series{{{0.1, 0.2, 0.3, 0.7}, {0, 1, 0, 1}}};
  EXPECT_DOUBLE_EQ(most_accurate_point(series, period).threshold, 0.5);
  EXPECT_EQ(most_accurate_point(series, period).alarm.on, 1U);
  const std::vector<SlipSeries> hold{{{0.1, 0.2}, {0, 0}}};
  EXPECT_EQ(best_point(hold, period, 1.0).threshold, 0.5);
  const std::vector<SlipSeries> snapshots{{{0.3}, {0}}, {{0.4}, {1}}};  // without duration
  EXPECT_DOUBLE_EQ(best_point(snapshots, period, 1.0).threshold, 0.35);
}

}  // namespace
}  // namespace slipbench::train::operating_point_test

#include "tools/train/network/operating_point.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sim/core/error.h"
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
  EXPECT_EQ(counts_at(series, 0.5, {}).false_alarms, 10U);
  EXPECT_DOUBLE_EQ(counts_at(series, 0.5, {}).alarms_per_minute(period), 60.0);
  EXPECT_DOUBLE_EQ(balanced_slip_accuracy(counts_at(series, 0.5, {}).frames), 0.5 * (1.0 + 0.9));
  series[0].truth[5] = masked;
  EXPECT_EQ(counts_at(series, 0.5, {}).false_alarms, 9U);
  EXPECT_TRUE(std::isnan(counts_at({}, 0.5, {}).alarms_per_minute(period)));
}

// Above .8 nothing is slip, so no threshold limits the alarms: two consecutive frames do, at the
// cost of the slip's first frame.
TEST(OperatingPoint, TakesFramesInARowWhereNoThresholdWillDo) {
  const OperatingPoint point = best_point(spiky(), period, 1.0);
  EXPECT_EQ(point.alarm.on, 2U);
  EXPECT_DOUBLE_EQ(point.threshold, 0.5);  // between hold's .2 and slip's .8
  EXPECT_EQ(point.alarms_per_minute, 0.0);
  EXPECT_DOUBLE_EQ(balanced_slip_accuracy(counts_at(spiky(), point.threshold, point.alarm).frames), 0.5 * (1.0 + 0.95));
}

TEST(OperatingPoint, HasNoMoreAlarmsThanAreBorneAndUsesThem) {
  const OperatingPoint none = best_point(spiky(), period, 0.0), all = best_point(spiky(), period, 60.0);
  EXPECT_EQ(none.alarms_per_minute, 0.0);
  EXPECT_LE(all.alarms_per_minute, 60.0);
  EXPECT_GE(balanced_slip_accuracy(counts_at(spiky(), all.threshold, all.alarm).frames),
            balanced_slip_accuracy(counts_at(spiky(), none.threshold, none.alarm).frames));
}

// 60 frames of hold at .1, slip at .6, .6, .9, .9 by 0.125 mm per frame, and another 60 of hold with
// a spike of .7. At .5 the slip is detected after 0.125 mm (credit 2/3), and the spike is an alarm in
// the only series that holds: 2/3 - 1. At .8, between .7 and .9, the slip is detected after 0.375 mm
// (credit 2/5), without an alarm.
std::vector<SlipSeries> slip_and_hold() {
  SlipSeries slip{std::vector<double>(60, 0.1), std::vector<std::uint8_t>(60, 0), std::vector<double>(60, 0.0)};
  SlipSeries hold = slip;
  hold.probability[30] = 0.7;
  hold.holds = true;
  slip.probability.insert(slip.probability.end(), {0.6, 0.6, 0.9, 0.9});
  slip.truth.insert(slip.truth.end(), 4, 1);
  slip.path.insert(slip.path.end(), {0.125e-3, 0.25e-3, 0.375e-3, 0.5e-3});
  return {slip, hold};
}

TEST(OperatingPoint, OfTheGreatestScoreWeighsDistanceAgainstAlarms) {
  std::vector<SlipSeries> series = slip_and_hold();
  EXPECT_DOUBLE_EQ(counts_at(series, 0.5, {}).score(), 2.0 / 3.0 - 1.0);
  EXPECT_DOUBLE_EQ(counts_at(series, 0.8, {}).score(), 2.0 / 5.0);
  const OperatingPoint point = best_scoring_point(series, period, 0.0);
  // Two consecutive frames at .5 skip the spike and detect the slip after 0.25 mm, which earns 1/2.
  EXPECT_EQ(point.alarm.on, 2U);
  EXPECT_DOUBLE_EQ(counts_at(series, point.threshold, point.alarm).score(), 0.5);
  series[0].probability[59] = 0.9;  // reported before it slips: nothing is earned
  EXPECT_EQ(counts_at(series, 0.8, {}).score(), 0.0);
}

// An alarm that begins after a short slip has ended, in a masked frame, earns the credit of the
// path at that frame.
TEST(AlarmCounts, CreditAnAlarmInAMaskedFrame) {
  SlipSeries one{{0.1, 0.1, 0.1, 0.9}, {0, 1, masked, masked}, {0.0, 0.25e-3, 0.25e-3, 0.25e-3}};
  EXPECT_DOUBLE_EQ(counts_at({&one, 1}, 0.5, {}).credit, 0.5);
  one.path = {0.0, 0.01e-3, 0.04e-3, 0.04e-3};
  EXPECT_EQ(counts_at({&one, 1}, 0.5, {}).slips, 0U);  // a slip of less than least_slip_distance
  EXPECT_EQ(counts_at({&one, 1}, 0.5, {}).without_slip.series, 1U);
  EXPECT_EQ(counts_at({&one, 1}, 0.5, {}).without_slip.silent, 0U);
  one.path.clear();
  EXPECT_EQ(counts_at({&one, 1}, 0.5, {}).slips, 0U);  // its path is unknown
}

// Spikes of .7 in two of twenty trials of dataset 1, which do not lower the score below that of later
// alarms, are ruled out by a specificity of 95 %. Nineteen such trials are too few for a condition.
TEST(OperatingPoint, KeepsTheSpecificityInEveryDataset) {
  std::vector<SlipSeries> series = slip_and_hold();
  SlipSeries hold = series[1];
  hold.probability[30] = 0.1;
  series.pop_back();
  series[0].probability.assign(64, 0.1);
  series[0].probability[60] = 0.65;
  series.insert(series.end(), 100, hold);
  hold.dataset = 1;
  series.insert(series.end(), 18, hold);
  hold.probability[30] = hold.probability[31] = hold.probability[32] = 0.7;
  series.insert(series.end(), 2, hold);
  EXPECT_DOUBLE_EQ(counts_at(series, 0.5, {}).specificity(), 0.9);
  const OperatingPoint any = best_scoring_point(series, period, 0.9), strict = best_scoring_point(series, period, 0.95);
  EXPECT_GT(counts_at(series, any.threshold, any.alarm).score(), 0.6);
  EXPECT_EQ(counts_at(series, strict.threshold, strict.alarm).specificity(), 1.0);
  series.pop_back();
  EXPECT_DOUBLE_EQ(counts_at(series, 0.5, {}).specificity(), 1.0) << "of dataset 0 alone";
}

// A lift of dataset 1 slips at .9 after 60 frames of hold with a spike of .7. The spike does not
// lower the score of dataset 0, and the slip earns nothing.
TEST(OperatingPoint, ScoresTheFirstDatasetAlone) {
  std::vector<SlipSeries> series = slip_and_hold();
  series[1].probability[30] = 0.1;
  const double alone = counts_at(series, 0.5, {}).score();
  EXPECT_DOUBLE_EQ(alone, 2.0 / 3.0);
  SlipSeries lift = series[0];
  lift.dataset = 1;
  lift.probability[30] = 0.7;
  series.push_back(lift);
  const AlarmCounts counts = counts_at(series, 0.5, {});
  EXPECT_EQ(counts.score(), alone);
  EXPECT_EQ(counts.slips, 1U);
  EXPECT_EQ(counts.false_alarms, 1U);
  EXPECT_EQ(best_scoring_point(series, period, 0.95).alarm.on, 1U);
}

TEST(OperatingPoint, NeedsASlipThatEarnsCreditAndAHold) {
  const std::vector<SlipSeries> series = slip_and_hold();
  EXPECT_THROW(best_scoring_point({&series[1], 1}, period, 0.95), InputError);
  SlipSeries slips = series[0];
  slips.truth.assign(slips.truth.size(), 1);
  EXPECT_THROW(best_scoring_point({&slips, 1}, period, 0.95), InputError) << "no frame holds";
  EXPECT_EQ(best_scoring_point({series.data(), 1}, period, 0.95).alarm.on, 1U) << "no false alarm to lose";
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

#include "tools/benchmark/protocol.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace slipbench::benchmark {
namespace {

// 100 samples, of which the last 40 slip, from 0.6 s on. Of the first 60 samples `reported` are called
// slip, in `alarms` alarms. The credit of the slipped distance is that of the delay.
eval::Judgement judgement(Detection detection, double delay, std::size_t reported, std::size_t alarms) {
  eval::Judgement one;
  one.slip_time = 0.6;
  one.detection = detection;
  one.delay = delay;
  one.slip_distance = delay / half_delay * half_slip_distance;
  one.stick_alarms = alarms;
  one.stick_time = 0.6;
  one.frames[1][1] = 60 - reported;
  one.frames[1][3] = reported;
  one.frames[3][3] = 40;
  return one;
}

constexpr double none = std::numeric_limits<double>::quiet_NaN();
const TestSet open{.track = Track::open}, loop{.track = Track::loop}, real{.track = Track::transfer};

// A box that 2 N can hold, gripped with `ratio` times 2 N.
GraspOutcome grasp(double ratio, bool dropped) {
  return {.dropped = dropped, .max_grip_force = 2.0 * ratio, .ideal_grip_force = 2.0};
}

// In a recording of a real sensor, a slip that is seen after 0, 1 or 3 times half_delay earns 1, 1/2
// or 1/4.
TEST(Score, CreditFallsWithTheDelay) {
  for (const auto& [delay, credit] : {std::pair{0.0, 1.0}, {half_delay, 0.5}, {3.0 * half_delay, 0.25}}) {
    EXPECT_DOUBLE_EQ(recording_part(judgement(Detection::seen, delay, 0, 0), real).credit, credit);
  }
  EXPECT_EQ(recording_part(judgement(Detection::missed, none, 0, 0), real).credit, 0.0);
  EXPECT_EQ(recording_part(judgement(Detection::early, none, 30, 1), real).credit, 0.0);
}

// A slip whose onset is unknown has no delay, so there is no credit to earn, and nothing to lose.
TEST(Score, SlipsWithoutAKnownOnsetHaveNothingToEarn) {
  eval::Judgement one = judgement(Detection::seen, none, 0, 0);
  one.onset_known = false;
  const Part part = recording_part(one, real);
  EXPECT_FALSE(part.credited);
  EXPECT_EQ(part.credit, 0.0);
  EXPECT_EQ(score_of(std::vector{part}, real).credited, 0U);
  const Part seen = recording_part(judgement(Detection::seen, half_delay, 0, 0), real);
  const Score score = score_of(std::vector{part, seen}, real);
  EXPECT_EQ(score.credited, 1U);
  EXPECT_DOUBLE_EQ(score.credit, 0.5);
}

// In a simulated recording, a slip that is seen after 0, 1 or 3 times half_slip_distance earns 1, 1/2 or 1/4,
// whatever the delay.
TEST(Score, CreditFallsWithTheSlippedDistance) {
  for (const auto& [distance, credit] : {std::pair{0.0, 1.0}, {half_slip_distance, 0.5}, {3.0 * half_slip_distance, 0.25}}) {
    eval::Judgement one = judgement(Detection::seen, 5.0, 0, 0);
    one.slip_distance = distance;
    EXPECT_DOUBLE_EQ(recording_part(one, open).credit, credit);
  }
  EXPECT_EQ(recording_part(judgement(Detection::early, none, 30, 1), open).credit, 0.0);
}

// A recording in which the object slips by less than the least distance has no credit to earn,
// although an alarm before the slip is a false alarm. A recording that slips by the least distance
// has credit to earn.
TEST(Score, SlipsOfMicrometresHaveNothingToEarn) {
  eval::Judgement one = judgement(Detection::seen, 0.0, 0, 1);
  one.slip_distance = 0.0;
  one.whole_slip_distance = 0.9 * least_slip_distance;
  const Part small = recording_part(one, open);
  EXPECT_FALSE(small.credited);
  EXPECT_EQ(small.credit, 0.0);
  EXPECT_EQ(small.alarms, 1.0);
  EXPECT_TRUE(recording_part(one, real).credited) << "the distance is not known";
  one.whole_slip_distance = least_slip_distance;
  EXPECT_TRUE(recording_part(one, open).credited);
}

// Twelve recordings: two of them slip in part, which leaves ten; eight of these have no alarm.
TEST(Score, DisturbedRecordingsAreScoredBySpecificity) {
  const TestSet disturbed{.track = Track::open, .disturbance = "knock"};
  std::vector<Part> parts;
  for (int k = 0; k < 12; ++k) {
    eval::Judgement one = judgement(k < 2 ? Detection::missed : Detection::quiet, none, 0, 0);
    if (k >= 2) one.slip_time = none;
    if (k >= 10) one.alarm_time = 0.3;
    parts.push_back(recording_part(one, disturbed));
  }
  const Score score = score_of(parts, disturbed);
  EXPECT_EQ(score.judged, 10U);
  EXPECT_DOUBLE_EQ(score.value, 0.8);
  const Interval exact = clopper_pearson(8, 10), interval = score_interval(parts, disturbed);
  EXPECT_DOUBLE_EQ(interval.low, exact.low);
  EXPECT_DOUBLE_EQ(interval.high, exact.high);
}

// A recording without slip; `alarm`: slip is reported in it.
Part without_slip(bool alarm) {
  eval::Judgement one = judgement(Detection::quiet, none, alarm ? 30 : 0, alarm ? 1 : 0);
  one.slip_time = none;
  one.alarm_time = alarm ? 0.3 : none;
  return recording_part(one, open);
}

TEST(Score, ConstantAnswersEarnNothing) {
  const std::vector<Part> never{recording_part(judgement(Detection::missed, none, 0, 0), open), without_slip(false)};
  EXPECT_EQ(score_of(never, open).value, 0.0);
  const std::vector<Part> always{recording_part(judgement(Detection::early, none, 60, 1), open), without_slip(true)};
  EXPECT_EQ(score_of(always, open).value, -1.0) << "no credit, and slip is reported in each recording without it";
}

// Two slips, one detected at once and one reported early, have a credit of 1/2. Of four recordings
// without slip, one has an alarm, however long it lasts: 1/2 - 1/4.
TEST(Score, OpenRecordingsLoseTheShareOfFalseAlarms) {
  const std::vector<Part> parts{recording_part(judgement(Detection::seen, 0.0, 0, 0), open),
                                recording_part(judgement(Detection::early, none, 1, 1), open),
                                without_slip(true),
                                without_slip(false),
                                without_slip(false),
                                without_slip(false)};
  const Score score = score_of(parts, open);
  EXPECT_DOUBLE_EQ(score.credit, 0.5);
  EXPECT_DOUBLE_EQ(score.false_share, 0.25);
  EXPECT_DOUBLE_EQ(score.value, 0.25);
}

// A recording that slips too little to earn credit counts as one without slip: the only one of these
// has an alarm.
TEST(Score, SlipsOfMicrometresCountAsNone) {
  eval::Judgement one = judgement(Detection::seen, 0.0, 0, 1);
  one.whole_slip_distance = 0.9 * least_slip_distance;
  one.alarm_time = 0.7;
  const std::vector<Part> parts{recording_part(judgement(Detection::seen, half_delay, 0, 0), open), recording_part(one, open)};
  EXPECT_DOUBLE_EQ(score_of(parts, open).value, 0.5 - 1.0);
}

// In recordings of a real sensor, which may slip and hold, the share of the samples without slip in
// which slip is reported is lost: 30 of 120.
TEST(Score, RealRecordingsLoseTheShareOfFalseSamples) {
  eval::Judgement quiet = judgement(Detection::quiet, none, 30, 1);
  quiet.slip_time = none;
  const std::vector<Part> parts{recording_part(judgement(Detection::seen, half_delay, 0, 0), real), recording_part(quiet, real)};
  EXPECT_DOUBLE_EQ(score_of(parts, real).value, 0.5 - 30.0 / 120.0);
}

// The least force earns 1, worst_force_ratio times it earns 0, half-way 1/2. A box that is dropped
// or that needs no tightening earns nothing; the latter is not counted among the boxes that could
// earn credit.
TEST(Score, AGraspEarnsByItsForce) {
  const eval::Judgement without_alarm = judgement(Detection::missed, none, 0, 0);
  const GraspOutcome lost = grasp(1.0, true), held = grasp(1.0, false);
  EXPECT_DOUBLE_EQ(grasp_part(without_alarm, grasp(1.0, false), lost).credit, 1.0);
  EXPECT_DOUBLE_EQ(grasp_part(without_alarm, grasp(0.5 * (1.0 + worst_force_ratio), false), lost).credit, 0.5);
  EXPECT_EQ(grasp_part(without_alarm, grasp(2.0 * worst_force_ratio, false), lost).credit, 0.0);
  EXPECT_EQ(grasp_part(without_alarm, grasp(1.0, true), lost).credit, 0.0);
  GraspOutcome left = grasp(1.0, false);  // on the table
  left.lifted = false;
  EXPECT_EQ(grasp_part(without_alarm, left, lost).credit, 0.0);
  EXPECT_TRUE(grasp_part(without_alarm, grasp(1.0, false), left).credited);
  const std::vector<Part> parts{grasp_part(without_alarm, grasp(1.0, false), lost),
                                grasp_part(without_alarm, grasp(1.0, false), held)};
  EXPECT_EQ(score_of(parts, loop).value, 1.0);
}

// A box that is held without tightening: the force without tightening costs nothing,
// worst_force_ratio times it costs 1, half-way 1/2. The cost of two such boxes is their mean, whatever
// the boxes earn that need tightening.
TEST(Score, NeedlessForceCosts) {
  const eval::Judgement without_alarm = judgement(Detection::quiet, none, 0, 0);
  const GraspOutcome lost = grasp(1.0, true), held = grasp(1.0, false);
  const double half = 0.5 * (1.0 + worst_force_ratio);
  EXPECT_EQ(grasp_part(without_alarm, held, held).needless, 0.0);
  EXPECT_DOUBLE_EQ(grasp_part(without_alarm, grasp(half, false), held).needless, 0.5);
  EXPECT_EQ(grasp_part(without_alarm, grasp(2.0 * worst_force_ratio, false), held).needless, 1.0);
  EXPECT_EQ(grasp_part(without_alarm, grasp(half, false), lost).needless, 0.0);
  const std::vector<Part> parts{grasp_part(without_alarm, held, lost), grasp_part(without_alarm, held, held),
                                grasp_part(without_alarm, grasp(half, false), held)};
  EXPECT_DOUBLE_EQ(score_of(parts, loop).value, 1.0 - 0.25);
}

// Samples every 0.1 s for 2 s, in four windows of five samples. The second and the third window
// slip in part; slip is reported in the third and the fourth. The last sample slips but is masked,
// so the fourth window sticks.
TEST(Windows, AreCountedByTruthAndReport) {
  eval::Truth truth;
  eval::Replayed replayed;
  for (int row = 0; row < 20; ++row) {
    truth.time.push_back(0.1 * row + 0.01);
    truth.state.push_back(row == 9 || row == 11 || row == 19 ? PadState::incipient : PadState::non_slip);
    truth.masked.push_back(row == 19);
    replayed.seen.push_back(row == 14 || row == 17 ? PadState::gross : PadState::non_slip);
  }
  WindowCounts counts = window_counts(truth, replayed);
  EXPECT_EQ(counts.slipping, 2U);
  EXPECT_EQ(counts.detected, 1U);
  EXPECT_EQ(counts.sticking, 2U);
  EXPECT_EQ(counts.unreported, 1U);
  counts.add(counts);
  EXPECT_EQ(counts.sticking, 4U);
}

TEST(Score, IntervalsAreOfTenTrialsAndMore) {
  std::vector<Part> parts(9);
  EXPECT_TRUE(std::isnan(score_interval(parts, open).low));
  for (std::size_t k = 0; k < 10; ++k) {
    parts.resize(k + 1);
    parts[k].credit = k % 2 == 0 ? 1.0 : 0.0;
  }
  const Interval interval = score_interval(parts, open);  // of a share of 5 of 10
  EXPECT_LT(interval.low, 0.5);
  EXPECT_GT(interval.high, 0.5);
  EXPECT_GT(interval.low, 0.0);
  EXPECT_LT(interval.high, 1.0);
}

}  // namespace
}  // namespace slipbench::benchmark

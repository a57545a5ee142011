#include "tools/eval/metrics.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "sim/api/contact_frame.h"
#include "tests/expect.h"

namespace slipbench::eval::metrics_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr PadState none = PadState::no_contact, stick = PadState::non_slip, some = PadState::incipient, all = PadState::gross;

// Ten samples at 10 Hz, from 0 s on: one without contact, sticking from 0.1 s, slipping from 0.55 s
// to 0.75 s, detected at 0.6 and 0.7 s.
Truth truth() {
  Truth result;
  for (int row = 0; row < 10; ++row) result.time.push_back(0.1 * row);
  result.state = {none, stick, stick, stick, stick, stick, some, all, stick, stick};
  result.stuck_fraction = {NAN, 1.0F, 1.0F, 1.0F, 1.0F, 1.0F, 0.5F, 0.0F, 1.0F, 1.0F};
  result.period = 0.1;
  result.first_slip = result.any_slip = 0.55;
  return result;
}

Replayed seen(std::vector<PadState> states) {
  Replayed result;
  for (std::size_t row = 0; row < states.size(); ++row) result.seen_since.push_back(0.1 * static_cast<double>(row));
  result.stuck_fraction.assign(states.size(), nan);
  result.probability.assign(states.size(), nan);
  result.seen = std::move(states);
  return result;
}

// First detected at 0.7 s, 0.15 s after the slip began; still on at 0.8 s, when the pad sticks
// again, which is not a new alarm.
TEST(Judged, TheFirstAlarmDecides) {
  const Judgement result = judged(3, truth(), seen({none, stick, stick, stick, stick, stick, stick, all, all, stick}));
  EXPECT_EQ(result.trial, 3U);
  EXPECT_EQ(result.detection, Detection::seen);
  EXPECT_DOUBLE_EQ(result.delay, 0.7 - 0.55);
  EXPECT_EQ(result.stick_alarms, 0U);
  EXPECT_NEAR(result.stick_time, 0.7, 1e-12) << "samples 1 to 5, 8 and 9";
  EXPECT_NEAR(result.air_time, 0.1, 1e-12);
  EXPECT_EQ(result.frames[2][1], 1U) << "incipient and called non-slip";
  EXPECT_EQ(result.frames[1][3], 1U);
}

// The path is 0 until 0.55 s, 0.2 mm at 0.6 s and 1 mm at 0.7 s, from when on nothing sticks. An
// alarm at 0.65 s comes after 0.6 mm, before gross slip; one at 0.7 s comes after 1 mm and not
// before gross slip.
TEST(Judged, SlippedDistanceIsThatAtTheAlarm) {
  Truth slides = truth();
  slides.slip_distance = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.2e-3, 1.0e-3, 1.4e-3, 1.4e-3};
  slides.gross_slip = 0.7;
  Replayed answers = seen({none, stick, stick, stick, stick, stick, stick, all, all, stick});
  const double at_first_slip = 0.1e-3;  // half way from 0.5 s to 0.6 s
  const Judgement late = judged(0, slides, answers);
  EXPECT_NEAR(late.slip_distance, 1.0e-3 - at_first_slip, 1e-12);
  EXPECT_NEAR(late.whole_slip_distance, 1.4e-3 - at_first_slip, 1e-12) << "to the recording's end";
  EXPECT_FALSE(late.before_gross_slip);
  answers.seen_since[7] = 0.65;  // an estimate between the samples
  const Judgement soon = judged(0, slides, answers);
  EXPECT_NEAR(soon.slip_distance, 0.6e-3 - at_first_slip, 1e-12);
  EXPECT_TRUE(soon.before_gross_slip);
  const Judgement early = judged(0, slides, seen({none, stick, all, stick, stick, stick, stick, all, all, stick}));
  EXPECT_TRUE(std::isnan(early.slip_distance));
  EXPECT_NEAR(early.whole_slip_distance, 1.4e-3 - at_first_slip, 1e-12) << "whoever sees it";
  EXPECT_FALSE(early.before_gross_slip);
  EXPECT_TRUE(std::isnan(judged(0, truth(), answers).slip_distance)) << "not known";
  EXPECT_TRUE(std::isnan(judged(0, truth(), answers).whole_slip_distance));
  const Judgement graced = judged(0, slides, seen({none, stick, stick, stick, stick, all, all, all, stick, stick}), 0.06);
  EXPECT_EQ(graced.slip_distance, 0.0) << "the alarm at 0.5 s is before the path that the slip has made by 0.55 s";
}

// Alarms at 0 s without contact, at 0.2 s and, after a pause of one sample, at 0.4 s: early, by the
// first of them.
TEST(Judged, AnAlarmBeforeTheSlipIsEarlyAndCountedWhereItBegins) {
  const Judgement result = judged(0, truth(), seen({all, stick, some, stick, some, some, all, all, stick, stick}));
  EXPECT_EQ(result.detection, Detection::early);
  EXPECT_EQ(result.alarm_time, 0.0);
  EXPECT_TRUE(std::isnan(result.delay));
  EXPECT_EQ(result.air_alarms, 1U);
  EXPECT_EQ(result.stick_alarms, 2U) << "that at 0.4 s goes on into the slip";
}

// An alarm at 0.5 s is 0.05 s before the slip: with a larger grace it is neither early nor false.
// An alarm at 0.2 s is, whatever follows.
TEST(Judged, GraceForgivesAnAlarmJustBeforeTheSlip) {
  const Replayed soon = seen({none, stick, stick, stick, stick, all, all, all, stick, stick});
  for (const double grace : {0.0, 0.04}) {
    const Judgement early = judged(0, truth(), soon, grace);
    EXPECT_EQ(early.detection, Detection::early) << grace;
    EXPECT_EQ(early.stick_alarms, 1U) << grace;
  }
  const Judgement forgiven = judged(0, truth(), soon, 0.06);
  EXPECT_EQ(forgiven.detection, Detection::seen);
  EXPECT_EQ(forgiven.delay, 0.0);
  EXPECT_EQ(forgiven.stick_alarms, 0U);
  const Judgement twice = judged(0, truth(), seen({none, stick, some, stick, stick, all, all, all, stick, stick}), 0.06);
  EXPECT_EQ(twice.detection, Detection::early);
  EXPECT_EQ(twice.stick_alarms, 1U);
}

// Samples 1, 4 and 7 have no known state. Known are 0 (air), 2, 3, 8, 9 (stick) and 5, 6 (slip).
// The alarm from sample 1 on is false in its first known sample, 2; that from 4 on begins in the
// slip, and the one from 7 on is false in sample 8.
TEST(Judged, SamplesOfUnknownStateAreInNoFigure) {
  Truth known = truth();
  known.state = {none, unknown_state, stick, stick, unknown_state, all, all, unknown_state, stick, stick};
  known.stuck_fraction.clear();
  known.first_slip = known.any_slip = 0.5;
  Replayed answers = seen({none, all, all, stick, all, all, stick, all, all, stick});
  answers.probability.assign(10, 0.5);
  const Judgement result = judged(0, known, answers);
  EXPECT_EQ(result.frames[0][0], 1U);
  EXPECT_EQ(result.frames[1][1], 2U) << "samples 3 and 9";
  EXPECT_EQ(result.frames[1][3], 2U) << "samples 2 and 8";
  EXPECT_EQ(result.frames[3][3], 1U) << "sample 5";
  EXPECT_EQ(result.frames[3][1], 1U) << "sample 6";
  EXPECT_EQ(result.positives.size(), 2U);
  EXPECT_EQ(result.negatives.size(), 5U);
  EXPECT_EQ(result.stick_alarms, 2U);
  EXPECT_NEAR(result.stick_time, 0.4, 1e-12);
  EXPECT_NEAR(result.air_time, 0.1, 1e-12);
  EXPECT_EQ(result.detection, Detection::seen) << "the slip begins after sample 4, so no alarm is early";
  const Judgement aside = judged(0, known, seen({none, all, stick, stick, all, stick, stick, all, stick, stick}));
  EXPECT_EQ(aside.stick_alarms, 0U);
  EXPECT_EQ(aside.slips_found, 1U) << "the alarm of sample 4 is after the last hold and less than 0.5 s before the slip";
}

// Holds in samples 1 and 2, unknown in 3 and 4, slips in 5 and 6, ends, and slips in 9. Somewhere in
// samples 3 and 4 the first slip begins: an alarm that is on since sample 2 is not one of it, one that
// begins in sample 3 or 5 finds it, without a delay. The slip of sample 9 begins after a hold, so its
// alarm in sample 9 has the delay 0.
TEST(Judged, ASlipAfterUnknownSamplesHasNoOnset) {
  Truth after = truth();
  after.state = {none, stick, stick, unknown_state, unknown_state, all, all, stick, stick, all};
  after.stuck_fraction.clear();
  after.recorded = true;
  after.first_slip = after.any_slip = 0.5;
  const auto answer = [&](std::vector<std::size_t> rows) {
    std::vector<PadState> states(10, stick);
    for (const std::size_t row : rows) states[row] = all;
    return judged(0, after, seen(states));
  };
  const Judgement held = answer({1, 2, 3, 4, 5, 6});
  EXPECT_FALSE(held.onset_known);
  EXPECT_EQ(held.detection, Detection::missed) << "the alarm of the hold is still on";
  EXPECT_EQ(held.slips, 2U);
  EXPECT_EQ(held.slips_found, 0U);
  EXPECT_EQ(held.stick_alarms, 1U) << "in the hold it is false";
  const Judgement renewed = answer({2, 3, 5});
  EXPECT_EQ(renewed.slips_found, 1U) << "a second alarm begins in sample 5";
  for (const auto& rows : {std::vector<std::size_t>{3, 4, 5, 6}, {5}, {6}}) {
    const Judgement found = answer(rows);
    EXPECT_EQ(found.detection, Detection::seen);
    EXPECT_EQ(found.slips_found, 1U);
    EXPECT_TRUE(std::isnan(found.delay));
    EXPECT_TRUE(found.slip_delays.empty());
  }
  const Judgement second = answer({9});
  EXPECT_EQ(second.detection, Detection::missed);
  ASSERT_EQ(second.slip_delays.size(), 1U);
  EXPECT_EQ(second.slip_delays[0], 0.0);
  // A recording that slips from its first sample on; a simulation knows when that slip began.
  after.state.assign(10, all);
  after.first_slip = after.any_slip = 0.0;
  EXPECT_FALSE(answer({4}).onset_known);
  EXPECT_TRUE(std::isnan(answer({4}).delay));
  EXPECT_EQ(answer({4}).slips_found, 1U);
  after.recorded = false;
  EXPECT_NEAR(answer({4}).delay, 0.4, 1e-12);
}

// One trial is seen after 0.1 s, one is missed; in one the onset is unknown, and one has unknown
// labels only. Shares are of the two slips with a known onset: 1 of 2 is missed. Clopper and Pearson
// for 1 of 2: 1 - (1 - low)^2 = 0.025.
TEST(Summary, TrialsWithUnknownOnsetOrLabelsAreCountedApart) {
  std::vector<Judgement> trials(4);
  for (std::size_t k = 0; k < 3; ++k) {
    trials[k].slip_time = 1.0;
    trials[k].slips = 1;
  }
  trials[0].detection = Detection::seen;
  trials[0].delay = 0.1;
  trials[1].detection = Detection::missed;
  trials[2].detection = Detection::missed;
  trials[2].onset_known = false;
  trials[3].labelled = false;
  const Json json = summary_json(summarised(trials));
  EXPECT_EQ(json.at("trials"), 3);
  EXPECT_EQ(json.at("unlabelled"), 1);
  EXPECT_EQ(json.at("slipping"), 3) << "so none of the three is without slip";
  EXPECT_EQ(json.at("undated"), 1);
  EXPECT_EQ(json.at("slips"), 3);
  EXPECT_EQ(json.at("seen"), 1);
  EXPECT_EQ(json.at("missed"), 1);
  const Json& missed = json.at("figures").at("missed");
  EXPECT_EQ(missed.at("value"), 0.5);
  EXPECT_NEAR(missed.at("low").get<double>(), 1.0 - std::sqrt(0.975), 1e-9);
  EXPECT_EQ(json.at("figures").at("delay_median_s").at("value"), 0.1);
}

// Slips at 0.1 s and from 0.8 s on. Reported at 0.9 s: found after 0.1 s; at 0.4 s, 0.4 s before:
// found without delay; at 0.2 s, 0.6 s before: not found, and too late for the first.
TEST(Judged, EverySlipOfATrialIsFoundOrNot) {
  Truth twice = truth();
  twice.state = {stick, all, stick, stick, stick, stick, stick, stick, some, some};
  const auto answer = [&](std::size_t row) {
    std::vector<PadState> states(10, stick);
    states[row] = all;
    return judged(0, twice, seen(states));
  };
  for (const std::size_t row : {2U, 4U, 9U}) EXPECT_EQ(answer(row).slips, 2U);
  EXPECT_EQ(answer(2).slips_found, 0U);
  EXPECT_EQ(answer(4).slips_found, 1U);
  ASSERT_EQ(answer(4).slip_delays.size(), 1U);
  EXPECT_EQ(answer(4).slip_delays[0], 0.0);
  EXPECT_EQ(answer(9).slips_found, 1U);
  EXPECT_NEAR(answer(9).slip_delays.at(0), 0.1, 1e-12);
  const std::array both{answer(4), answer(9)};
  const Json json = summary_json(summarised(both, false));
  EXPECT_EQ(json.at("slips"), 4);
  EXPECT_EQ(json.at("slips_found"), 2);
  EXPECT_EQ(json.at("figures").at("slips_found").at("value"), 0.5);
  EXPECT_NEAR(json.at("figures").at("slip_delay_median_s").at("value").get<double>(), 0.05, 1e-12) << "of 0 and 0.1 s";
  // A report in the first slip does not count for the next slip, 0.2 s later.
  twice.state = {stick, stick, stick, stick, all, stick, all, stick, stick, stick};
  EXPECT_EQ(answer(4).slips_found, 1U);
  EXPECT_EQ(answer(5).slips_found, 1U);
}

// Samples 8 and 9, where the pad sticks again, are masked: neither frames nor false alarms, but the
// alarm at 0.8 s detects the slip.
TEST(Judged, MaskedFramesJudgeNothingButTheDelay) {
  Truth masked = truth();
  masked.masked = {false, false, false, false, false, false, false, false, true, true};
  Replayed late = seen({none, stick, stick, stick, stick, stick, stick, stick, all, stick});
  late.probability.assign(10, 0.5);
  const Judgement result = judged(0, masked, late);
  EXPECT_EQ(result.frames[1][3] + result.frames[2][3] + result.frames[3][3], 0U);
  EXPECT_EQ(result.frames[1][1], 5U) << "samples 1 to 5";
  EXPECT_EQ(result.negatives.size(), 6U) << "and that in the air";
  EXPECT_NEAR(result.stick_time, 0.5, 1e-12);
  EXPECT_EQ(result.stick_alarms, 0U);
  EXPECT_DOUBLE_EQ(result.delay, 0.8 - 0.55);
}

TEST(Judged, MissedQuietAndFalseAlarm) {
  const std::vector<PadState> quiet(10, stick);
  EXPECT_EQ(judged(0, truth(), seen(quiet)).detection, Detection::missed);
  Truth still = truth();
  still.first_slip = still.any_slip = nan;
  still.state = quiet;
  EXPECT_EQ(judged(0, still, seen(quiet)).detection, Detection::quiet);
  std::vector<PadState> alarm = quiet;
  alarm[4] = some;
  const Judgement wrong = judged(0, still, seen(alarm));
  EXPECT_EQ(wrong.detection, Detection::false_alarm);
  EXPECT_EQ(wrong.alarm_time, 0.4);
}

// An estimate of 0.5 s with a latency of 0.08 s is available at 0.58 s, between two samples, and
// after the slip began.
TEST(Judged, AnAlarmIsThereWhenItsLatencyIsOver) {
  Replayed late = seen({none, stick, stick, stick, stick, stick, all, all, stick, stick});
  late.seen_since[6] = 0.58;
  EXPECT_DOUBLE_EQ(judged(0, truth(), late).delay, 0.58 - 0.55);
}

// Closing fingers: alarms do not count from the slip at 0.1 s until the lift at 0.3 s, where a
// lasting one becomes an alarm.
TEST(Judged, AnAlarmThatLastsIntoTheLiftIsOneFromThereOn) {
  Truth grasp = truth();
  grasp.any_slip = 0.1;
  grasp.judged_from = 0.3;
  const Judgement result = judged(0, grasp, seen({none, stick, some, some, some, some, some, some, stick, stick}));
  EXPECT_EQ(result.detection, Detection::early);
  EXPECT_DOUBLE_EQ(result.alarm_time, grasp.time[3]);
  EXPECT_EQ(result.stick_alarms, 0U) << "it began where none counts";
  EXPECT_NEAR(result.stick_time, 0.5, 1e-12) << "samples 3, 4, 5, 8 and 9";
}

// A recording of one sample, like BTS3v2's, has no duration: alarms per minute and a delay would
// follow from its nominal rate.
TEST(Judged, OneSampleHasNeitherADelayNorTime) {
  Truth one;
  one.time = {0.0};
  one.period = 0.01;
  one.state = {stick};
  const Judgement held = judged(0, one, seen({all}));
  EXPECT_EQ(held.detection, Detection::false_alarm);
  EXPECT_EQ(held.frames[1][3], 1U);
  EXPECT_EQ(held.stick_time, 0.0);
  EXPECT_EQ(held.stick_alarms, 0U);
  one.state = {all};
  one.first_slip = one.any_slip = 0.0;
  const Judgement slipped = judged(0, one, seen({all}));
  EXPECT_EQ(slipped.detection, Detection::seen);
  EXPECT_TRUE(std::isnan(slipped.delay));
}

TEST(Judged, ProbabilitiesAndStuckFractions) {
  Replayed replayed = seen(std::vector<PadState>(10, stick));
  replayed.probability[2] = 0.1;
  replayed.probability[6] = 0.7;
  replayed.stuck_fraction.assign(10, 0.75);
  const Judgement result = judged(0, truth(), replayed);
  EXPECT_EQ(result.negatives, std::vector<double>{0.1});
  EXPECT_EQ(result.positives, std::vector<double>{0.7});
  // Nine samples in contact: all stick in seven, half in one, none in one.
  EXPECT_EQ(result.stuck_frames, 9U);
  EXPECT_NEAR(result.stuck_error, 7.0 * 0.25 + 0.25 + 0.75, 1e-12);
  EXPECT_THROW(judged(0, truth(), seen({stick})), std::logic_error);
}

double figure(const Summary& summary, std::string_view key) {
  for (std::size_t k = 0; k < figures.size(); ++k) {
    if (figures[k].key == key) return summary.estimates[k].value;
  }
  throw std::logic_error("no such figure");
}

// Four trials: detected after 10 ms and 30 ms, early, missed; and a quiet one without slip.
std::vector<Judgement> five() {
  std::vector<Judgement> trials(5);
  const Detection how[] = {Detection::seen, Detection::seen, Detection::early, Detection::missed, Detection::quiet};
  for (std::size_t k = 0; k < 5; ++k) {
    trials[k].trial = k;
    trials[k].detection = how[k];
    trials[k].stick_time = 6.0;
    if (k < 4) trials[k].slip_time = 1.0;
  }
  trials[0].delay = 0.010;
  trials[1].delay = 0.030;
  trials[2].stick_alarms = 2;
  trials[0].frames[3] = {0, 1, 0, 3};  // gross: one of four called non-slip
  trials[4].frames[1] = {0, 9, 1, 0};  // non-slip: one of ten called incipient
  return trials;
}

TEST(Summary, FiguresOfFiveTrials) {
  const Summary summary = summarised(five());
  EXPECT_EQ(summary.trials, 5U);
  EXPECT_EQ(summary.slipping, 4U);
  EXPECT_EQ(summary.seen, 2U);
  EXPECT_DOUBLE_EQ(figure(summary, "delay_median_s"), 0.020);
  EXPECT_DOUBLE_EQ(figure(summary, "delay_p10_s"), 0.012);  // a tenth of the way from 10 to 30 ms
  EXPECT_DOUBLE_EQ(figure(summary, "early"), 0.25);
  EXPECT_DOUBLE_EQ(figure(summary, "missed"), 0.25);
  EXPECT_DOUBLE_EQ(figure(summary, "false_alarms_per_minute"), 4.0);  // 2 in 5 x 6 s
  EXPECT_TRUE(std::isnan(figure(summary, "air_alarms_per_minute"))) << "it always touches";
  EXPECT_DOUBLE_EQ(figure(summary, "recall_of_slip"), 0.75);
  EXPECT_DOUBLE_EQ(figure(summary, "balanced_slip_accuracy"), 0.5 * (0.75 + 0.9));
  EXPECT_DOUBLE_EQ(figure(summary, "f1_of_slip"), 2.0 * 3.0 / (4.0 + 4.0));
  EXPECT_TRUE(std::isnan(figure(summary, "auc")));
}

// Clopper and Pearson for 1 of 4: p(k >= 1) = 1 - (1 - low)^4 = 0.025.
TEST(Summary, SharesOfTrialsHaveTheExactInterval) {
  const Summary summary = summarised(five());
  for (std::size_t k = 0; k < figures.size(); ++k) {
    if (figures[k].key != "missed") continue;
    EXPECT_NEAR(summary.estimates[k].interval.low, 1.0 - std::pow(0.975, 0.25), 1e-9);
  }
}

// Two trials of two values each; three of the four pairs of a positive and a negative are in order.
TEST(Summary, AreaUnderTheCurve) {
  std::vector<Judgement> trials(2);
  trials[0].positives = {0.9};
  trials[0].negatives = {0.5};
  trials[1].positives = {0.4};
  trials[1].negatives = {0.1};
  EXPECT_DOUBLE_EQ(figure(summarised(trials), "auc"), 0.75);
}

// Twenty trials, half of them called wrongly. They are independent, or ten trials copied twice,
// which widens the interval of a share, or five copied four times, which are too few for an
// interval.
TEST(Summary, TwinsCountOnce) {
  std::vector<Judgement> trials(20);
  for (std::size_t k = 0; k < 20; ++k) trials[k].frames[1] = k % 2 == 0 ? StateCounts{0, 10, 0, 0} : StateCounts{0, 0, 0, 10};
  const auto width = [&](std::size_t experiments) {
    for (std::size_t k = 0; k < 20; ++k) trials[k].twin = std::to_string(k % experiments);
    const Summary summary = summarised(trials);
    for (std::size_t k = 0; k < figures.size(); ++k) {
      if (figures[k].key == "false_alarm_share") {
        EXPECT_DOUBLE_EQ(summary.estimates[k].value, 0.5);
        return summary.estimates[k].interval.high - summary.estimates[k].interval.low;
      }
    }
    throw std::logic_error("no such figure");
  };
  // A mean of n draws of 0 or 1 has the standard deviation 1/(2 sqrt(n)): 95 % are 1.96/sqrt(n)
  // wide, up to the coarseness of n steps.
  EXPECT_NEAR(width(20), 1.96 / std::sqrt(20.0), 0.06);
  EXPECT_NEAR(width(10), 1.96 / std::sqrt(10.0), 0.11);
  EXPECT_TRUE(std::isnan(width(5)));
}

TEST(Summary, AsJson) {
  const Json json = summary_json(summarised(five()));
  EXPECT_EQ(json.at("called").at("gross").at("non_slip"), 1);
  EXPECT_EQ(json.at("frames"), 14);
  EXPECT_TRUE(json.at("figures").at("auc").at("value").is_null());
  EXPECT_EQ(json.at("constant").at("balanced_slip_accuracy"), 0.5);
  EXPECT_EQ(json.at("constant").at("accuracy"), 10.0 / 14.0);
}

// Eight samples at 10 Hz of a pad with two units, which slips in part, comes to rest, and is
// touched again.
SensorRecord sensor() {
  SensorRecord record;
  record.name = "pad";
  record.type = "myrmex";
  record.rate = 10.0;
  for (int row = 0; row < 8; ++row) record.time.push_back(0.1 * row);
  record.labels.state = {0, 1, 1, 3, 1, 1, 0, 1};
  record.labels.state_micro = {0, 1, 2, 3, 2, 1, 0, 1};
  record.labels.state_paper = {0, 1, 1, 2, 1, 1, 0, 1};
  record.labels.k_normal = {1.0, 1.0};
  record.labels.event_time = {0.05, 0.16, 0.24, 0.41};
  record.labels.event_unit = {0, 1, 1, 0};
  record.labels.event_kind = {static_cast<std::uint8_t>(EventKind::touch), static_cast<std::uint8_t>(EventKind::micro),
                              static_cast<std::uint8_t>(EventKind::slip), static_cast<std::uint8_t>(EventKind::stick)};
  return record;
}

TEST(Labels, RulesOfTheDatasetStandAsTheyAre) {
  EXPECT_EQ(label_states(sensor(), LabelRule::strict, false), (std::vector{none, stick, stick, all, stick, stick, none, stick}));
  EXPECT_EQ(label_states(sensor(), LabelRule::micro, false), (std::vector{none, stick, some, all, some, stick, none, stick}));
  EXPECT_EQ(label_states(sensor(), LabelRule::paper, false), (std::vector{none, stick, stick, some, stick, stick, none, stick}));
}

// Gross at 0.3 s, it stays gross when less and then nothing slips; contact is lost at 0.6 s, and at
// 0.7 s it sticks in a new contact.
TEST(Labels, LatchedHoldsUntilContactIsLost) {
  EXPECT_EQ(label_states(sensor(), LabelRule::latched, false), (std::vector{none, stick, some, all, all, all, none, stick}));
}

// Slips from 0.2 s to 0.4 s: at 0.5 s it sticks under the shear of that slip, at 0.7 s in a new
// contact.
TEST(Labels, MaskedIsMicroWithoutWhatSticksAgain) {
  EXPECT_EQ(label_states(sensor(), LabelRule::masked, false), label_states(sensor(), LabelRule::micro, false));
  const auto masked = [](LabelRule rule) { return truth_of(nullptr, {}, sensor(), rule).masked; };
  EXPECT_EQ(masked(LabelRule::masked), (std::vector{false, false, false, false, false, true, false, false}));
  EXPECT_TRUE(masked(LabelRule::micro).empty());
  const Truth later = truth_of(nullptr, {}, sensor(), LabelRule::masked, 0.45);
  EXPECT_EQ(later.masked, std::vector<bool>(8, false)) << "judged from 0.45 s on, that slip does not count";
}

// Slips from 0.24 s to 0.26 s, between two samples that stick.
TEST(Labels, MaskedBeginsWithASlipBetweenTwoSamples) {
  SensorRecord record = sensor();
  record.labels.state_micro = {0, 1, 1, 1, 1, 1, 0, 1};
  record.labels.event_time = {0.05, 0.24, 0.26};
  record.labels.event_unit = {0, 1, 1};
  record.labels.event_kind = {static_cast<std::uint8_t>(EventKind::touch), static_cast<std::uint8_t>(EventKind::micro),
                              static_cast<std::uint8_t>(EventKind::stick)};
  EXPECT_EQ(truth_of(nullptr, {}, record, LabelRule::masked).masked,
            (std::vector{false, false, false, true, true, true, false, false}));
}

// Full slip of a unit at 0.24 s, micro-slip from 0.16 s on.
TEST(FirstSlip, IsResolvedInsideTheStep) {
  const SensorRecord record = sensor();
  const auto first = [&](LabelRule rule, double from) {
    return first_slip(record, rule, label_states(record, rule, false), from);
  };
  EXPECT_EQ(first(LabelRule::strict, 0.0), 0.24);
  EXPECT_EQ(first(LabelRule::micro, 0.0), 0.16);
  EXPECT_EQ(first(LabelRule::paper, 0.0), 0.16);
  EXPECT_EQ(first(LabelRule::micro, 0.2), 0.24) << "a whole unit is a part, too";
  EXPECT_TRUE(std::isnan(first(LabelRule::strict, 0.25)));
}

TEST(FirstSlip, OfASingleUnitIsThatOfAPart) {
  SensorRecord record = sensor();
  record.labels.k_normal = {1.0};
  EXPECT_EQ(first_slip(record, LabelRule::strict, label_states(record, LabelRule::strict, false), 0.0), 0.16);
}

// As in a real recording with labels by a person.
TEST(FirstSlip, WithoutEventsIsThatOfTheSamples) {
  SensorRecord record = sensor();
  record.labels.event_time.clear();
  EXPECT_EQ(first_slip(record, LabelRule::strict, label_states(record, LabelRule::strict, false), 0.0), record.time[3]);
}

// Two units. Both slip by 1 mm, which is 1 mm of path. One detaches, the other slips 2 mm more; a
// new unit without slip touches; then nothing touches. The path stays at 3 mm, although the mean
// over touching units would fall to 1.5 mm and end.
TEST(Truth, PathNeverFallsWhenUnitsLetGo) {
  constexpr std::uint8_t gone = 0, slides = 2, sticks = 1;
  SensorRecord record = sensor();
  LabelRecord& labels = record.labels;
  labels.k_normal = {1.0, 1.0};
  labels.unit_state = {sticks, sticks, slides, slides, slides, gone, slides, gone,
                       sticks, sticks, gone,   gone,   gone,   gone, gone,   gone};
  labels.slip_distance = {0.0F,  0.0F,  1e-3F, 1e-3F, 2e-3F, 1e-3F, 3e-3F, 1e-3F,
                          3e-3F, 1e-3F, 3e-3F, 1e-3F, 3e-3F, 1e-3F, 3e-3F, 1e-3F};
  labels.state_paper = {1, 3, 3, 3, 1, 0, 0, 0};
  labels.event_time.clear();
  const Truth truth = truth_of(nullptr, {}, record, LabelRule::paper);
  ASSERT_EQ(truth.slip_distance.size(), 8U);
  const std::vector<double> path{0.0, 1e-3, 2e-3, 3e-3, 3e-3, 3e-3, 3e-3, 3e-3};
  for (std::size_t row = 0; row < path.size(); ++row) EXPECT_NEAR(truth.slip_distance[row], path[row], 1e-9) << row;
}

// Labels of a recording may be unknown.
TEST(Truth, LabelsOfARecordingMayBeUnknown) {
  SensorRecord recording = sensor();
  recording.labels = {};
  recording.labels.truth = false;
  recording.labels.state_paper = {4, 0, 1, 4, 3, 3, 4, 1};
  const Truth truth = truth_of(nullptr, {}, recording, LabelRule::recorded);
  EXPECT_EQ(truth.state[3], unknown_state);
  EXPECT_EQ(truth.first_slip, 0.4);
  EXPECT_FALSE(truth.judges(0));
  EXPECT_TRUE(truth.judges(1));
}

// Slips at 0.16 s, when touched, and at 0.24 s. Judged from 0.2 s on, only alarms from 0.2 s on
// count: the slip at 0.16 s is past.
TEST(Truth, IsJudgedByTheFirstSlipFromAnInstantOn) {
  const Truth truth = truth_of(nullptr, {}, sensor(), LabelRule::micro, 0.2);
  EXPECT_EQ(truth.first_slip, 0.24);
  EXPECT_EQ(truth.any_slip, 0.16);
  EXPECT_TRUE(truth.counts(0.1)) << "before anything slips";
  EXPECT_FALSE(truth.counts(0.18));
  EXPECT_TRUE(truth.counts(0.2));
}

// A recorded grasp does not store its lift: its first sample counts like the others.
TEST(Truth, AGraspWithoutASceneCountsFromItsBeginning) {
  TrialRecord record;
  record.outcome.grasp.emplace().dropped = true;
  SensorRecord finger = sensor();
  finger.labels.event_time.clear();
  finger.labels.state_paper = {3, 3, 3, 3, 3, 3, 3, 3};
  const Truth truth = truth_of(nullptr, record, finger, LabelRule::paper);
  EXPECT_EQ(truth.first_slip, 0.0);
  EXPECT_TRUE(truth.counts(0.0));
  EXPECT_TRUE(truth.counts(0.7));
}

// Slip of closing fingers from 1 s, lift at 2 s, drop at 4 s.
TEST(Truth, AlarmsOfClosingFingersAndAfterADropDoNotCount) {
  Truth grasp;
  grasp.any_slip = 1.0;
  grasp.judged_from = 2.0;
  grasp.judged_until = 4.0;
  EXPECT_TRUE(grasp.counts(0.5));
  EXPECT_FALSE(grasp.counts(1.0));
  EXPECT_FALSE(grasp.counts(1.9));
  EXPECT_TRUE(grasp.counts(2.0));
  EXPECT_FALSE(grasp.counts(4.0));
  EXPECT_TRUE(Truth{}.counts(1e9)) << "elsewhere all count";
}

}  // namespace
}  // namespace slipbench::eval::metrics_test

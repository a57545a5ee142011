#include "tools/cost/errors.h"

#include <numbers>
#include <stdexcept>

#include "tests/expect.h"
#include "tests/scenes.h"

namespace slipbench::testing {
namespace {

constexpr double never = std::numeric_limits<double>::quiet_NaN();
constexpr float detached = std::numeric_limits<float>::quiet_NaN();
constexpr double float_rounding = 1e-6;  // relative, of values stored as float32

// One second of a pad of two units at 100 Hz, always in contact: its margin falls from 1 at 0.5 s
// to 0 at 0.7 s, where both units begin to slip at 10 mm/s.
constexpr std::size_t rows = 100;

TrialResult slipping_pad() {
  TrialResult result;
  SensorRecord sensor;
  sensor.name = "pad";
  LabelRecord& labels = sensor.labels;
  labels.k_normal.assign(2, 1000.0);
  sensor.channels.push_back({"force", "N", {2}, {}});
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) / 100.0;
    sensor.time.push_back(t);
    const bool slips = i >= 70;
    for (int unit = 0; unit < 2; ++unit) {
      labels.unit_state.push_back(slips ? 2 : 1);
      labels.margin.push_back(static_cast<float>(std::min(1.0, std::max(0.0, 1.0 - (t - 0.5) / 0.2))));
      labels.slip_distance.push_back(static_cast<float>(std::max(0.0, 0.01 * (t - 0.7))));
      labels.force.insert(labels.force.end(), {0.0F, 3.0F, 4.0F});
      sensor.channels.back().values.push_back(i % 2 == 0 ? 1.0F : 3.0F);  // 1 about its mean
    }
    labels.state_micro.push_back(slips ? 3 : 1);
  }
  labels.onset_time.assign(2, 0.7);
  labels.micro_onset_time.assign(2, 0.7);
  result.record.sensors.push_back(std::move(sensor));
  result.record.outcome.touch_time = 0.0;
  result.record.outcome.first_micro_slip_time = result.record.outcome.first_slip_time = result.record.outcome.gross_slip_time =
      0.7;
  return result;
}

LabelRecord& labels_of(TrialResult& result) { return result.record.sensors.front().labels; }

Scene one_second() {
  Scene scene;
  scene.duration = 1.0;
  return scene;
}

std::optional<MeasureError> error_of(const TrialResult& run, const TrialResult& reference, Measure measure) {
  return at(compare(one_second(), run, reference), measure);
}

TEST(MeasureTable, IsInTheOrderOfTheEnum) {
  std::size_t k = 0;
  for (const MeasureInfo& info : measure_table()) {
    EXPECT_EQ(static_cast<std::size_t>(info.measure), k++);
    EXPECT_EQ(&info_of(info.measure), &info);
    EXPECT_FALSE(info.name.empty() || info.title.empty() || info.unit.empty() || info.definition.empty());
    EXPECT_GT(info.factor, 0.0);
  }
}

TEST(CommonRows, AreThoseAtOneTimeToWithinRounding) {
  const std::vector<double> slow{0.0, 0.1, 0.2, 0.3}, fast{0.0, 0.05, 0.1 + 1e-12, 0.15, 0.2, 0.25, 0.30000000000000004};
  EXPECT_THAT(common_rows(slow, fast), ElementsAre(Pair(0, 0), Pair(1, 2), Pair(2, 4), Pair(3, 6)));
  // 300 Hz and 200 Hz have common times at 100 Hz.
  const std::vector<double> thirds{0.0, 1.0 / 300, 2.0 / 300, 3.0 / 300}, halves{0.0, 1.0 / 200, 2.0 / 200};
  EXPECT_THAT(common_rows(thirds, halves), ElementsAre(Pair(0, 0), Pair(3, 2)));
  EXPECT_THAT(common_rows(std::vector<double>{0.1}, std::vector<double>{0.2}), IsEmpty());
}

TEST(LoadTime, IsHowLongALoadInProportionToTimeHasGrown) {
  std::vector<double> times;
  std::vector<float> margin;
  for (int i = 0; i < 100; ++i) {
    times.push_back(0.01 * i);
    margin.push_back(static_cast<float>(std::min(1.0, 1.0 - (0.01 * i - 0.5) / 0.2)));
  }
  // Loading began at 0.5 s, if the margin is used up at 0.7 s or a first part of the unit slips at
  // 0.583 s, between two samples.
  EXPECT_NEAR(load_time(times, margin, 0.7), 0.2, float_rounding);
  EXPECT_NEAR(load_time(times, margin, 0.583), 0.083, float_rounding);
  // Touched at 0.65 s with less than half of the margin left: loading counts from the last sample
  // before the touch.
  for (int i = 0; i < 65; ++i) margin[static_cast<std::size_t>(i)] = detached;
  EXPECT_NEAR(load_time(times, margin, 0.7), 0.06, 1e-12);
  // Loaded within one sample.
  margin.assign(100, 1.0F);
  EXPECT_EQ(load_time(times, margin, 0.7), least_load_time);
  EXPECT_EQ(load_time(times, margin, 0.0), least_load_time);
}

struct TrialErrors : ::testing::Test {
  const TrialResult reference = slipping_pad();
  TrialResult run = reference;
};

// Half a unit's force on twice as many units: the pad's force is equal, and 10 % higher if each
// carries 10 % more.
TEST_F(TrialErrors, OfForceAreThePadsWhereTheRunsHaveOtherUnits) {
  LabelRecord& labels = labels_of(run);
  labels.k_normal.assign(4, 500.0);
  labels.onset_time.assign(4, 0.7);
  labels.micro_onset_time.assign(4, 0.7);
  labels.unit_state.insert(labels.unit_state.end(), labels.unit_state.begin(), labels.unit_state.end());
  const auto halves = [&](float more) {
    labels.force.clear();
    for (std::size_t i = 0; i < 4 * rows; ++i) labels.force.insert(labels.force.end(), {0.0F, more * 1.5F, more * 2.0F});
    return error_of(run, reference, Measure::force).value().worst;
  };
  EXPECT_NEAR(halves(1.0F), 0.0, float_rounding);
  EXPECT_NEAR(halves(1.1F), 0.1, float_rounding);
  EXPECT_FALSE(error_of(run, reference, Measure::onset).has_value());
}

TEST_F(TrialErrors, OfARunAgainstItselfAreNone) {
  const Errors errors = compare(one_second(), run, run);
  for (const Measure measure : {Measure::onset, Measure::micro_onset, Measure::slip_distance, Measure::force, Measure::label,
                                Measure::label_micro, Measure::outcome, Measure::signal}) {
    ASSERT_TRUE(at(errors, measure).has_value()) << info_of(measure).name;
    EXPECT_EQ(at(errors, measure)->worst, 0.0) << info_of(measure).name;
    EXPECT_EQ(at(errors, measure)->median, 0.0) << info_of(measure).name;
    EXPECT_FALSE(at(errors, measure)->different) << info_of(measure).name;
  }
  EXPECT_FALSE(at(errors, Measure::creep).has_value());     // nothing moves by forces
  EXPECT_FALSE(at(errors, Measure::detector).has_value());  // there is no detector
}

TEST_F(TrialErrors, OfOnsetsAreSharesOfTheLoadTime) {
  labels_of(run).onset_time = {0.702, 0.696};  // relative to 0.2 s of load: 1 % late, 2 % early
  labels_of(run).micro_onset_time = {0.7, 0.71};
  const MeasureError onset = error_of(run, reference, Measure::onset).value();
  EXPECT_NEAR(onset.worst, 0.02, float_rounding);
  EXPECT_NEAR(onset.median, 0.015, float_rounding);
  EXPECT_FALSE(onset.different);
  EXPECT_NEAR(error_of(run, reference, Measure::micro_onset)->worst, 0.05, float_rounding);
}

TEST_F(TrialErrors, TellOfAUnitThatSlipsInOneRunAlone) {
  labels_of(run).onset_time[1] = never;
  const MeasureError missed = error_of(run, reference, Measure::onset).value();
  EXPECT_TRUE(missed.different);
  EXPECT_NEAR(missed.worst, 0.3 / 0.2, float_rounding);  // at least the rest of the trial
  EXPECT_TRUE(error_of(reference, run, Measure::onset)->different);

  // 1 ms before the trial's end at 0.701 s is half a percent of the load: the other slip may come
  // right after.
  Scene short_scene = one_second();
  short_scene.duration = 0.701;
  const MeasureError late = at(compare(short_scene, run, reference), Measure::onset).value();
  EXPECT_FALSE(late.different);
  EXPECT_NEAR(late.worst, 0.005, float_rounding);
}

// In the run unit 1 slips at 0.4 s for 5 ms, which the reference just misses: 300 ms compared with
// a load of 200 ms say nothing about the step. Slips that overlap, or begin within 1 % of the load,
// are the same event.
TEST_F(TrialErrors, SlipsOfWhichOneHadEndedBeforeTheOtherAreTwoEvents) {
  const auto with_slip = [&](double begin, double end) {
    LabelRecord& labels = labels_of(run);
    labels.onset_time[1] = begin;
    labels.event_time = {begin, begin, end};
    labels.event_unit = {1, 1, 1};
    labels.event_kind = {static_cast<std::uint8_t>(EventKind::micro), static_cast<std::uint8_t>(EventKind::slip),
                         static_cast<std::uint8_t>(EventKind::stick)};
    return error_of(run, reference, Measure::onset).value();
  };
  constexpr double onset = 0.7;  // the reference's
  const MeasureError two = with_slip(0.4, 0.405);
  EXPECT_TRUE(two.different);
  EXPECT_NEAR(two.worst, 0.0, float_rounding) << "of the unit 0 alone";
  const MeasureError overlapping = with_slip(onset - 0.01, onset + 0.002);
  EXPECT_FALSE(overlapping.different);
  EXPECT_NEAR(overlapping.worst, 0.01 / 0.2, 1e-3);
  EXPECT_FALSE(with_slip(onset - 0.001, onset - 0.0005).different) << "half a percent";
  TrialResult first = run, second = reference;
  labels_of(first).onset_time = {never, 0.4};
  labels_of(first).event_time = {0.4, 0.4, 0.405};
  labels_of(second).onset_time = {never, onset};
  const MeasureError alone = error_of(first, second, Measure::onset).value();
  EXPECT_TRUE(alone.different) << "also where no other unit slips";
  EXPECT_EQ(alone.worst, 0.0);
}

TEST_F(TrialErrors, OfSlippedDistanceAreSharesOfTheLargest) {
  // 2.9 mm in the last sample, one unit 29 um further.
  labels_of(run).slip_distance.back() += 29e-6F;
  const MeasureError error = error_of(run, reference, Measure::slip_distance).value();
  EXPECT_NEAR(error.worst, 0.01, 1e-5);
  EXPECT_NEAR(error.median, 0.005, 1e-5);
  TrialResult stuck = reference;
  labels_of(stuck).slip_distance.assign(2 * rows, 0.0F);
  EXPECT_FALSE(error_of(stuck, stuck, Measure::slip_distance).has_value());
  EXPECT_NEAR(error_of(stuck, reference, Measure::slip_distance)->worst, 1.0, float_rounding);
}

TEST_F(TrialErrors, OfForcesAreRootMeanSquares) {
  // 5 N throughout; 0.5 N off in half of the samples of both units.
  for (std::size_t i = 0; i < rows; i += 2) {
    for (std::size_t unit = 0; unit < 2; ++unit) labels_of(run).force[6 * i + 3 * unit + 2] += 0.5F;
  }
  EXPECT_NEAR(error_of(run, reference, Measure::force)->worst, 0.1 * std::sqrt(0.5), float_rounding);
}

TEST_F(TrialErrors, OfLabelsAreShares) {
  // One unit slips three samples late; in between the pad is incipient.
  for (std::size_t i = 70; i < 73; ++i) {
    labels_of(run).unit_state[2 * i] = 1;
    labels_of(run).state_micro[i] = 2;
  }
  EXPECT_NEAR(error_of(run, reference, Measure::label)->worst, 3.0 / 200.0, 1e-15);
  EXPECT_NEAR(error_of(run, reference, Measure::label_micro)->worst, 3.0 / 100.0, 1e-15);
  // Units without contact in both runs do not count.
  TrialResult half = reference;
  for (std::size_t i = 0; i < 50; ++i) labels_of(half).unit_state[2 * i] = labels_of(half).unit_state[2 * i + 1] = 0;
  TrialResult late = half;
  for (std::size_t i = 70; i < 73; ++i) labels_of(late).unit_state[2 * i] = 1;
  EXPECT_NEAR(error_of(late, half, Measure::label)->worst, 3.0 / 100.0, 1e-15);
}

TEST_F(TrialErrors, OfTheOutcomeAreDecisionsThatDiffer) {
  EXPECT_FALSE(error_of(run, reference, Measure::outcome)->different);
  run.record.outcome.gross_slip_time = never;
  EXPECT_NEAR(error_of(run, reference, Measure::outcome)->worst, 1.0 / 4.0, 1e-15);
  EXPECT_TRUE(error_of(run, reference, Measure::outcome)->different);
  TrialResult dropped = reference, held = reference;
  dropped.record.outcome.grasp.emplace().dropped = true;
  held.record.outcome.grasp.emplace();
  EXPECT_NEAR(error_of(held, dropped, Measure::outcome)->worst, 1.0 / 5.0, 1e-15);
  TrialResult left = held;
  held.record.outcome.grasp->lifted = true;
  left.record.outcome.grasp->lifted = false;
  EXPECT_NEAR(error_of(held, left, Measure::outcome)->worst, 1.0 / 6.0, 1e-15);
}

// Detected in both, but early in one: the fifth decision.
TEST_F(TrialErrors, OfTheOutcomeTellAnEarlyAlarmFromOneInTime) {
  run.record.control.emplace().detector = "force_ratio";
  run.record.outcome.detection_time = 0.5;
  run.record.outcome.detection = Detection::seen;
  const TrialResult seen = run;
  EXPECT_FALSE(error_of(run, seen, Measure::outcome)->different);
  run.record.outcome.detection = Detection::early;
  EXPECT_NEAR(error_of(run, seen, Measure::outcome)->worst, 1.0 / 5.0, 1e-15);
}

TEST_F(TrialErrors, OfTheDetectorAreClassesThatDiffer) {
  ControlRecord& control = run.record.control.emplace();
  control.detector = "force_ratio";
  control.time = reference.record.sensors.front().time;
  control.detector_class.assign(rows, 1);
  const TrialResult said = run;
  for (std::size_t i = 0; i < 7; ++i) run.record.control->detector_class[i] = 3;
  EXPECT_NEAR(error_of(run, said, Measure::detector)->worst, 0.07, 1e-15);
}

TEST_F(TrialErrors, OfSignalsAreOfTheirSpreadAboutTheMean) {
  for (float& value : run.record.sensors.front().channels.front().values) value += 0.25F;  // relative to a spread of 1
  EXPECT_NEAR(error_of(run, reference, Measure::signal)->worst, 0.25, float_rounding);
  // A channel with times of its own is compared at these.
  TrialResult own = reference;
  SensorColumn& column = own.record.sensors.front().channels.front();
  column.time = own.record.sensors.front().time;
  for (double& time : *column.time) time += 0.5;
  EXPECT_NEAR(error_of(own, own, Measure::signal)->worst, 0.0, 1e-15);
  EXPECT_TRUE(error_of(own, reference, Measure::signal).has_value());
  EXPECT_NEAR(error_of(own, reference, Measure::signal)->worst, 0.0, 1e-15);  // shifted by half a second, all values are equal
}

TEST_F(TrialErrors, AreAtCommonTimesAlone) {
  for (double& time : run.record.sensors.front().time) time += 0.005;  // between the reference's samples
  for (const Measure measure : {Measure::slip_distance, Measure::force, Measure::label, Measure::label_micro, Measure::signal}) {
    EXPECT_FALSE(error_of(run, reference, measure).has_value()) << info_of(measure).name;
  }
  EXPECT_TRUE(error_of(run, reference, Measure::onset).has_value());
}

// A body that moves with `drift` [m/s] over the pad that holds it, while the pad itself rises and
// turns.
TrialResult held_body(double drift) {
  TrialResult result = slipping_pad();
  TrialRecord& record = result.record;
  record.body_time = record.sensors.front().time;
  record.bodies = {{"pad", {}, {}}, {"box", {}, {}}};
  for (const double t : record.body_time) {
    const double half = 0.5 * (0.3 * t), c = std::cos(half), s = std::sin(half);  // 0.3 rad/s about z
    const double x = 0.02 + drift * t, turned_x = std::cos(2.0 * half) * x, turned_y = std::sin(2.0 * half) * x;
    const auto add = [](BodyRecord& body, std::initializer_list<double> pose) {
      for (const double value : pose) body.pose.push_back(static_cast<float>(value));
    };
    add(record.bodies[0], {0.0, 0.0, 0.1 * t, c, 0.0, 0.0, s});
    add(record.bodies[1], {turned_x, turned_y, 0.1 * t, c, 0.0, 0.0, s});
  }
  return result;
}

Scene holding_scene() {
  Scene scene = one_second();
  scene.bodies.push_back({"box", {"box", {}}});
  scene.sensors.push_back({"pad", "papillarray", {}, {}});
  scene.sensors.front().touches = {"box"};
  return scene;
}

TEST_F(TrialErrors, OfCreepAreDriftsOverThePad) {
  const Errors errors = compare(holding_scene(), held_body(50e-6), held_body(20e-6));
  // 0.7 s of hold; positions are float32, 4e-9 m apart at 0.1 m.
  EXPECT_THAT(at(errors, Measure::creep)->worst, DoubleNear(30e-6, 0.05e-6));
  TrialResult slips = held_body(20e-6);
  labels_of(slips).unit_state.assign(2 * rows, 2);  // never held
  EXPECT_FALSE(at(compare(holding_scene(), held_body(50e-6), slips), Measure::creep).has_value());
  TrialResult apart = held_body(20e-6);
  labels_of(apart).unit_state.assign(2 * rows, 0);
  EXPECT_FALSE(at(compare(holding_scene(), held_body(50e-6), apart), Measure::creep).has_value());
}

TEST_F(TrialErrors, NeedTheSameSensors) {
  run.record.sensors.front().name = "other";
  EXPECT_THROW(compare(one_second(), run, reference), std::invalid_argument);
  run.record.sensors.clear();
  EXPECT_THROW(compare(one_second(), run, reference), std::invalid_argument);
  // For a pad with other units only values of the whole pad are compared.
  TrialResult one = reference;
  labels_of(one).k_normal.resize(1);
  const Errors errors = compare(one_second(), one, reference);
  EXPECT_FALSE(at(errors, Measure::onset).has_value());
  EXPECT_TRUE(at(errors, Measure::label_micro).has_value());
}

TEST_F(TrialErrors, OfTwoTrialsAreTheWorse) {
  Errors errors, other;
  at(errors, Measure::onset) = MeasureError{0.1, 0.05, false};
  at(other, Measure::onset) = MeasureError{0.05, 0.06, true};
  at(other, Measure::force) = MeasureError{0.2, 0.2, false};
  keep_worst(errors, other);
  EXPECT_EQ(at(errors, Measure::onset)->worst, 0.1);
  EXPECT_EQ(at(errors, Measure::onset)->median, 0.06);
  EXPECT_TRUE(at(errors, Measure::onset)->different);
  EXPECT_EQ(at(errors, Measure::force)->worst, 0.2);
  EXPECT_FALSE(at(errors, Measure::label).has_value());
}

// Values of stage.yaml and the sensor's parameters (sensors/papillarray): the tips' depths [m] and
// positions [m], by pillar.
constexpr double mu = 0.5, ratio = 7.1 / 3.9, start = 2.0;  // k_n/k_t of the profile gripper
constexpr std::array<double, 9> depth{0.55e-3, 0.8e-3, 0.55e-3, 0.8e-3, 1e-3, 0.8e-3, 0.55e-3, 0.8e-3, 0.55e-3};
constexpr std::array<std::array<double, 2>, 9> place{
    {{7e-3, 7e-3}, {0, 7e-3}, {-7e-3, 7e-3}, {7e-3, 0}, {0, 0}, {-7e-3, 0}, {7e-3, -7e-3}, {0, -7e-3}, {-7e-3, -7e-3}}};

// Distance until a pillar slips: k_t s = mu k_n d.
double way(std::size_t pillar) { return mu * ratio * depth[pillar]; }

TEST(ClosedForm, OfTranslationIsTheFormulaByHand) {
  const ClosedForm exact = closed_form(stage_scene({}), 0).value();
  ASSERT_EQ(exact.units.size(), 1U);
  ASSERT_EQ(exact.units[0].size(), 9U);
  constexpr double v = 4e-3, a = 50e-3;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    // Full speed after v^2/(2 a) = 0.16 mm; all distances and their halves are longer.
    const double time = start + way(pillar) / v + v / (2 * a);
    const ClosedForm::Unit& unit = exact.units[0][pillar];
    EXPECT_NEAR(unit.whole.time, time, 1e-13) << pillar;
    EXPECT_EQ(unit.micro.time, unit.whole.time) << pillar;
    EXPECT_NEAR(unit.whole.load_time, way(pillar) / v, 1e-12) << pillar;
  }
}

TEST(ClosedForm, OfSpeedingUpIsTheFormulaByHand) {
  const ClosedForm exact = closed_form(stage_scene({{"motion.speed", "16 mm/s"}}), 0).value();
  constexpr double a = 50e-3;  // full speed after 2.56 mm, when all slip
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    EXPECT_NEAR(exact.units[0][pillar].whole.time, start + std::sqrt(2 * way(pillar) / a), 1e-13) << pillar;
  }
}

TEST(ClosedForm, OfRotationIsTheFormulaByHand) {
  const ClosedForm exact = closed_form(stage_scene({{"motion.speed", "0 mm/s"},
                                                    {"motion.rotation", "-30 deg/s"},
                                                    {"motion.angular_acceleration", "inf"},
                                                    {"motion.pivot", "[4 mm, -2.5 mm]"}}),
                                       0)
                               .value();
  const double rate = 30.0 * std::numbers::pi / 180.0;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    const double radius = std::hypot(place[pillar][0] - 4e-3, place[pillar][1] + 2.5e-3);
    const double chord = way(pillar) / (2 * radius);  // chord of the arc on which the root moves, over the diameter
    EXPECT_NEAR(exact.units[0][pillar].whole.time, start + 2.0 * std::asin(chord) / rate, 1e-13) << pillar;
  }
}

TEST(ClosedForm, OfBristlesIsByTheirShareOfLoad) {
  const ClosedForm exact = closed_form(stage_scene({{"sensors.pad.bristles", "6"}, {"motion.acceleration", "inf"}}), 0).value();
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    // Shares of load from 0.4 to 1.6 of the mean.
    EXPECT_NEAR(exact.units[0][pillar].micro.time, start + 0.4 * way(pillar) / 4e-3, 1e-13) << pillar;
    EXPECT_NEAR(exact.units[0][pillar].whole.time, start + 1.6 * way(pillar) / 4e-3, 1e-13) << pillar;
    EXPECT_NEAR(exact.units[0][pillar].micro.load_time, 0.4 * way(pillar) / 4e-3, 1e-12) << pillar;
  }
}

TEST(ClosedForm, OfTiltIsByEachTipsOwnDepth) {
  // Turned about Y by -1 degree a tip at x rises by x sin(1 deg), and its own drop is reduced by
  // the cosine.
  const ClosedForm exact =
      closed_form(stage_scene({{"motion.tilt", "[0 deg, -1 deg]"}, {"motion.acceleration", "inf"}}), 0).value();
  const double angle = std::numbers::pi / 180.0;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    const double pressed = 1e-3 - (1e-3 - depth[pillar]) * std::cos(angle) - place[pillar][0] * std::sin(angle);
    EXPECT_NEAR(exact.units[0][pillar].whole.time, start + mu * ratio * pressed / 4e-3, 1e-12) << pillar;
  }
}

TEST(ClosedForm, SaysNeverWhereNothingSlips) {
  // 0.3 mm of travel are less than the 0.5 mm that even the corners need.
  const ClosedForm exact = closed_form(stage_scene({{"motion.travel", "0.3 mm"}}), 0).value();
  for (const ClosedForm::Unit& unit : exact.units[0]) EXPECT_TRUE(std::isnan(unit.whole.time));
  // Lifted with half of the friction used up, a pillar slips when half of its load is left: at 2
  // mm/s down and 5 s.
  const ClosedForm lifted = closed_form(stage_scene({{"motion.travel", "0.3 mm"},
                                                     {"motion.acceleration", "inf"},
                                                     {"motion.retract", "3 s"},
                                                     {"motion.approach_speed", "2 mm/s"}}),
                                        0)
                                .value();
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    const double left = 0.3e-3 / (mu * ratio);  // depth at which friction is used up
    EXPECT_NEAR(lifted.units[0][pillar].whole.time, 3.0 + (depth[pillar] - left) / 2e-3, 1e-12) << pillar;
  }
}

TEST(ClosedForm, IsEmptyWhereThereIsNone) {
  EXPECT_FALSE(closed_form(stage_scene({{"surface", "{shape: sphere}"}}), 0));
  EXPECT_FALSE(closed_form(stage_scene({{"effects", "[ageing]"}}), 0));
  EXPECT_FALSE(closed_form(stage_scene({{"friction", "{static: 0, kinetic: 0}"}}), 0));
  // Slipped bristles stick again when the pad turns back: there is no formula for full slip of a
  // pillar.
  EXPECT_FALSE(closed_form(stage_scene({{"sensors.pad.bristles", "6"}, {"motion.reverse", "100 ms"}}), 0));
  EXPECT_TRUE(closed_form(stage_scene({{"motion.reverse", "100 ms"}}), 0));
}

// The field locates each onset on a straight line within its step, and is as exact as that line.
TEST(ClosedForm, IsWhatTheFieldComesTo) {
  struct Case {
    std::vector<Override> overrides;
    double bound;  // on the error at 1 ms, a share of the load time; a hundredth of it at 0.1 ms
  };
  // At constant speed the line is exact. In acceleration it is off by at most a h^2/8, over the
  // speed at the onset: 50 mm/s2 1e-6 s2/8 /(6 mm/s) = 1 us of the corners' load of 0.08 s. Turning
  // by 30 deg/s the chord is off by r w^2 h^2/8: 1e-6 of at least 0.1 s.
  const std::vector<Case> cases{{{}, 1e-12},
                                {{{"motion.speed", "16 mm/s"}}, 2e-5},
                                {{{"friction", "{static: 0.6, kinetic: 0.4}"}, {"sensors.pad.bristles", "6"}}, 1e-12},
                                {{{"motion.rotation", "30 deg/s"}, {"motion.pivot", "[3 mm, 1 mm]"}}, 2e-5}};
  for (const Case& test : cases) {
    for (const double step : {1e-3, 1e-4}) {
      Scene scene = stage_scene(test.overrides);
      scene.time_step = step;
      const ClosedForm exact = closed_form(scene, 0).value();
      const Errors errors = compare(scene, run_trial(scene, 0, Recording::outcome), exact);
      const double bound = std::max(1e-12, test.bound * step * step / 1e-6);
      EXPECT_LE(at(errors, Measure::onset)->worst, bound) << test.overrides.size() << " at " << step;
      EXPECT_LE(at(errors, Measure::micro_onset)->worst, bound) << test.overrides.size() << " at " << step;
      EXPECT_FALSE(at(errors, Measure::onset)->different);
      EXPECT_FALSE(at(errors, Measure::force).has_value());
    }
  }
}

}  // namespace
}  // namespace slipbench::testing

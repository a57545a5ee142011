// The nib pad's tables. Calibration: polynomial, split, reference, and what makes partial loads worse. Reorientation: what is asked for is what runs, the page
// says what the figures say, and what a record says became of a box that was to be turned up.
#include "tests/expect.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/scenes.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/program/run/run_trial.h"
#include "tools/studies/nib_reconfigurable/nib_tables.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::nib_tables_test {
namespace {

Eigen::MatrixXd random_rows(Eigen::Index rows, Eigen::Index columns, const char* name) {
  RandomStream stream(5, 0, name);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return stream.normal(); });
}

std::vector<Eigen::Index> rows_from(Eigen::Index first, Eigen::Index end) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(end - first));
  std::iota(rows.begin(), rows.end(), first);
  return rows;
}

TEST(QuadraticFit, FindsAQuadraticAgain) {
  const Eigen::MatrixXd x = random_rows(400, 5, "inputs");
  Eigen::MatrixXd y(400, 2);
  y.col(0) = 2.0 + x.col(0).array() - 3.0 * x.col(1).array() * x.col(2).array();
  y.col(1) = 1e3 * x.col(3).array().square() - 40.0;
  const QuadraticFit fit(x, y, rows_from(0, 200), rows_from(200, 300));
  // The least ridge, 1e-8 on columns of size 1, moves a coefficient by that share.
  const Eigen::MatrixXd error = fit.predict(rows_of(x, rows_from(300, 400))) - rows_of(y, rows_from(300, 400));
  EXPECT_LT(error.col(0).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(error.col(1).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_EQ(fit.ridge()[0], 1e-8);
}

// Where there is nothing to learn every coefficient is noise: of 90 on 120 rows, least squares has the error sd sqrt(1 + 90/(120 - 92)) = 2.1 sd
// or so, and the mean alone 1.0. The rows that choose see that, and take the largest ridge.
TEST(QuadraticFit, HoldsBackWhatTheChoosingRowsDoNotBear) {
  const Eigen::MatrixXd x = random_rows(2000, 12, "inputs"), y = random_rows(2000, 6, "noise");
  const QuadraticFit fit(x, y, rows_from(0, 120), rows_from(120, 1000));
  EXPECT_EQ(fit.ridge()[0], 1.0);
  const double rms = rms_error(fit.predict(x), y)[0];
  EXPECT_LT(rms, 1.2);
}

TEST(CalibrationSplit, KeepsPartsApartAndInTheirOrder) {
  for (const SplitKind kind : {SplitKind::random, SplitKind::chronological}) {
    RandomStream stream(1, 0, "split");
    const CalibrationSplit split = split_rows(1000, 300, 100, 150, kind, stream);
    EXPECT_EQ(split.fit.size(), 300U);
    EXPECT_EQ(split.choose.size(), 100U);
    EXPECT_EQ(split.test.size(), 150U);
    std::set<Eigen::Index> all(split.fit.begin(), split.fit.end());
    all.insert(split.choose.begin(), split.choose.end());
    all.insert(split.test.begin(), split.test.end());
    EXPECT_EQ(all.size(), 550U) << "no row twice";
    EXPECT_LT(*all.rbegin(), 1000);
    if (kind == SplitKind::random) continue;
    // The last fifth judges; of the 800 before it the last quarter chooses.
    EXPECT_LT(std::ranges::max(split.fit), 600);
    EXPECT_GE(std::ranges::min(split.choose), 600);
    EXPECT_LT(std::ranges::max(split.choose), 800);
    EXPECT_GE(std::ranges::min(split.test), 800);
  }
  RandomStream stream(1, 0, "split");
  EXPECT_THROW(split_rows(100, 50, 30, 30, SplitKind::random, stream), std::invalid_argument);
  EXPECT_THROW(split_rows(100, 61, 1, 1, SplitKind::chronological, stream), std::invalid_argument);
}

TEST(WrenchOnPad, IsForceAndMomentAboutThePadsOrigin) {
  PadLayout layout;
  for (const double x : {-2e-3, 5e-3}) {
    layout.units.push_back({layout.elements.size(), 1});
    layout.elements.push_back({.tip = {x, 1e-3, 0.0}});
  }
  ContactFrame truth;
  truth.force.setZero(3, 2);
  truth.displacement.setZero(3, 2);
  truth.force.col(0) << 0.0, 0.0, 2.0;
  truth.force.col(1) << 0.5, -1.0, 3.0;
  truth.displacement.col(1) << 1e-3, 0.0, 2e-3;  // so that it acts at (6, 1, 2) mm
  // (-2, 1, 0) x (0, 0, 2) = (2, 4, 0);  (6, 1, 2) x (0.5, -1, 3) = (3 + 2, 1 - 18, -6 - 0.5), in mN m.
  const PadWrench expected = (PadWrench() << 0.5, -1.0, 5.0, 7e-3, -13e-3, -6.5e-3).finished();
  EXPECT_LT((wrench_on_pad(layout, truth) - expected).cwiseAbs().maxCoeff(), 1e-15);
}

Scene pressed(const std::string& name, const std::vector<Override>& changes, std::size_t trial = 0) {
  return TrialPlan(shipped("nib_pad/" + name + ".yaml", changes), catalogues(), trial + 1, 1).trial(trial).scene;
}

TEST(RecordCalibration, AveragesTheReferenceAsTheSensorAveragesSi) {
  const CalibrationRecording all = record_calibration(pressed("calibrate_uniform", {{"duration", "3 s"}}), 0);
  // An image takes 30 ms: 100 in 3 s, of which 16 are complete by 0.5 s and tell the reading at rest.
  ASSERT_EQ(all.size(), 84U);
  for (Eigen::Index row = 4; row < all.wrench.rows(); ++row) {
    EXPECT_LT((all.averaged.row(row) - all.wrench.middleRows(row - 4, 5).colwise().mean()).cwiseAbs().maxCoeff(), 1e-12);
  }
  EXPECT_GT(all.wrench.col(2).maxCoeff(), 1.0);
  // Before the pad touches, readings are those at rest up to noise and drift.
  EXPECT_LT(all.si.row(0).cwiseAbs().maxCoeff(), 5.0 * 1.5);
}

// 2,000 images and more of a shipped scene, as a map of deflections to counts: all read at one instant, no noise, no mean, and a hand so
// fast that no image has a neighbour like it. In each of 30 recordings of 3 s a cylinder stands in another place.
CalibrationRecording images_of(const std::string& name, const std::string& capacitor) {
  const std::vector<Override> changes{{"sensors.pad.capacitor", capacitor}, {"sensors.pad.electronics", "ideal"},
                                      {"sensors.pad.scan", "simultaneous"}, {"sensors.pad.average", "1"},
                                      {"motion.bandwidth", "10 Hz"},        {"duration", "3 s"}};
  std::vector<CalibrationRecording> trials;
  for (std::size_t trial = 0; trial < 30; ++trial) trials.push_back(record_calibration(pressed(name, changes, trial), trial));
  return joined(trials);
}

// RMS error of Fz on 500 images that did not teach, of a polynomial of 1,600 images in equal parts of `scenes`.
double error_of_fz(const std::vector<std::string>& scenes, const std::string& capacitor) {
  RandomStream stream(2, 0, "split");
  std::vector<CalibrationRecording> parts;
  CalibrationSplit all;
  Eigen::Index first = 0;
  for (const std::string& scene : scenes) {
    parts.push_back(images_of(scene, capacitor));
    const CalibrationSplit split = split_rows(parts.back().size(), 1200 / scenes.size(), 400 / scenes.size(), 500 / scenes.size(),
                                              SplitKind::random, stream);
    for (const auto member : {&CalibrationSplit::fit, &CalibrationSplit::choose, &CalibrationSplit::test}) {
      for (const Eigen::Index row : split.*member) (all.*member).push_back(first + row);
    }
    first += static_cast<Eigen::Index>(parts.back().size());
  }
  const CalibrationRecording data = joined(parts);
  const QuadraticFit polynomial(data.si, data.wrench, all.fit, all.choose);
  return rms_error(polynomial.predict(rows_of(data.si, all.test)), rows_of(data.wrench, all.test))[2];
}

// What the paper found of its own pad, and why: there is nothing but the map from deflections to counts here, and what partial loads lose
// goes with 1/gap.
TEST(NibCalibration, PartialLoadsAreReadWorseBecauseTheGapIsInverted) {
  const std::vector<std::string> plate{"calibrate_uniform"}, partial{"calibrate_uniform", "calibrate_lying"};
  const double uniform = error_of_fz(plate, "gap"), mixed = error_of_fz(partial, "gap");
  EXPECT_GT(mixed, 1.25 * uniform) << uniform << " and " << mixed << " N";
  const double linear = error_of_fz(partial, "linear");
  EXPECT_LT(linear, uniform / 2.0) << linear << " N, less than of the plate through the gap";
}

// Where the nib pad's signal below 8 Hz comes from, on the bench itself: the patches of friction, not its growth with speed.

#ifdef SLIPBENCH_WITH_MUJOCO

// The slow release of the scene's own plate, paper pulled by 3 N, under a law of friction_laws().
std::optional<Signature> signature_under(const std::string& law) {
  Scene scene = parsed(shipped("nib_pad/release.yaml", {{"sweep", "{}"}}));
  std::ranges::find(friction_laws(), law, &FrictionLaw::name)->change(scene);
  return signature_of(scene, NibTrace(run_trial(scene, 0, Recording::full).record));
}

TEST(NibSignature, PatchesPutTheEnergyOfSlipBelow8HzAndTheRateLawAloneDoesNot) {
  const std::optional<Signature> patches = signature_under("scene"), smooth = signature_under("no_patches");
  // White noise of 1.2 counts a cluster, 1.7 of their difference, has 8 of its 150 Hz below 8 Hz: 0.053 of the energy, 0.39 counts rms. Patches
  // must make five times of either; without them little more than the noise is left.
  constexpr double noise_share = 8.0 / 150.0;
  const double noise_below = 1.2 * std::sqrt(2.0 * noise_share);
  ASSERT_TRUE(patches.has_value());
  EXPECT_GT(patches->share, 5.0 * noise_share);
  EXPECT_GT(patches->below, 5.0 * noise_below);
  ASSERT_TRUE(smooth.has_value());
  EXPECT_LT(smooth->share, 3.0 * noise_share);
}

#endif

// 100 samples at 300 Hz: an image every ninth, whose values are its number; the clusters count samples. Two nibs of 1 and 2 N, and a lever that
// goes 1 mm a sample.
TrialRecord recorded() {
  constexpr std::size_t samples = 100, images = samples / 9;
  TrialRecord record;
  SensorRecord& sensor = record.sensors.emplace_back();
  sensor.name = "pad";
  sensor.type = "nib_pad";
  sensor.rate = 300.0;
  sensor.channels = {{"si", "counts", {9, 4}, {}}, {"fl", "counts", {2}, {}}, {"fr", "counts", {2}, {}}};
  for (std::size_t image = 0; image < images; ++image)
    sensor.channels[0].values.insert(sensor.channels[0].values.end(), 36, static_cast<float>(image + 1));
  // An image is complete with each ninth sample.
  sensor.channels[0].time.emplace();
  for (std::size_t image = 0; image < images; ++image)
    sensor.channels[0].time->push_back(static_cast<double>(9 * (image + 1)) / 300.0 - 1e-3);
  BodyRecord& lever = record.bodies.emplace_back(BodyRecord{"lever", {}, {}});
  sensor.labels.k_normal = {1.0, 1.0};
  for (std::size_t k = 0; k < samples; ++k) {
    sensor.time.push_back(static_cast<double>(k + 1) / 300.0);
    for (const std::size_t channel : {1U, 2U})
      sensor.channels[channel].values.insert(sensor.channels[channel].values.end(), 2, static_cast<float>(k));
    sensor.labels.force.insert(sensor.labels.force.end(), {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 2.0F});
    lever.pose.insert(lever.pose.end(), {0.0F, 1e-3F * static_cast<float>(k), 0.0F, 1.0F, 0.0F, 0.0F, 0.0F});
  }
  return record;
}

TEST(NibTrace, IsWhatTheDetectorSaw) {
  const NibTrace trace(recorded());
  ASSERT_EQ(trace.size(), 100u);
  EXPECT_EQ(trace.source().channels[0].every, 9u);
  const auto image = [&](std::size_t k) { return trace.frame(k).values[0]; };
  EXPECT_EQ(image(7), 1.0F);  // no image is complete: the first stands there
  EXPECT_EQ(image(8), 1.0F);
  EXPECT_EQ(image(16), 1.0F);
  EXPECT_EQ(image(17), 2.0F);
  EXPECT_EQ(trace.frame(50).values[36], 50.0F);
  EXPECT_EQ(trace.frame(50).values[39], 50.0F);
  EXPECT_EQ(trace.frame(50).time, 51.0 / 300.0);
  EXPECT_EQ(trace.normal(3), 3.0);
}

TEST(NibTrace, FindsTimesAndWays) {
  const NibTrace trace(recorded());
  EXPECT_EQ(trace.at(0.1), 29u);
  EXPECT_EQ(trace.at(9.0), 100u);
  EXPECT_EQ(trace.moved(10, 4.5e-3), 15u);
  EXPECT_EQ(trace.moved(10, 1.0), std::nullopt);
}

TEST(NibTrace, TakesNoOtherTrial) {
  TrialRecord other = recorded();
  other.bodies.clear();
  EXPECT_THROW(NibTrace{other}, std::logic_error);
}

// Safe: before 6 mm. Gross: below the force that the pull requires; the other safe one is early.
TEST(ReleaseSummary, ErrorsAreThoseOfTheSafeRuns) {
  const std::vector<ReleaseRun> runs{
      {"paper", 4.0, 3.0, 1e-3}, {"paper", 4.0, 6.0, 3e-3}, {"paper", 4.0, 1.0, 7e-3}, {"felt", 1.0}};
  const ReleaseSummary paper = summary_of(runs, "paper");
  EXPECT_EQ(paper.runs, 3U);
  EXPECT_EQ(paper.safe, 2U);
  EXPECT_EQ(paper.early, 1U);
  EXPECT_DOUBLE_EQ(paper.error.mean, 1.5);
  EXPECT_DOUBLE_EQ(paper.gross_error.mean, 1.0);
  EXPECT_DOUBLE_EQ(paper.slip.mean, 2.0);
  EXPECT_EQ(summary_of(runs, "").runs, 4U);
  EXPECT_EQ(summary_of(runs, "felt").safe, 0U);
}

TEST(ReorientSummary, MediansLeaveOutWhatIsNone) {
  const double none = std::nan("");
  const ReorientRuns runs{{true, false, 0.1, 0.1, 5.0, {TurnEnd::standing, 0.2, 4.0}},
                          {false, false, 1.0, 0.3, 6.0, {TurnEnd::fell, 0.4, 3.0}},
                          {false, true, 1.5, 1.2, 7.0, {TurnEnd::lost, none, none}}};
  const ReorientSummary summary = summary_of(runs);
  EXPECT_EQ(summary.runs, 3U);
  EXPECT_EQ(summary.standing, 1U);
  EXPECT_EQ(summary.turned_up, 2U);
  EXPECT_EQ(summary.dropped, 1U);
  EXPECT_THAT(summary.ends, ElementsAre(1, 1, 0, 0, 1, 0, 0));
  EXPECT_DOUBLE_EQ(summary.tilt, 1.0);
  EXPECT_DOUBLE_EQ(summary.released_tilt, 0.3);
  EXPECT_DOUBLE_EQ(summary.held_by, 3.5);
  EXPECT_TRUE(std::isnan(summary_of({}).tilt));
}

constexpr double target = 0.1;  // m
constexpr double degree = 0.017453292519943295;

// One row of a trial: what the arm is told, how high it is, the grip force, the box's tilt against the vertical.
struct Row {
  float sideways, up, height, force;
  double tilt;  // degrees
};

// A turn about X by b lifts the axis Y by b: its tilt against the vertical is 90 degrees less b.
TrialRecord record_of(const std::vector<Row>& rows, bool standing = false) {
  TrialRecord record;
  GraspOutcome& grasp = record.outcome.grasp.emplace();
  TurnOutcome turn{.tilt = rows.back().tilt * degree, .least_tilt = 90.0 * degree, .standing = standing};
  GripRecord& grip = record.control.emplace().grip;
  record.bodies = {{"arm", {}, {}}, {"box", {}, {}}};
  for (const Row& row : rows) {
    turn.least_tilt = std::min(turn.least_tilt, row.tilt * degree);
    record.body_time.push_back(0.02 * static_cast<double>(record.body_time.size()));
    grip.arm.insert(grip.arm.end(), {row.sideways, row.up});
    grip.grip_force.push_back(row.force);
    const double half = 0.5 * (90.0 - row.tilt) * degree;
    record.bodies[0].pose.insert(record.bodies[0].pose.end(), {0.0F, 0.0F, row.height, 1.0F, 0.0F, 0.0F, 0.0F});
    record.bodies[1].pose.insert(record.bodies[1].pose.end(), {0.0F, 0.0F, 0.0F, static_cast<float>(std::cos(half)),
                                                               static_cast<float>(std::sin(half)), 0.0F, 0.0F});
  }
  grasp.turn = turn;
  return record;
}

const Row before_touch{0, 0, 0, 0, 90}, rises{0, 0.01F, 0.05F, 4, 50};

TEST(TurnLoss, SaysHowATrialEnded) {
  const auto end_of = [](const std::vector<Row>& rows, bool standing = false) {
    return turn_of(record_of(rows, standing), target).end;
  };
  const Row told{0.01F, 0, 0.06F, 4, 30}, at_target{0.01F, 0, 0.1F, 4, 30}, up{0.01F, 0, 0.1F, 1, 10};
  const Row stands{0, 0, 0.1F, 0, 0}, lies{0, 0, 0.1F, 0, 90}, slipped{0, 0.01F, 0.06F, 0, 85}, leans{0, 0, 0.1F, 0.2F, 1};
  EXPECT_EQ(end_of({before_touch, rises, told, stands}, true), TurnEnd::standing);
  EXPECT_EQ(end_of({before_touch, rises, slipped, lies}), TurnEnd::lost);
  EXPECT_EQ(end_of({before_touch, rises, slipped, at_target, lies}), TurnEnd::lost);  // though the arm goes on
  EXPECT_EQ(end_of({before_touch, rises, told, lies}), TurnEnd::told_early);
  EXPECT_EQ(end_of({before_touch, rises, at_target, lies}), TurnEnd::not_turned);
  EXPECT_EQ(end_of({before_touch, rises, told, up, lies}), TurnEnd::fell);
  EXPECT_EQ(end_of({before_touch, rises, at_target, up, leans}), TurnEnd::not_let_go);
  EXPECT_EQ(end_of({before_touch, rises, rises}), TurnEnd::not_released);
}

TEST(TurnLoss, ReadsTiltAndForceWhereTheReleaseBegins) {
  const Turn turn = turn_of(record_of({before_touch, rises, {0.01F, 0, 0.1F, 3, 25}, {0.01F, 0, 0.1F, 1, 5}}, true), target);
  EXPECT_NEAR(turn.tilt, 25.0 * degree, 1e-6);  // of a quaternion of floats
  EXPECT_EQ(turn.force, 3.0);
  EXPECT_TRUE(std::isnan(turn_of(record_of({before_touch, rises}), target).tilt));
}

TEST(TurnLoss, RefusesARecordWithoutItsRows) {
  TrialRecord record = record_of({before_touch, rises});
  record.control->grip.arm.pop_back();
  EXPECT_THROW(turn_of(record, target), std::logic_error);
  record = record_of({before_touch, {0.01F, 0, 0.1F, 3, 25}});
  record.bodies.pop_back();
  EXPECT_THROW(turn_of(record, target), InputError);
}

ReproduceOptions one_trial_of(const std::string& cell) {
  ReproduceOptions options;
  options.trials = 1;
  options.jobs = 1;
  options.only = {cell};
  return options;
}

TEST(NibTable3, NamesThatNothingHasAreRefused) {
  const std::string said = refusal_of([&] { nib_table3(one_trial_of("com_hi")); });
  EXPECT_THAT(said, HasSubstr("--only: unknown name 'com_hi'"));
  EXPECT_THAT(said, mentions({"200g", "com_low", "masonite", "fl_slip_x0.5"}));
}

#ifdef SLIPBENCH_WITH_MUJOCO

TEST(NibTable3, IsTheSameOnAnyNumberOfThreads) {
  ReproduceOptions options = one_trial_of("com_low");
  const Result one = nib_table3(options);
  options.jobs = 2;
  const Result two = nib_table3(options);
  EXPECT_EQ(one.figures, two.figures);
  ASSERT_THAT(one.tables, SizeIs(2));
  for (const ResultTable& table : one.tables) {
    ASSERT_THAT(table.rows, SizeIs(1));
    EXPECT_THAT(table.rows, Each(SizeIs(table.head.size())));
  }
  EXPECT_EQ(one.tables[0].rows[0][1], "11 of 11");
  const Json& cell = one.figures["cells"][0];
  EXPECT_EQ(cell["name"], "com_low");
  EXPECT_EQ(cell["published"], 11);
  EXPECT_EQ(cell["trials"], 1);
  int ended = 0;
  for (const Json& n : cell["ends"]) ended += n.get<int>();
  EXPECT_EQ(ended, 1);
  EXPECT_EQ(cell["ends"]["standing"], cell["standing"]);
  EXPECT_LE(cell["median_least_tilt_rad"], cell["median_tilt_rad"]);
  EXPECT_THAT(cell["command"].get<std::string>(), HasSubstr("--set 'box.weight_place=[0 mm, 41.08 mm, 0 mm]'"));
}

// With half of fl_slip the grip is firm enough for the decrements that turning takes: the box comes up, whatever becomes of it then.
TEST(NibTable3, AFirmerGripTurnsTheBoxUp) {
  const Result result = nib_table3(one_trial_of("fl_slip_x0.5"));
  EXPECT_LT(result.figures["cells"][0]["median_least_tilt_rad"].get<double>(), 20.0 * std::numbers::pi / 180.0);
}

#endif

}  // namespace
}  // namespace slipbench::reproduce::nib_tables_test

#include "tools/calibrate/groups.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/calibrate/calibrate.h"
#include "tools/calibrate/calibrate_page.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::calibrate::groups_test {
namespace {

// Two groups of four recordings: only pressed, and slid. The depth of each is drawn.
constexpr const char* scene_text = R"(slipbench: 1
duration: 1.2 s
time_step: 1 ms
seed: 5
surface: {material: acrylic}
friction: {static: 0.5, kinetic: 0.5}
motion: {kind: stage, compression: 1 mm, start: 0.8 s, speed: 4 mm/s}
sensors:
  pad: {type: papillarray, rate: 250 Hz, electronics: typical, profile: gripper}
sweep:
  motion: [{start: 1.1 s}, {start: 0.8 s}]
  motion.compression: {draw: normal, mean: 1 mm, sd: 0.1 mm}
  trials: 4
)";
constexpr const char* depth = "sweep.motion.compression.mean: {min: 0.6 mm, max: 1.4 mm}";

struct Grouped : slipbench::testing::FolderTest {
  Options options(const std::vector<std::string>& fits, const std::string& groups = "motion.start=1.1,0.8") {
    Options result;
    result.scene_path = path("scene.yaml");
    std::ofstream(result.scene_path) << scene_text;
    for (const std::string& fit : fits) result.keys.push_back(parse_fit_keys(fit).at(0));
    result.groups = parse_groups(groups);
    result.synthetic_truth = true;
    result.starts = 1;
    result.command = "slipbench calibrate scene.yaml";
    return result;
  }
  // The trials of the scene as recordings.
  Options with_recordings(const std::vector<std::string>& fits, const std::string& groups,
                          const std::vector<Override>& overrides = {}) {
    Options result = options(fits, groups);
    SweepOptions sweep;
    sweep.scene_path = result.scene_path;
    sweep.overrides = overrides;
    sweep.seed = 9;
    sweep.output = path("made.h5");
    run_sweep(sweep, program_catalogues(), {});
    result.synthetic_truth = false;
    result.recordings = {sweep.output};
    return result;
  }
  static std::string refusal(const Options& options) {
    return slipbench::refusal_of([&] { calibrate(options, program_catalogues()); });
  }
};

// 0, 1, ... 7 has the mean 3.5, a difference of 4 between the means of its halves, steps of 1
// between samples and of 2 between the means of two.
TEST(Figures, OfAStraightLine) {
  const Eigen::MatrixXd line = Eigen::VectorXd::LinSpaced(8, 0.0, 7.0);
  const Eigen::MatrixXd figures = figures_of(line, Eigen::RowVectorXd::Zero(1));
  ASSERT_EQ(figures.rows(), 4);
  EXPECT_DOUBLE_EQ(figures(0, 0), 3.5);
  EXPECT_DOUBLE_EQ(figures(1, 0), 4.0);
  EXPECT_NEAR(figures(2, 0), std::log(std::sqrt(0.5)), 1e-12);
  EXPECT_NEAR(figures(3, 0), std::log(2.0 * std::sqrt(0.5)), 1e-12);
}

// A signal that alternates by 1 has no step between the means of two samples; the floor is left.
TEST(Figures, HaveAFloor) {
  Eigen::MatrixXd saw(8, 1);
  saw << 0, 1, 0, 1, 0, 1, 0, 1;
  const Eigen::MatrixXd figures = figures_of(saw, Eigen::RowVectorXd::Constant(1, 0.01));
  EXPECT_NEAR(figures(2, 0), 0.5 * std::log(0.5 + 1e-4), 1e-12);
  EXPECT_NEAR(figures(3, 0), std::log(0.01), 1e-12);
}

TEST(ParsedGroups, AreALabelAndDifferentValues) {
  const Groups groups = parse_groups("class=n,e,s");
  EXPECT_EQ(groups.label, "class");
  EXPECT_EQ(groups.values, (std::vector<std::string>{"n", "e", "s"}));
  for (const char* wrong : {"class", "class=", "=n,e", "class=n,,e", "class=n,e,n"}) {
    EXPECT_THAT(slipbench::refusal_of([&] { parse_groups(wrong); }), mentions({"LABEL=VALUE"})) << wrong;
  }
}

// Bounds of three sd. The depths of eight real and eight simulated recordings scatter by 0.1 mm, so
// their means differ by 0.1 mm sqrt(2/8) = 0.05 mm. The device's common gain has an sd of 9.3
// %/sqrt(9) = 3 % of a force, 0.03 mm of 1 mm. Both together, times three: 0.17 mm. Friction is a
// ratio of forces of one device, whose gains of shear and of pressure have an sd of 3 % each: 4.4
// %, times three: 13 %.
TEST_F(Grouped, DrawnParametersComeBack) {
  const Options wanted = options({depth, "friction.scale: {min: 0.5, max: 1.5}"});
  const Result result = calibrate(wanted, program_catalogues());
  const Json &compression = result.json.at("parameters").at(0), &friction = result.json.at("parameters").at(1);
  EXPECT_TRUE(compression.at("determined").get<bool>());
  EXPECT_NEAR(compression.at("error").get<double>(), 0.0, 0.17e-3);
  EXPECT_TRUE(friction.at("determined").get<bool>());
  EXPECT_NEAR(friction.at("error").get<double>() / friction.at("truth").get<double>(), 0.0, 0.13);
  EXPECT_TRUE(recovers(result.json));
  // By chance, differences over their sd have an RMS of 1. The bounds are wide because the figures
  // are correlated and few recordings determine the sd.
  EXPECT_GT(result.json.at("residual_over_scatter").get<double>(), 0.4);
  EXPECT_LT(result.json.at("residual_over_scatter").get<double>(), 2.0);
  EXPECT_THAT(result.fitted, HasSubstr("motion.compression: {draw: normal, mean: "));
  EXPECT_EQ(result.json.at("groups").size(), 2U);
  EXPECT_THAT(calibration_page(result.json), HasSubstr("0.8 (4 / 4)"));
}

TEST_F(Grouped, ThreadsChangeNoByte) {
  Options one = options({depth}), two = one;
  one.starts = two.starts = 2;
  two.jobs = 2;
  const Result first = calibrate(one, program_catalogues()), second = calibrate(two, program_catalogues());
  EXPECT_EQ(first.json.dump(), second.json.dump());
  EXPECT_EQ(first.fitted, second.fitted);
}

// Without a slide, no recording determines the friction of a pad that is only pressed.
TEST_F(Grouped, FrictionWithoutASlideIsNotDetermined) {
  Options wanted = with_recordings({depth, "friction.scale: {min: 0.5, max: 1.5}"}, "motion.start=1.1,1.15",
                                   {{"sweep.motion.1.start", "1.15 s"}});
  wanted.overrides = {{"sweep.motion.1.start", "1.15 s"}};
  const Json result = calibrate(wanted, program_catalogues()).json;
  EXPECT_TRUE(result.at("parameters").at(0).at("determined").get<bool>());
  EXPECT_NEAR(result.at("parameters").at(0).at("value").get<double>(), 1e-3, 0.17e-3);
  EXPECT_FALSE(result.at("parameters").at(1).at("determined").get<bool>());
}

// A slide that begins at 0.48 s is refused if the press takes longer: all draws at the upper bound
// are refused, and no draw of the recordings.
TEST_F(Grouped, WhatTheSceneRefusesIsLeftOut) {
  const Override early{"sweep.motion.1.start", "0.48 s"};
  Options wanted = with_recordings({depth}, "motion.start=1.1,0.48", {early, {"sweep.motion.compression.mean", "0.8 mm"}});
  wanted.overrides = {early, {"sweep.motion.compression.mean", "0.7 mm"}};
  const Json result = calibrate(wanted, program_catalogues()).json;
  EXPECT_NEAR(result.at("parameters").at(0).at("value").get<double>(), 0.8e-3, 0.17e-3);
  for (const Json& group : result.at("groups")) EXPECT_EQ(group.at("trials").get<int>() + group.at("refused").get<int>(), 4);
  // The fit cannot begin if the scene refuses all draws with its own values.
  wanted.overrides = {early, {"sweep.motion.compression.mean", "1.4 mm"}};
  EXPECT_THAT(refusal(wanted), mentions({"draws", "cell"}));
}

// A second sensor does not change the pad's readings: with recordings that list one before the pad,
// the means are unchanged.
TEST_F(Grouped, ARecordingMayHaveOtherSensorsBeside) {
  const std::string pad = "pad: {type: papillarray, rate: 250 Hz, electronics: typical, profile: gripper}";
  const std::string another = "another: {type: papillarray, rate: 250 Hz, electronics: typical, profile: hexapod}";
  with_recordings({depth}, "motion.start=1.1,0.8", {{"sensors", "{" + another + ", " + pad + "}"}});
  std::filesystem::rename(path("made.h5"), path("beside.h5"));
  Options wanted = with_recordings({depth}, "motion.start=1.1,0.8");
  const auto real_means = [&] {
    std::vector<Json> means;
    const Json result = calibrate(wanted, program_catalogues()).json;
    for (const Json& group : result.at("groups")) {
      for (const Json& statistic : group.at("statistics")) means.push_back(statistic.at("real"));
    }
    return means;
  };
  const std::vector<Json> alone = real_means();
  wanted.recordings.push_back(path("beside.h5"));
  EXPECT_THAT(real_means(), ::testing::ElementsAreArray(alone));
}

// One recorded sensor could be either of two sensors of its type if no recording has their names.
TEST_F(Grouped, OneRecordedSensorIsNotTakenForTwo) {
  const std::string pad = ": {type: papillarray, rate: 250 Hz, electronics: typical, profile: gripper}";
  Options wanted = with_recordings({depth}, "motion.start=1.1,0.8");
  wanted.overrides = {{"sensors", "{left" + pad + ", right" + pad + "}"}};
  EXPECT_THAT(refusal(wanted), mentions({"sensor"}));
}

TEST_F(Grouped, RefusesWhatDoesNotFit) {
  EXPECT_THAT(refusal(options({depth}, "motion.start=1.1")), mentions({"--groups", "1 value,", "2 cells"}));
  EXPECT_THAT(refusal(options({"lag: {min: 0 ms, max: 5 ms}"})), mentions({"lag", "recordings"}));
  EXPECT_THAT(refusal(options({"friction.scale: {min: 0.5, max: 1, each: true}"})), mentions({"friction.scale", "each: true"}));
  EXPECT_THAT(refusal(options({"sweep.motion.compression.maen: {min: 0.5 mm, max: 1 mm}"})),
              HasSubstr("sweep.motion.compression.maen"));
  Options curves = options({depth});
  curves.groups.reset();
  EXPECT_THAT(refusal(curves), mentions({"sweep.motion.compression.mean", "--groups"}));
  EXPECT_THAT(refusal(with_recordings({depth}, "class=a,b")), mentions({"demo_0", path("made.h5"), "class"}));
  EXPECT_THAT(refusal(with_recordings({depth}, "motion.start=1.1,0.5")),
              mentions({"motion.start", "0.8", "--groups", "1.1, 0.5"}));
  EXPECT_THAT(refusal(with_recordings({depth}, "motion.start=1.1,0.8", {{"sweep.trials", "1"}})),
              mentions({"1 recording", "motion.start", "1.1"}));
  EXPECT_THAT(refusal(with_recordings({depth}, "motion.start=1.1,0.8", {{"sensors.pad.rate", "100 Hz"}})),
              mentions({"10 ms", "4 ms", "1 %", "100 Hz", "250 Hz"}));
  // Trials of 1.2 s. All are compared by their last part, so up to twice as long is accepted.
  EXPECT_THAT(refusal(with_recordings({depth}, "motion.start=1.1,0.8", {{"duration", "2.5 s"}})),
              mentions({"2496 ms", "1196 ms", "100 %"}));
}

}  // namespace
}  // namespace slipbench::calibrate::groups_test

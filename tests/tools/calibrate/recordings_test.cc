#include "tools/calibrate/recordings.h"

#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/calibrate/calibrate.h"
#include "tools/calibrate/search.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench::calibrate::recordings_test {
namespace {

// A sensor with one value at the given times.
SensorRecord sensor_of(const std::vector<double>& time, const std::vector<float>& values) {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "meter";
  sensor.time = time;
  sensor.channels = {{.name = "value", .unit = "N", .shape = {}, .values = values}};
  return sensor;
}

Columns columns_of(const SensorRecord& sensor) { return shared_columns({"r", {sensor}}, {sensor}); }

// The mean of a straight line over a stretch is its value in the middle, whatever the steps of the
// samples.
TEST(BinMeans, OfAStraightLineAreItsMiddles) {
  const SensorRecord line = sensor_of({0.0, 0.1, 0.25, 0.7, 1.0}, {0.0F, 0.2F, 0.5F, 1.4F, 2.0F});
  const Eigen::MatrixXd means = bin_means({line}, Side::real, columns_of(line), {0.0, 0.4, 0.8, 1.0}, 0.0);
  EXPECT_NEAR(means(0, 0), 0.4, 1e-6);
  EXPECT_NEAR(means(1, 0), 1.2, 1e-6);
  EXPECT_NEAR(means(2, 0), 1.8, 1e-6);
}

// 2 t, shifted by 0.1 s: 2 (t - 0.1), and outside of its samples as at their ends.
TEST(BinMeans, AreShiftedAndStandStillOutside) {
  const SensorRecord line = sensor_of({0.0, 0.5, 1.0}, {0.0F, 1.0F, 2.0F});
  const Eigen::MatrixXd means = bin_means({line}, Side::real, columns_of(line), {-0.5, 0.1, 0.3, 1.1, 1.5}, 0.1);
  EXPECT_NEAR(means(0, 0), 0.0, 1e-6);
  EXPECT_NEAR(means(1, 0), 0.2, 1e-6);
  EXPECT_NEAR(means(2, 0), 1.2, 1e-6);
  EXPECT_NEAR(means(3, 0), 2.0, 1e-6);
}

// Steps of 2 up and down: sqrt(2^2/2).
TEST(Roughness, IsTheStepOverTheSquareRootOfTwo) {
  const SensorRecord saw = sensor_of({0.0, 1.0, 2.0, 3.0}, {1.0F, -1.0F, 1.0F, -1.0F});
  EXPECT_NEAR(roughness({saw}, Side::real, columns_of(saw))(0), std::sqrt(2.0), 1e-12);
}

TEST(SharedColumns, AreThoseOfTheSameNameOrTheOnlyOneOfTheType) {
  SensorRecord real = sensor_of({0.0, 1.0}, {0.0F, 0.0F}), scene = real;
  real.name = "s0";
  EXPECT_EQ(shared_columns({"r", {real}}, {scene}).count, 1U);
  real.type = "other";
  const auto refusal = [&] { return refusal_of([&] { shared_columns({"r", {real}}, {scene}); }); };
  EXPECT_THAT(refusal(), refused_at("r", {"s0", "other", "pad", "meter"}));
  real.type = "meter";
  real.channels.front().shape = {2};
  real.channels.front().values.resize(4);
  EXPECT_THAT(refusal(), refused_at("r", {"pad/value", "[2]", "[]"}));
}

// Arrays with other names, or of another sensor, do not belong to the same recordings, even with as
// many values.
TEST(SameColumns, AreToldByTheirNames) {
  const SensorRecord pad = sensor_of({0.0, 1.0}, {0.0F, 0.0F});
  SensorRecord other = pad;
  other.channels.front().name = "current";
  const auto refusal = [&] {
    return slipbench::refusal_of([&] { check_same_columns("b", columns_of(other), "a", columns_of(pad)); });
  };
  EXPECT_THAT(refusal(), refused_at("b", {"pad/current", "pad/value"}));
  other = pad;
  other.name = "second";
  EXPECT_THAT(refusal(), refused_at("b", {"second/value", "pad/value"}));
  EXPECT_NO_THROW(check_same_columns("b", columns_of(pad), "a", columns_of(pad)));
}

// 101 and 98 samples of 1 s each: 1 % and 2 % off the scene's 100 Hz.
TEST(SameSampling, IsARateWithinOnePercent) {
  const auto clock = [](int count, double step) {
    std::vector<double> times;
    for (int k = 0; k < count; ++k) times.push_back(step * k);
    return sensor_of(times, std::vector<float>(times.size(), 1.0F));
  };
  const SensorRecord scene = clock(101, 0.01);
  const auto refusal = [&](const SensorRecord& real) {
    return slipbench::refusal_of([&] { check_same_sampling({"r", {real}}, {scene}, columns_of(scene), 1.1, 0.0); });
  };
  EXPECT_EQ(refusal(clock(101, 1.0 / 100.9)), "accepted");
  EXPECT_EQ(refusal(clock(101, 1.0 / 99.1)), "accepted");
  EXPECT_THAT(refusal(clock(99, 1.0 / 98.0)), mentions({"98 Hz", "100 Hz", "1 %"}));
  EXPECT_THAT(refusal(clock(163'501, 0.01)), refused_at("r", {"1635 s", "1 s", "10 %"}));
}

TEST(ReadRecordings, AreOneAtLeast) {
  EXPECT_THAT(slipbench::refusal_of([] { return read_recordings({}, nullptr); }), mentions({"no recording"}));
}

// A recording that is given twice would halve the variance of the fit.
TEST(ReadRecordings, AreGivenOnce) {
  EXPECT_THAT(slipbench::refusal_of([] {
                return read_recordings({"a.h5", "b.h5", "a.h5"}, nullptr);
              }),
              mentions({"a.h5: was given twice; give each recording once"}));
}

using Eigen::MatrixXd;

// Two units of two components, 50 stretches, which begin at 0; the first unit carries sines, the
// second twice as much.
Columns two_units() {
  ChannelPlace place{.sensor = "pad", .channel = "force", .unit = "N", .names = {"x", "y"}};
  place.units = 2;
  place.components = 2;
  return {{place}, 4};
}

MatrixXd signal() {
  MatrixXd wave(50, 4);
  for (int t = 0; t < 50; ++t) {
    wave(t, 0) = std::sin(0.3 * t);
    wave(t, 1) = std::cos(0.5 * t) - 1.0;
    wave.block(t, 2, 1, 2) = 2.0 * wave.block(t, 0, 1, 2);
  }
  return wave;
}

// Device d: the x of the units has gains 1 + a and 1 - a, a coupling b to y, and offsets c.
MatrixXd read(double a, double b, double c) {
  const MatrixXd s = signal();
  MatrixXd y = s;
  y.col(0) = (1.0 + a) * s.col(0) + b * s.col(1);
  y.col(2) = (1.0 - a) * s.col(2) + b * s.col(3);
  y.col(0).array() += c;
  y.col(2).array() -= c;
  return y;
}

Disturbances learned() {
  return {two_units(), {{read(0.1, 0.02, 0.3)}, {read(-0.1, -0.02, -0.3)}}, {{signal()}, {signal()}}, 1e-4};
}

// Gains of 1.1 and 0.9 scatter by 0.1, and so on; y has no gain, coupling or offset.
TEST(Disturbances, AreLearned) {
  const Disturbances disturbances = learned();
  const Disturbance& x = disturbances.by_component()[0];
  EXPECT_NEAR(x.gain_sd, 0.1, 1e-4);
  EXPECT_NEAR(x.coupling_sd, 0.02, 1e-4);
  EXPECT_NEAR(x.offset_sd, 0.3, 1e-3);
  const Disturbance& y = disturbances.by_component()[1];
  EXPECT_LT(y.gain_sd, 1e-4);
  EXPECT_LT(y.offset_sd, 1e-3);
}

// The unit that carries twice as much has four times the weight: gains of 1.1 and 1 - 0.1/4 have
// the mean 1.
TEST(Disturbances, ExplainGainsCouplingsAndOffsets) {
  const MatrixXd s = signal();
  MatrixXd y = s;
  y.col(0) = 1.1 * s.col(0) + 0.02 * s.col(1);
  y.col(2) = (1.0 - 0.1 / 4.0) * s.col(2);
  y.col(0).array() += 0.3;
  const Distance distance = learned().distance({y}, {s});
  EXPECT_NEAR(distance.gain(0), 1.1, 1e-3);
  EXPECT_NEAR(distance.gain(2), 0.975, 1e-3);
  EXPECT_NEAR(distance.offset(0, 0), 0.3, 1e-3);
  EXPECT_LT((distance.explained[0] - y).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_EQ(distance.residual.size(), static_cast<Eigen::Index>(distance.group.size()));
}

// A gain that both units share is not fitted: the readings stay 10 % above the fit. The couplings,
// with a prior of 0.02, explain the part of a sine that resembles a cosine in 50 samples, a few
// percent of the difference.
TEST(Disturbances, LeaveWhatAllGainsShare) {
  const MatrixXd s = signal();
  MatrixXd y = s;
  y.col(0) *= 1.1;
  y.col(2) *= 1.1;
  const Disturbances disturbances = learned();
  const Distance distance = disturbances.distance({y}, {s});
  EXPECT_NEAR(distance.gain(0), 1.0, 1e-3);
  EXPECT_NEAR((distance.explained[0].col(0) - y.col(0)).norm() / s.col(0).norm(), 0.1, 5e-3);
  EXPECT_NEAR(disturbances.common_gain({y}, {s})(2), 1.1, 1e-3);
}

FitKey key(const std::string& text) { return parse_fit_keys(text).at(0); }

std::string refusal(const std::string& text) {
  return refusal_of([&] { parse_fit_keys(text); });
}

TEST(FitKey, HasItsBoundsInSi) {
  const FitKey stiffness = key("sensors.pad.k_normal: {min: 2 N/mm, max: 6000}");
  EXPECT_EQ(stiffness.path, "sensors.pad.k_normal");
  EXPECT_EQ(stiffness.min, 2000.0);
  EXPECT_EQ(stiffness.max, 6000.0);
  EXPECT_EQ(stiffness.quantity, Quantity::stiffness);
  EXPECT_FALSE(stiffness.each);
  EXPECT_EQ(stiffness.value(0.25), 3000.0);
  EXPECT_EQ(stiffness.place(5000.0), 0.75);
  EXPECT_EQ(stiffness.text(3210.0), "3.21 N/mm");
}

// The middle of 1 and 100 by their logarithms is 10.
TEST(FitKey, IsSearchedByItsLogarithm) {
  const FitKey friction = key("friction.scale: {draw: log_uniform, min: 1, max: 100, each: true}");
  EXPECT_TRUE(friction.each);
  EXPECT_DOUBLE_EQ(friction.value(0.5), 10.0);
  EXPECT_DOUBLE_EQ(friction.place(10.0), 0.5);
}

TEST(FitKey, SeveralStandInOneMap) {
  EXPECT_EQ(parse_fit_keys("{motion.tilt.0: {min: -1 deg, max: 1 deg}, lag: {min: 0 s, max: 1 ms}}").size(), 2U);
}

TEST(FitKey, RefusesWhatIsNoBound) {
  EXPECT_THAT(refusal("friction.scale"), mentions({"KEY", "min", "max"}));
  EXPECT_THAT(refusal("friction.scale: 0.5"), mentions({"friction.scale", "0.5"}));
  EXPECT_THAT(refusal("friction.scale: {min: 0.5}"), mentions({"max", "friction.scale"}));
  EXPECT_THAT(refusal("friction.scale: {min: 0.5, mox: 1}"), mentions({"mox", "max"}));
  EXPECT_THAT(refusal("friction.scale: {min: 1, max: 0.5}"), mentions({"min", "1", "max", "0.5"}));
  EXPECT_THAT(refusal("motion.compression: {min: 1 mm, max: 2 N}"), mentions({"motion.compression.max", "2 N"}));
  EXPECT_THAT(refusal("motion.compression: {min: one, max: 2 mm}"), HasSubstr("motion.compression.min: "));
  EXPECT_THAT(refusal("friction.scale: {min: 0, max: 1, draw: log_uniform}"), mentions({"min", "0", "log_uniform"}));
  EXPECT_THAT(refusal("friction.scale: {min: 0, max: 1, draw: normal}"), mentions({"normal", "uniform", "log_uniform"}));
}

// Each of the five sensors, with one parameter of its own.

struct Case {
  const char* type;
  const char* fit;
  const char* compressions;
};

// A foam must be pressed deeply to show more than noise.
class EachSensor : public slipbench::testing::FolderTest, public ::testing::WithParamInterface<Case> {};

// With the sensor's typical electronics, and a seed for the truth that is another device than that
// of the fit.
TEST_P(EachSensor, IsFitted) {
  const std::string scene = path("scene.yaml");
  std::ofstream(scene) << fmt::format(R"(slipbench: 1
duration: 1.6 s
time_step: auto
seed: 3
surface: {{material: acrylic}}
motion: {{kind: stage, compression: 0.6 mm, start: 0.9 s, speed: 3 mm/s}}
sensors:
  pad: {{type: {}, electronics: typical}}
sweep:
  motion.compression: [{}]
)",
                                      GetParam().type, GetParam().compressions);
  Options options;
  options.scene_path = scene;
  options.keys = parse_fit_keys(GetParam().fit);
  options.synthetic_truth = true;
  options.starts = 1;
  const Json result = calibrate(options, program_catalogues()).json;
  const Json& parameter = result.at("parameters").at(0);
  EXPECT_TRUE(parameter.at("determined").get<bool>());
  // Limit for the stiffness: 3 %.
  EXPECT_NEAR(parameter.at("error").get<double>() / parameter.at("truth").get<double>(), 0.0, 0.03);
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, EachSensor,
    ::testing::Values(Case{"papillarray", "sensors.pad.k_normal: {min: 3 N/mm, max: 12 N/mm}", "0.4 mm, 0.7 mm"},
                      Case{"nib_pad", "sensors.pad.post: {min: 5 N/mm, max: 20 N/mm}", "0.4 mm, 0.7 mm"},
                      Case{"piezo_skin", "sensors.pad.k_normal: {min: 10 N/mm, max: 40 N/mm}", "0.4 mm, 0.7 mm"},
                      Case{"myrmex", "sensors.pad.thickness: {min: 3 mm, max: 8 mm}", "1.5 mm, 2.5 mm"},
                      Case{"biotac_sp", "sensors.pad.gap: {min: 0.3 mm, max: 0.8 mm}", "0.4 mm, 0.7 mm"}),
    [](const auto& info) { return std::string(info.param.type); });

}  // namespace
}  // namespace slipbench::calibrate::recordings_test

#include "tools/program/calibrate/recordings.h"

#include <cmath>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"

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

// The mean of a straight line over a stretch is its value in the middle, whatever the steps of the samples.
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
  EXPECT_EQ(refusal(), "r: holds s0 (other) and the scene pad (meter); allowed: a sensor that both have");
  real.type = "meter";
  real.channels.front().shape = {2};
  real.channels.front().values.resize(4);
  EXPECT_EQ(refusal(), "r: pad/value has [2] values a sample and the scene's sensor []; allowed: the same");
}

// As many values in arrays of other names, or of another sensor, are no recording of the same.
TEST(SameColumns, AreToldByTheirNames) {
  const SensorRecord pad = sensor_of({0.0, 1.0}, {0.0F, 0.0F});
  SensorRecord other = pad;
  other.channels.front().name = "current";
  const auto refusal = [&] {
    return slipbench::refusal_of([&] { check_same_columns("b", columns_of(other), "a", columns_of(pad)); });
  };
  EXPECT_EQ(refusal(), "b: holds pad/current and a holds pad/value; allowed: recordings of one kind");
  other = pad;
  other.name = "second";
  EXPECT_EQ(refusal(), "b: holds second/value and a holds pad/value; allowed: recordings of one kind");
  EXPECT_NO_THROW(check_same_columns("b", columns_of(pad), "a", columns_of(pad)));
}

TEST(ReadRecordings, AreOneAtLeast) {
  EXPECT_EQ(slipbench::refusal_of([] { return read_recordings({}, nullptr); }), ": no recording; allowed: one at least");
}

}  // namespace
}  // namespace slipbench::calibrate::recordings_test

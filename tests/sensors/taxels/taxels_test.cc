#include "sensors/taxels/taxels.h"

#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "sim/api/sensor.h"
#include "sim/contact/contact_labels.h"
#include "tests/expect.h"
#include "tests/oracle/effect_field.h"

namespace slipbench::taxels_test {
namespace {

using Values = std::map<std::string, Parameters::Value>;

std::unique_ptr<Sensor> taxels(const Values& values, const std::vector<Named>& electronics = {}) {
  Parameters parameters = defaults_of(taxels_sensor().about.parameters);
  for (const auto& [name, value] : values) parameters.set(name, value);
  return taxels_sensor().create(parameters, electronics, 7, 0, "skin");
}
std::unique_ptr<Sensor> taxels(std::int64_t rows, std::int64_t columns, double pitch) {
  return taxels({{"rows", rows}, {"columns", columns}, {"pitch", pitch}});
}

const double none = std::nan("");
// Taxel i at x = i mm, flat, with the default stiffness.
NumberTable in_a_row(std::size_t count) {
  NumberTable places;
  for (std::size_t i = 0; i < count; ++i)
    places.rows.push_back({1e-3 * static_cast<double>(i), 0.0, none, none, none, none, none, none});
  return places;
}
// Readings of a sensor under these forces, with elements pressed in by 0.1 mm and sheared by 0.02
// mm along x.
std::vector<float> read(Sensor& sensor, const std::vector<Eigen::Array3d>& forces, double time = 0.0) {
  ContactFrame truth;
  truth.time = time;
  truth.force.resize(3, static_cast<Eigen::Index>(forces.size()));
  for (std::size_t i = 0; i < forces.size(); ++i) truth.force.col(static_cast<Eigen::Index>(i)) = forces[i];
  const auto elements = static_cast<Eigen::Index>(sensor.layout().elements.size());
  truth.element_depth = Eigen::ArrayXd::Constant(elements, 1e-4);
  truth.element_shear = Eigen::RowVector3d(2e-5, 0.0, 0.0).replicate(elements, 1).array();
  const std::span<const float> values = sensor.measure(truth).values;
  return {values.begin(), values.end()};
}
std::string refusal(const Values& values) {
  return scene_refusal_of([&] { static_cast<void>(taxels(values)); });
}

Pose at(double x, double z) {
  Pose pose;
  pose.position = {x, 0.0, z};
  return pose;
}

// Steps to the pose and reads. Force and displacement of taxel i, three values each.
struct Reading {
  const SensorFrame& frame;
  std::size_t taxels;
  [[nodiscard]] double force(std::size_t i, std::size_t axis) const { return frame.values[3 * i + axis]; }
  [[nodiscard]] double displacement(std::size_t i, std::size_t axis) const { return frame.values[3 * (taxels + i) + axis]; }
};
Reading read(Sensor& sensor, Field& field, std::initializer_list<Pose> way) {
  ContactLabels labels(field.layout());
  double time = 0.0;
  for (const Pose& pose : way) {
    field.step(pose, 1e-3);
    labels.update({&field, 1}, time += 1e-3, 1e-3);
  }
  return {sensor.measure(labels.frame()), field.size()};
}

// The frame is a rotation even near half a turn, with its z against the axis.
TEST(ElementFrame, LooksAgainstItsAxis) {
  for (const double aside : {0.0, 3e-8, 1e-6, 0.03, 1.0}) {
    const Eigen::Vector3d axis = Eigen::Vector3d(aside, 0.5 * aside, 1.0).normalized();
    const Eigen::Matrix3d frame = element_frame(axis);
    EXPECT_NEAR((frame * frame.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-14) << aside;
    EXPECT_NEAR((frame.col(2) + axis).norm(), 0.0, 1e-14) << aside;
  }
}

TEST(Taxels, StandInRowsFromTheTopLeft) {
  const auto sensor = taxels(2, 3, 4e-3);
  const auto& elements = sensor->layout().elements;
  ASSERT_EQ(elements.size(), 6U);
  EXPECT_TRUE(elements[0].tip.isApprox(Eigen::Vector3d(-4e-3, 2e-3, 0.0)));
  EXPECT_TRUE(elements[5].tip.isApprox(Eigen::Vector3d(4e-3, -2e-3, 0.0)));
  EXPECT_EQ(sensor->channels()[0].channel_names[5], "T1_FZ");
  EXPECT_EQ(sensor->channels()[1].channel_names[5], "T1_DZ");
}

// Springs of 1,000 and 500 N/m, pressed by 0.1 mm and dragged by 0.02 mm, below mu f_n = 0.1 N: 0.1
// N and 0.01 N against the drag.
TEST(Taxels, ReadForceAndDisplacementOfSprings) {
  const auto sensor = taxels(4, 4, 4e-3);
  Field field(sensor->layout(), Plane{}, {1.0, 1.0});
  const Reading reading = read(*sensor, field, {at(0.0, -1e-4), at(2e-5, -1e-4)});
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_NEAR(reading.force(i, 2), 0.1, 1e-7);
    EXPECT_NEAR(reading.force(i, 0), -0.01, 1e-8);
    EXPECT_NEAR(reading.displacement(i, 2), 1e-4, 1e-10);
    EXPECT_NEAR(reading.displacement(i, 0), -2e-5, 1e-11);
  }
}

// A small sphere under the middle of a half-space: at r the surface sinks by N/(4 pi G r)
// (Boussinesq), and under a small push T it moves by T/(2 pi G r) along the push ahead, T/(4 pi G
// r) beside (Cerruti). A load spread over the contact, with mean squares of x and y of at most
// a^2/2, increases that by up to 3/4 (a/r)^2, 0.75 % at r = 10 a.
TEST(Taxels, ReadHowASkinMovesWhereNothingTouchesIt) {
  constexpr double pitch = 0.2e-3, radius = 20e-3, depth = 0.008e-3, g = 1e5;  // a = 0.4 mm
  const auto sensor = taxels(41, 41, pitch);
  Field field = oracle::field_with_effect(sensor->layout(), {2.0, 2.0}, "elastic_skin",
                                          {{"shear_modulus", g}, {"tolerance", 1e-6}}, Sphere{radius});
  const Reading reading = read(*sensor, field, {at(0.0, radius - depth), at(1e-7, radius - depth)});
  double normal = 0.0, tangential = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    normal += reading.force(i, 2);
    tangential += reading.force(i, 0);
  }
  const std::size_t middle = 41 * 20 + 20, ahead = middle + 20, beside = middle - 41 * 20;
  const double r = 20 * pitch, c = 1.0 / (4.0 * std::numbers::pi * g * r);
  ASSERT_EQ(field.state(ahead), ElementState::detached);
  for (const std::size_t i : {ahead, beside}) EXPECT_NEAR(reading.displacement(i, 2) / (c * normal), 1.0, 0.005);
  EXPECT_NEAR(reading.displacement(ahead, 0) / (2.0 * c * tangential), 1.0, 0.01);
  EXPECT_NEAR(reading.displacement(beside, 0) / (c * tangential), 1.0, 0.01);
}

TEST(Taxels, StandWhereTheSceneSays) {
  NumberTable places{"", {{1e-3, 2e-3, 3e-3, 0.0, -3.0, -4.0, 2e3, 300.0}, {0.0, 0.0, none, none, none, none, none, none}}};
  const auto sensor = taxels({{"places", places}, {"points", std::int64_t{2}}});
  const PadLayout& layout = sensor->layout();
  ASSERT_EQ(layout.elements.size(), 8U);
  EXPECT_EQ(layout.units[1].first, 4U);
  EXPECT_TRUE(layout.elements[0].axis.isApprox(Eigen::Vector3d(0.0, -0.6, -0.8)));
  EXPECT_EQ(layout.elements[4].axis, Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_DOUBLE_EQ(layout.elements[3].k_normal, 500.0);      // a quarter of its own
  EXPECT_DOUBLE_EQ(layout.elements[4].k_tangential, 125.0);  // of the 500 N/m of all
  // A face of 4 mm has its four points 1 mm from its middle, the tilted one along (0, 0.8, -0.6).
  EXPECT_TRUE(layout.elements[4].tip.isApprox(Eigen::Vector3d(-1e-3, -1e-3, 0.0)));
  EXPECT_TRUE(layout.elements[3].tip.isApprox(Eigen::Vector3d(2e-3, 2.8e-3, 2.4e-3)));
}

// A taxel with direction (-0.6, 0, -0.8) has z = (0.6, 0, 0.8), x = (0.8, 0, -0.6), y as the pad.
// For (1, 2, 3) N it reads 0.6 + 2.4 = 3 N along z, 0.8 - 1.8 = -1 N and 2 N of shear, and over 4
// mm by 4 mm 187.5 kPa. Pressed in by 0.1 mm it has moved by 0.1 mm against its direction.
TEST(Taxels, ReadInTheirOwnFrames) {
  NumberTable places{"", {{0.0, 0.0, 0.0, -3.0, 0.0, -4.0, none, none}}};
  const auto sensor =
      taxels({{"places", places},
              {"channels",
               ParameterMap{{"n", "normal_force"}, {"s", "shear"}, {"p", "pressure"}, {"f", "force"}, {"d", "displacement"}}}});
  const std::vector<double> expected{3.0, -1.0, 2.0, 187.5e3, 1.0, 2.0, 3.0, 2e-5 + 0.6e-4, 0.0, 0.8e-4};
  const std::vector<float> found = read(*sensor, {{1.0, 2.0, 3.0}});
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(static_cast<double>(found[i]), expected[i], 1e-6 * std::abs(expected[i]) + 1e-12) << i;
  EXPECT_EQ(sensor->channels()[1].channel_names, (std::vector<std::string>{"T0_SX", "T0_SY"}));
}

// Signals (2 z_0 + x_1, z_1 - z_0) = (2.5, 2) N; the curve through (0, 0), (2, 10), (4, 40) turns
// them into 10 + 0.5*15 = 17.5 and 10. At -1 the first segment is extended: -5.
TEST(Taxels, SignalsGoThroughMatrixAndCurve) {
  NumberTable matrix{"", {{0.0, 0.0, 2.0, 1.0, 0.0, 0.0}, {0.0, 0.0, -1.0, 0.0, 0.0, 1.0}}},
      curve{"", {{0.0, 0.0}, {2.0, 10.0}, {4.0, 40.0}}};
  const ParameterMap signal{{"s", "signal"}};
  const auto mixed = taxels({{"places", in_a_row(2)}, {"channels", signal}, {"matrix", matrix}, {"curve", curve}});
  EXPECT_EQ(mixed->channels()[0].unit, "counts");
  EXPECT_EQ(mixed->channels()[0].channel_names[1], "S1_C");
  EXPECT_THAT(read(*mixed, {{0.0, 9.0, 1.0}, {0.5, 9.0, 3.0}}), ElementsAre(17.5F, 10.0F));
  const auto plain = taxels({{"places", in_a_row(2)}, {"channels", signal}, {"curve", curve}});
  EXPECT_THAT(read(*plain, {{9.0, 9.0, -1.0}, {9.0, 9.0, 3.0}}), ElementsAre(-5.0F, 25.0F));
}

// 8 bits over -10 to 10 N are steps of 20/255 N: 2.01 N is code 153.1 and reads 2 N; 12 N saturates
// at 10 N, -12 N at -10 N.
TEST(Taxels, SaturateAtTheEndsOfTheConverter) {
  Parameters bits;
  bits.set("bits", std::int64_t{8});
  const auto sensor =
      taxels({{"places", in_a_row(2)}, {"channels", ParameterMap{{"n", "normal_force"}}}}, {{"quantisation", bits}});
  const std::vector<float> within = read(*sensor, {{0.0, 0.0, 2.01}, {0.0, 0.0, 5.0}});
  EXPECT_FLOAT_EQ(within[0], 2.0F);
  EXPECT_EQ(sensor->saturated(), 0U);
  EXPECT_THAT(read(*sensor, {{0.0, 0.0, 12.0}, {0.0, 0.0, -12.0}}), ElementsAre(10.0F, -10.0F));
  EXPECT_EQ(sensor->saturated(), 1U);
}

// A force that grows by 1 N per sample, and a scan that takes the whole sample: taxel k of N in the
// scan is read (N - 1 - k)/N of a sample earlier.
TEST(Taxels, AreReadInTheOrderOfTheScan) {
  Parameters scan;
  scan.set("duration", 0.01);
  const std::map<std::string, std::vector<double>> turns{
      {"rows", {0, 1, 2, 3, 4, 5}}, {"columns", {0, 2, 4, 1, 3, 5}}, {"zigzag", {0, 1, 2, 5, 4, 3}}};
  for (const auto& [order, turn] : turns) {
    const auto sensor = taxels({{"rows", std::int64_t{2}},
                                {"columns", std::int64_t{3}},
                                {"channels", ParameterMap{{"n", "normal_force"}}},
                                {"scan_order", order}},
                               {{"scan", scan}});
    static_cast<void>(read(*sensor, std::vector<Eigen::Array3d>(6, {0.0, 0.0, 1.0})));
    const std::vector<float> found = read(*sensor, std::vector<Eigen::Array3d>(6, {0.0, 0.0, 2.0}), 0.01);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(static_cast<double>(found[i]), 2.0 - (5.0 - turn[i]) / 6.0, 1e-6) << order << i;
  }
}

TEST(Taxels, AreRefusedWithWhatIsAllowed) {
  const Parameters::Value signal = ParameterMap{{"s", "signal"}};
  const NumberTable two{"", {{1.0, 2.0}}}, back{"", {{0.0, 1.0}, {0.0, 2.0}}};
  NumberTable bad = in_a_row(2);
  bad.rows[1][5] = 0.0;
  EXPECT_THAT(refusal({{"places", bad}}), refused_at("sensors.skin.places", {"taxel 1", "nx"}));
  bad.rows[1][5] = none;
  bad.rows[1][6] = -1.0;
  EXPECT_THAT(refusal({{"places", bad}}), mentions({"taxel 1", "stiffness", "0 N/m"}));
  EXPECT_THAT(refusal({{"places", in_a_row(2)}, {"rows", std::int64_t{3}}}), StartsWith("sensors.skin.places | "));
  EXPECT_THAT(refusal({{"places", in_a_row(2)}, {"pitch", 2e-3}}), mentions({"rows", "columns", "pitch", "scan_order"}));
  EXPECT_THAT(refusal({{"channels", ParameterMap{{"t", "force"}}}}), StartsWith("sensors.skin.channels.t | "));
  EXPECT_THAT(refusal({{"channels", ParameterMap{{"a", "force"}, {"b", "force"}}}}), mentions({"force", "another channel"}));
  EXPECT_THAT(refusal({{"matrix", two}}), refused_at("sensors.skin.matrix", {"signal", "channel"}));
  EXPECT_THAT(refusal({{"channels", signal}, {"matrix", two}}), mentions({"2", "48", "taxel"}));
  EXPECT_THAT(refusal({{"channels", signal}, {"curve", two}}), mentions({"points", "two"}));
  EXPECT_THAT(refusal({{"channels", signal}, {"curve", back}}), mentions({"input 0"}));
  EXPECT_THAT(refusal({{"range", std::vector<double>{1.0, 1.0}}}), mentions({"lowest", "highest"}));
  EXPECT_THAT(refusal({{"rows", std::int64_t{64}}, {"columns", std::int64_t{64}}, {"points", std::int64_t{2}}}),
              mentions({"16384", "4096"}));
}

}  // namespace
}  // namespace slipbench::taxels_test

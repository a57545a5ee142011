#include "sensors/taxels/taxels.h"

#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "sim/core/sensor.h"
#include "sim/field/contact_labels.h"
#include "tests/oracle/effect_field.h"

namespace slipbench::taxels_test {
namespace {

std::unique_ptr<Sensor> taxels(std::int64_t rows, std::int64_t columns, double pitch) {
  Parameters parameters = defaults_of(taxels_sensor().about.parameters);
  parameters.set("rows", rows);
  parameters.set("columns", columns);
  parameters.set("pitch", pitch);
  return taxels_sensor().create(parameters, {}, 7, 0, "skin");
}

Pose at(double x, double z) {
  Pose pose;
  pose.position = {x, 0.0, z};
  return pose;
}

// Steps to the pose and reads: force and displacement of taxel i, three values each.
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

TEST(Taxels, StandInRowsFromTheTopLeft) {
  const auto sensor = taxels(2, 3, 4e-3);
  const auto& elements = sensor->layout().elements;
  ASSERT_EQ(elements.size(), 6U);
  EXPECT_TRUE(elements[0].tip.isApprox(Eigen::Vector3d(-4e-3, 2e-3, 0.0)));
  EXPECT_TRUE(elements[5].tip.isApprox(Eigen::Vector3d(4e-3, -2e-3, 0.0)));
  EXPECT_EQ(sensor->channels()[0].channel_names[5], "T1_FZ");
  EXPECT_EQ(sensor->channels()[1].channel_names[5], "T1_DZ");
}

// Springs of 1,000 and 500 N/m, pressed by 0.1 mm and dragged by 0.02 mm, below mu f_n = 0.1 N: 0.1 N and 0.01 N against the drag.
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

// A small sphere under the middle of a half-space: at r the surface sinks by N/(4 pi G r) (Boussinesq), and under a small push T by
// T/(2 pi G r) along it ahead, T/(4 pi G r) beside (Cerruti). A load spread over the contact, with squares of x and y of a^2/2 in the mean at most,
// makes that up to 3/4 (a/r)^2 more, 0.75 % at r = 10 a.
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

}  // namespace
}  // namespace slipbench::taxels_test

// Normal load, shear and curl of made-up images against closed forms.
#include "detectors/nib/features.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace slipbench::nib {
namespace {

// The field of a function of place, in taxel distances east and north of the centre.
ShearField field_of(const std::function<Eigen::Vector2d(double, double)>& shear) {
  ShearField field;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    field.shear[taxel] = shear(static_cast<double>(taxel % 3) - 1.0, 1.0 - static_cast<double>(taxel / 3));
  }
  return field;
}

TEST(ShearField, SumsAndSubtractsElectrodes) {
  std::array<double, taxels * electrodes> change{};
  // Taxel 5, east of the centre: W 1, N 20, E 300, S 4000.
  change[20] = 1.0;
  change[21] = 20.0;
  change[22] = 300.0;
  change[23] = 4000.0;
  const ShearField field = shear_field(change);
  EXPECT_EQ(field.normal[5], 4321.0);
  EXPECT_EQ(field.shear[5], Eigen::Vector2d(299.0, -3980.0));
  EXPECT_EQ(field.total_normal(), 4321.0);
  EXPECT_EQ(field.total_shear(), Eigen::Vector2d(299.0, -3980.0));
}

TEST(Curl, OfATranslationIsNothing) {
  const ShearField field = field_of([](double, double) { return Eigen::Vector2d(30.0, -70.0); });
  EXPECT_NEAR(curl(field), 0.0, 1e-12);
  EXPECT_NEAR(normalised_curl(field), 0.0, 1e-13);
  EXPECT_EQ(normalised_curl(ShearField{}), 0.0);
}

// F = w (-y, x) has curl 2 w. Its vectors have the lengths w (four of them), sqrt(2) w (four) and 0.
TEST(Curl, OfARigidRotationIsTwiceItsRate) {
  for (const double w : {12.5, -3.0}) {
    const ShearField field = field_of([w](double x, double y) { return Eigen::Vector2d(-w * y, w * x); });
    EXPECT_NEAR(curl(field), 2.0 * w, 1e-12);
    EXPECT_NEAR(normalised_curl(field), std::copysign(9.0 / (2.0 + 2.0 * std::sqrt(2.0)), w), 1e-12);
  }
}

// About a centre that is off by c the rotation has a translation more, whose curl is nothing: the counts stay, their share falls.
TEST(Curl, OfARotationAboutAnotherPointIsTheSameInCounts) {
  const ShearField field = field_of([](double x, double y) { return Eigen::Vector2d(-5.0 * y, 5.0 * (x + 100.0)); });
  EXPECT_NEAR(curl(field), 10.0, 1e-10);
  EXPECT_NEAR(normalised_curl(field), 10.0 / 500.0, 1e-5);  // the mean length is 500 (1 + order 1e-4/3)
}

// A spread, F = (x, y), a shear with no rotation, F = (y, x), and a saddle, F = (x, -y), have none.
TEST(Curl, SeesNoSpreadAndNoStrain) {
  EXPECT_NEAR(curl(field_of([](double x, double y) { return Eigen::Vector2d(x, y); })), 0.0, 1e-12);
  EXPECT_NEAR(curl(field_of([](double x, double y) { return Eigen::Vector2d(y, x); })), 0.0, 1e-12);
  EXPECT_NEAR(curl(field_of([](double x, double y) { return Eigen::Vector2d(x, -y); })), 0.0, 1e-12);
}

// Tangential shear at the corners alone: sum r F/6 over 4 F/9 is sqrt(2) 9/6, the most that there is.
TEST(Curl, HasABound) {
  const ShearField field =
      field_of([](double x, double y) { return x != 0.0 && y != 0.0 ? Eigen::Vector2d(-y, x) : Eigen::Vector2d(0.0, 0.0); });
  EXPECT_NEAR(normalised_curl(field), 1.5 * std::sqrt(2.0), 1e-12);
}

}  // namespace
}  // namespace slipbench::nib

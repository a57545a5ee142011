// Oracle 7: sliding along d on an elliptic cone with mu_1 along the grain and mu_2 across it.
// Maximum dissipation gives
//   f = -f_n (mu_1^2 d_1, mu_2^2 d_2)/sqrt(mu_1^2 d_1^2 + mu_2^2 d_2^2):
// the force lies on the ellipse and slip is normal to the ellipse, so the force is opposite to the
// slide only if d is an axis.
#include <numbers>

#include <gtest/gtest.h>

#include "tests/oracle/effect_field.h"
#include "tests/oracle/pads.h"

namespace slipbench::oracle::anisotropic_cone_test {
namespace {

constexpr double k_n = 7100.0, compression = 1e-3, mu = 0.5, ratio = 0.6;

TEST(AnisotropicCone, ForceOfASteadySlideHasTheClosedFormAtAnyAngle) {
  for (const double grain : {0.0, 0.4}) {
    for (int sixteenth = 0; sixteenth < 16; ++sixteenth) {
      const double angle = sixteenth * std::numbers::pi / 8.0;
      Field field = field_with_effect(nine_pillars(), {mu, mu}, "anisotropic_friction", {{"ratio", ratio}, {"angle", grain}});
      ContactFrame last;
      // The stretch turns into its steady direction within a few times mu f_n/k_t = 0.9 mm of
      // travel.
      drive(
          field, 1e-3, 4.0,
          [&](double t) {
            return turned(0.0, {4e-3 * t * std::cos(angle), 4e-3 * t * std::sin(angle), -compression});
          },
          [&](const ContactFrame& frame) { last = frame; });
      const double d1 = std::cos(angle - grain), d2 = std::sin(angle - grain);
      const double mu1 = mu, mu2 = ratio * mu;
      const double size = std::sqrt(mu1 * mu1 * d1 * d1 + mu2 * mu2 * d2 * d2);
      const double f1 = -mu1 * mu1 * d1 / size, f2 = -mu2 * mu2 * d2 / size;
      const double fx = f1 * std::cos(grain) - f2 * std::sin(grain), fy = f1 * std::sin(grain) + f2 * std::cos(grain);
      const double load = k_n * compression;
      EXPECT_EQ(last.unit_state[4], UnitState::slip);
      EXPECT_NEAR(last.force(0, 4), load * fx, 1e-3 * load * mu) << "angle " << angle << ", grain " << grain;
      EXPECT_NEAR(last.force(1, 4), load * fy, 1e-3 * load * mu) << "angle " << angle << ", grain " << grain;
      EXPECT_NEAR(last.margin[4], 0.0, 1e-9);
    }
  }
}

TEST(AnisotropicCone, OnsetAlongAndAcrossTheGrain) {
  const double k_t = 3900.0, speed = 4e-3;
  for (const auto& [angle, mu_there] : {std::pair{0.0, mu}, std::pair{std::numbers::pi / 2.0, ratio * mu}}) {
    Field field = field_with_effect(nine_pillars(), {mu, mu}, "anisotropic_friction", {{"ratio", ratio}, {"angle", 0.0}});
    FirstTimes first(9, EventKind::slip);
    drive(
        field, 1e-3, 0.3,
        [&, a = angle](double t) {
          return turned(0.0, {speed * t * std::cos(a), speed * t * std::sin(a), -compression});
        },
        std::ref(first));
    const double exact = mu_there * k_n * compression / (k_t * speed);
    EXPECT_NEAR(first.times()[4], exact, 1e-3 * exact);
  }
}

}  // namespace
}  // namespace slipbench::oracle::anisotropic_cone_test

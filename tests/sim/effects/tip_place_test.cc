// Effects that depend on position use the position of the tip.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::tip_place_test {
namespace {

constexpr double k_n = 1000.0, k_t = 600.0, depth = 1e-3, mu = 0.5;
const Wanted ridges{"texture", {{"height", 30e-6}, {"wavelength", 1e-3}}};
const Wanted patches{"patchy_friction", {{"sd", 0.2}}};

TEST(TipPlace, StuckTipIsSilentToTheBitWhileItsRootMoves) {
  // mu f_n = 0.5 N stretches a spring of 600 N/m by up to 0.8 mm; the root moves to and fro by 0.3
  // mm, also through the origin, where the difference of two positions rounds most.
  for (const double centre : {0.0, 1.3e-4, -0.07}) {
    for (const bool grain : {false, true}) {
      std::vector<Wanted> effects{ridges, patches};
      if (grain) effects.push_back({"anisotropic_friction", {{"ratio", 0.9}}});
      Field field = field_with(one_unit(k_n, k_t), {mu, mu}, effects);
      field.step(at(centre, 0.0, -depth), 1e-3);
      field.step(at(centre, 0.0, -depth), 1e-3);
      const double load = field.normal_force(0), limit = field.stick_limit(0);
      EXPECT_NE(load, k_n * depth + 30e-6 * k_n) << "not on a crest by chance";
      for (int tick = 1; tick <= 2000; ++tick) {
        field.step(at(centre + 0.3e-3 * std::sin(0.011 * tick), 0.2e-3 * std::sin(0.017 * tick), -depth), 1e-3);
        ASSERT_EQ(field.state(0), ElementState::stick);
        ASSERT_EQ(field.normal_force(0), load) << tick;
        ASSERT_EQ(field.stick_limit(0), limit) << tick;
      }
    }
  }
}

TEST(TipPlace, StuckTipOnABoxIsSilent) {
  // As on a plane; the anchor is projected onto the face in every step, which rounds.
  const PadLayout pad = one_unit(k_n, k_t);
  Field field(pad, Box{{20e-3, 20e-3, 20e-3}}, {mu, mu}, installed(pad, {ridges, patches}));
  const double top = 20e-3 - depth;
  field.step(at(1e-4, 0.0, top), 1e-3);
  field.step(at(1e-4, 0.0, top), 1e-3);
  const double load = field.normal_force(0), limit = field.stick_limit(0);
  for (int tick = 1; tick <= 2000; ++tick) {
    field.step(at(1e-4 + 0.3e-3 * std::sin(0.011 * tick), 0.0, top), 1e-3);
    ASSERT_EQ(field.state(0), ElementState::stick);
    ASSERT_NEAR(field.normal_force(0), load, 1e-12);
    ASSERT_NEAR(field.stick_limit(0), limit, 1e-12);
  }
}

TEST(TipPlace, SlidingTipMeetsThePatchThatItIsOn) {
  // A slow slide over patches: mu is the map's value at the tip, a stretch behind its root. A
  // second field, set down there, reads the map: in its first step a tip is under its root.
  const double step = 2e-6;
  Field sliding = field_with(one_unit(k_n, k_t), {mu, mu}, {patches});
  double worst = 0.0, worst_at_root = 0.0;
  for (int tick = 0; tick <= 4000; ++tick) {
    sliding.step(at(step * tick, 0.0, -depth), 1e-3);
    if (tick < 1000 || tick % 100 != 0) continue;
    const auto mu_at = [&](double x) {
      Field reader = field_with(one_unit(k_n, k_t), {mu, mu}, {patches});
      reader.step(at(x, 0.0, -depth), 1e-3);
      return reader.stick_limit(0) / (k_n * depth);
    };
    ASSERT_EQ(sliding.state(0), ElementState::slip);
    const double tip = sliding.contact_point(0).x() - sliding.stretch(0).x();
    const double met = sliding.tangential_force(0).x() / (k_n * depth);
    worst = std::max(worst, std::abs(met - mu_at(tip)));
    worst_at_root = std::max(worst_at_root, std::abs(met - mu_at(step * tick)));
  }
  // At most one step's slip behind: sd mu (2 pi/2 mm) sqrt(2) 2 um = 0.9e-3.
  EXPECT_LT(worst, 0.9e-3);
  EXPECT_GT(worst_at_root, 20e-3) << "the root is 0.8 mm ahead, on other patches";
}

TEST(TipPlace, TurnedRoundSlideSticksWhereTheTipIs) {
  // When the root reverses, the sliding tip stays: ridges then see the tip's own position, not the
  // one that trails the root.
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {ridges});
  double x = 0.0;
  for (int tick = 0; tick < 1000; ++tick) field.step(at(x += 2e-6, 0.0, -depth), 1e-3);
  ASSERT_EQ(field.state(0), ElementState::slip);
  const double tip = field.contact_point(0).x() - field.stretch(0).x();
  for (int tick = 0; tick < 20; ++tick) {
    field.step(at(x -= 10e-6, 0.0, -depth), 1e-3);
    EXPECT_EQ(field.state(0), ElementState::stick);
    EXPECT_NEAR(field.normal_force(0), k_n * (depth + 30e-6 * std::sin(2.0 * 3.14159265358979 / 1e-3 * tip)), 1e-9);
  }
}

}  // namespace
}  // namespace slipbench::testing_effects::tip_place_test

#include "tests/scenes.h"
#include "tools/program/cost/errors.h"

#include <gtest/gtest.h>
#include <numbers>

namespace slipbench::testing {
namespace {

// What stage.yaml and the sensor's parameters say (sensors/papillarray): the tips' depths [m] and places [m], by pillar.
constexpr double mu = 0.5, ratio = 7.1 / 3.9, start = 2.0;  // k_n/k_t of the profile gripper
constexpr std::array<double, 9> depth{0.55e-3, 0.8e-3, 0.55e-3, 0.8e-3, 1e-3, 0.8e-3, 0.55e-3, 0.8e-3, 0.55e-3};
constexpr std::array<std::array<double, 2>, 9> place{
    {{7e-3, 7e-3}, {0, 7e-3}, {-7e-3, 7e-3}, {7e-3, 0}, {0, 0}, {-7e-3, 0}, {7e-3, -7e-3}, {0, -7e-3}, {-7e-3, -7e-3}}};

// Way until a pillar lets go: k_t s = mu k_n d.
double way(std::size_t pillar) { return mu * ratio * depth[pillar]; }

TEST(ClosedForm, OfTranslationIsTheFormulaByHand) {
  const ClosedForm exact = closed_form(stage_scene({}), 0).value();
  ASSERT_EQ(exact.units.size(), 1U);
  ASSERT_EQ(exact.units[0].size(), 9U);
  constexpr double v = 4e-3, a = 50e-3;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    // Up to speed after v^2/(2 a) = 0.16 mm: all ways and their halves are longer.
    const double time = start + way(pillar) / v + v / (2 * a);
    const ClosedForm::Unit& unit = exact.units[0][pillar];
    EXPECT_NEAR(unit.whole.time, time, 1e-13) << pillar;
    EXPECT_EQ(unit.micro.time, unit.whole.time) << pillar;
    EXPECT_NEAR(unit.whole.load_time, way(pillar) / v, 1e-12) << pillar;
  }
}

TEST(ClosedForm, OfSpeedingUpIsTheFormulaByHand) {
  const ClosedForm exact = closed_form(stage_scene({{"motion.speed", "16 mm/s"}}), 0).value();
  constexpr double a = 50e-3;  // up to speed after 2.56 mm, when all have let go
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
  // Turned about Y by -1 degree a tip at x rises by x sin(1 deg), and its own drop shrinks by the cosine.
  const ClosedForm exact =
      closed_form(stage_scene({{"motion.tilt", "[0 deg, -1 deg]"}, {"motion.acceleration", "inf"}}), 0).value();
  const double angle = std::numbers::pi / 180.0;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    const double pressed = 1e-3 - (1e-3 - depth[pillar]) * std::cos(angle) - place[pillar][0] * std::sin(angle);
    EXPECT_NEAR(exact.units[0][pillar].whole.time, start + mu * ratio * pressed / 4e-3, 1e-12) << pillar;
  }
}

TEST(ClosedForm, SaysNeverWhereNothingSlips) {
  // 0.3 mm of way are less than the 0.5 mm that even the corners take.
  const ClosedForm exact = closed_form(stage_scene({{"motion.travel", "0.3 mm"}}), 0).value();
  for (const ClosedForm::Unit& unit : exact.units[0]) EXPECT_TRUE(std::isnan(unit.whole.time));
  // Lifted off with half of the friction used up, a pillar lets go when half of its load is left: at 2 mm/s down and 5 s.
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
  // Bristles that have slipped stick again when the pad turns back: no formula says when all of a pillar slips.
  EXPECT_FALSE(closed_form(stage_scene({{"sensors.pad.bristles", "6"}, {"motion.reverse", "100 ms"}}), 0));
  EXPECT_TRUE(closed_form(stage_scene({{"motion.reverse", "100 ms"}}), 0));
}

// The field, which solves each onset within its step along a straight line, comes as close as that line is to the motion.
TEST(ClosedForm, IsWhatTheFieldComesTo) {
  struct Case {
    std::vector<Override> overrides;
    double bound;  // on the error at 1 ms, a share of the load time; a hundredth of it at 0.1 ms
  };
  // At constant speed the line is the motion. Speeding up it is off by a h^2/8 at most, over the speed at the onset: 50 mm/s2
  // 1e-6 s2/8 /(6 mm/s) = 1 us of the corners' load of 0.08 s. Turning by 30 deg/s the chord is off by r w^2 h^2/8: 1e-6 of the
  // 0.1 s and more.
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

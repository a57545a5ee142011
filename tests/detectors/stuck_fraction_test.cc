#include "detectors/detector_kinds.h"

#include <cmath>

#include "tests/detectors/frames.h"

namespace slipbench::stuck_fraction_test {
namespace {

// A window of 20 frames. The shares and speeds lie between the values of two frames, so that
// rounding decides nothing.
std::unique_ptr<Detector> detector(const FrameSource& source) {
  Parameters parameters = defaults_of(stuck_fraction_detector().about.parameters);
  parameters.set("stuck_share", 0.525);
  parameters.set("moving_speed", 0.4e-3);
  return stuck_fraction_detector().create(parameters, source);
}

constexpr double per_tick = 5e-6;  // m, of a surface at 5 mm/s

// Units under 2, 4 and 6 N begin to slip at mu f_n / (k_t v) = 50, 100 and 150 ms. A unit that has
// slid for x of the window's 20 ms has the speed v (1 - x / 20 ms): first below 0.525 v at x = 10
// ms, and first below 0.4 mm/s of 5 mm/s at x = 19 ms, when the last unit is judged by the friction
// of the others.
TEST(StuckFraction, TellsEachSlipAfterItsShareOfTheWindow) {
  const CoulombPad pad{.normal = {2.0, 4.0, 6.0}};
  const auto three = detector(pad.source(1000.0));
  expect_slips_reported(*three, pad, {60, 110, 169});
}

// At rest within a slide f_t/f_n is mu: gross, until a firmer grip brings it below 0.9 mu. f_t is
// constant, f_n grows by 1.1 and 1.12: 0.4545, 0.4464.
TEST(StuckFraction, AtRestGoesByTheFrictionOfThoseThatSlid) {
  CoulombPad pad{.normal = {2.0, 4.0, 6.0}};
  const auto three = detector(pad.source(1000.0));
  EstimateReader reader(*three);
  for (int tick = 1; tick <= 250; ++tick) reader.next(pad.after(per_tick * tick));
  const std::vector<float> rest = pad.after(per_tick * 250);
  EXPECT_EQ(reader.after(30, rest), PadState::gross);
  const auto firmer = [&rest](float factor) {
    std::vector<float> values = rest;
    for (std::size_t i = 0; i < 3; ++i) values[3 * i + 2] *= factor;
    return values;
  };
  EXPECT_EQ(reader.after(1, firmer(1.1F)), PadState::gross);
  EXPECT_EQ(reader.after(1, firmer(1.12F)), PadState::non_slip);
}

// Before any unit has slid no friction is known: the declared limit of a detector based on tips.
TEST(StuckFraction, TakesAPadThatSlidesAsAWholeForOneAtRest) {
  const CoulombPad pad{.normal = {4.0, 4.0}};
  const auto two = detector(pad.source(1000.0));
  EstimateReader reader(*two);
  for (int tick = 1; tick <= 200; ++tick) ASSERT_EQ(reader.next(pad.after(per_tick * tick)).state, PadState::non_slip) << tick;
}

TEST(StuckFraction, HearsNothingBelowTheLeastFrictionOrWithoutTouch) {
  const CoulombPad smooth{.normal = {2.0, 4.0}, .friction = 0.19};
  const auto low = detector(smooth.source(1000.0));
  EstimateReader on_smooth(*low);
  for (int tick = 1; tick <= 200; ++tick) ASSERT_EQ(on_smooth.next(smooth.after(per_tick * tick)).state, PadState::non_slip);

  // A unit under 0.04 N does not touch: of the other two the lighter one slips, so half.
  const CoulombPad light{.normal = {2.0, 0.04, 4.0}};
  const auto one_off = detector(light.source(1000.0));
  EstimateReader on_two(*one_off);
  for (int tick = 1; tick < 80; ++tick) on_two.next(light.after(per_tick * tick));
  EXPECT_EQ(on_two.next(light.after(per_tick * 80)).stuck_fraction, 0.5);

  const CoulombPad air{.normal = {0.0, 0.0}};
  const SlipEstimate estimate = detector(air.source(1000.0))->update({0.0, air.after(0.0)});
  EXPECT_EQ(estimate.state, PadState::no_contact);
  EXPECT_TRUE(std::isnan(estimate.stuck_fraction));
}

std::string refusal(const FrameSource& source) {
  return refusal_of<SceneValueError>([&] { (void)detector(source); });
}

TEST(StuckFraction, RefusesWhatItCannotRead) {
  EXPECT_EQ(refusal(vector_source({"displacement", "force"}, 9, 250.0)), "accepted");
  EXPECT_THAT(refusal(vector_source({"force"}, 9, 1000.0)),
              refused_at("detector.sensor", {"stuck_fraction", "displacement", "pad"}));
  for (const double rate : {25.0, 120.0}) {  // 0.5 and 2.4 frames
    EXPECT_THAT(refusal(vector_source({"force", "displacement"}, 9, rate)),
                refused_at("detector.window", {"sensors.pad", "20 ms", format_quantity(rate, Quantity::frequency), "1,000,000"}));
  }
}

}  // namespace
}  // namespace slipbench::stuck_fraction_test

#include "detectors/detector_kinds.h"

#include <array>
#include <utility>

#include "detectors/channel.h"
#include "tests/detectors/frames.h"
#include "tests/expect.h"

namespace slipbench::shear_rate_test {
namespace {

// A window of 3 frames of 10 ms: 0 for three frames, then the change over 30 ms.
TEST(Window, RatesBeginOnceAWindowHasPassed) {
  Window window(0.03, 1, vector_source({"force"}, 1, 100.0), "shear_rate");
  const auto rate = [&](double value) { return window.rates(std::array{value})[0]; };
  for (const double value : {5.0, 7.0, 9.0}) EXPECT_EQ(rate(value), 0.0);
  EXPECT_DOUBLE_EQ(rate(8.0), (8.0 - 5.0) / 0.03);
  EXPECT_DOUBLE_EQ(rate(8.5), (8.5 - 7.0) / 0.03);
}

// A window of 20 frames. 0.525 lies between the values of two frames, so that rounding decides
// nothing.
std::unique_ptr<Detector> detector(const FrameSource& source, double release = 0.9) {
  Parameters parameters = defaults_of(shear_rate_detector().about.parameters);
  parameters.set("following", 0.525);
  parameters.set("release", release);
  return shear_rate_detector().create(parameters, source);
}

constexpr double per_tick = 5e-6;  // m, of a surface at 5 mm/s

// Returns `values` with normal forces multiplied by `factor`.
std::vector<float> firmer(std::vector<float> values, std::size_t units, float factor) {
  for (std::size_t i = 0; i < units; ++i) values[3 * i + 2] *= factor;
  return values;
}

// Units under 2, 4 and 6 N begin to slip at mu f_n / (k_t v) = 50, 100 and 150 ms. After x of the
// window's 20 ms the rate is k_t v (1 - x / 20 ms): first below 0.525 k_t v at x = 10 ms.
TEST(ShearRate, TellsEachSlipAfterItsShareOfTheWindow) {
  const CoulombPad pad{.normal = {2.0, 4.0, 6.0}};
  const auto three = detector(pad.source(1000.0));
  expect_slips_reported(*three, pad, {60, 110, 160});
}

// Friction falls from 0.5 to 0.4 when the unit begins to slip at 100 ms: 0.4 N of 2 N, in a window
// whose other 19 frames added 0.38 N. Slip is reported at once.
TEST(ShearRate, TellsADropAtOnce) {
  CoulombPad pad{.normal = {4.0}};
  const auto one = detector(pad.source(1000.0));
  EstimateReader reader(*one);
  for (int tick = 1; tick <= 100; ++tick) ASSERT_EQ(reader.next(pad.after(per_tick * tick)).state, PadState::non_slip) << tick;
  pad.friction = 0.4;
  EXPECT_EQ(reader.next(pad.after(per_tick * 101)).state, PadState::gross);
}

// f_t is constant, f_n grows by 1.1 and 1.12: f_t/f_n falls to 0.909 and 0.893 of its value.
TEST(ShearRate, AFirmerGripReleasesIt) {
  const CoulombPad pad{.normal = {2.0, 4.0}};
  const auto two = detector(pad.source(1000.0));
  EstimateReader reader(*two);
  for (int tick = 1; tick <= 200; ++tick) reader.next(pad.after(per_tick * tick));
  const std::vector<float> rest = pad.after(per_tick * 200);
  EXPECT_EQ(reader.after(100, rest), PadState::gross);
  EXPECT_EQ(reader.after(1, firmer(rest, 2, 1.1F)), PadState::gross);
  EXPECT_EQ(reader.after(1, firmer(rest, 2, 1.12F)), PadState::non_slip);
  EXPECT_EQ(reader.after(100, rest), PadState::non_slip) << "its loading has ended";
}

// Twice the normal force after 200 ms of sliding: the shear grows again, and reaches 0.525 of its
// rate over the window 11 ms later.
TEST(ShearRate, AUnitThatFollowsAgainSticks) {
  const CoulombPad pad{.normal = {2.0}};
  const auto one = detector(pad.source(1000.0), 0.1);
  EstimateReader reader(*one);
  for (int tick = 1; tick <= 200; ++tick) reader.next(pad.after(per_tick * tick));
  for (int tick = 1; tick <= 30; ++tick) {
    std::vector<float> values = pad.after(1.0);
    values[0] += static_cast<float>(pad.stiffness * per_tick * tick);
    ASSERT_EQ(reader.next(firmer(values, 1, 2.0F)).state, tick < 11 ? PadState::gross : PadState::non_slip) << tick;
  }
}

// A surface that stops at f_t/f_n = 0.3 looks like slip, the declared limit; at 0.15, below
// least_friction, it does not. 2 N and 20 mN per frame: 30 and 15 frames.
TEST(ShearRate, ALoadThatStopsGrowingIsTakenForASlipAboveTheLeastFriction) {
  for (const auto& [stop, state] : {std::pair(30, PadState::gross), std::pair(15, PadState::non_slip)}) {
    const CoulombPad pad{.normal = {2.0}};
    const auto one = detector(pad.source(1000.0));
    EstimateReader reader(*one);
    for (int tick = -20; tick <= stop; ++tick)
      ASSERT_EQ(reader.next(pad.after(per_tick * std::max(tick, 0))).state, PadState::non_slip);
    EXPECT_EQ(reader.after(100, pad.after(per_tick * stop)), state) << stop;
  }
}

// f_n from 2 N to 4 N over 40 frames raises f_t from 0.6 N to 0.9 N, 150 mN per window, and both
// stop: f_t/f_n fell from 0.3 to 0.225, away from any cone. With constant f_n the same shear is a
// slip.
TEST(ShearRate, ShearThatAClosingGripBringsIsNoLoad) {
  for (const auto& [growth, state] : {std::pair(2.0F, PadState::non_slip), std::pair(0.0F, PadState::gross)}) {
    const auto one = detector(vector_source({"force"}, 1, 1000.0));
    EstimateReader reader(*one);
    const auto at = [growth](float share) { return std::vector<float>{0.6F + 0.3F * share, 0.0F, 2.0F + growth * share}; };
    EXPECT_EQ(reader.after(40, at(0.0F)), PadState::non_slip);
    for (int tick = 1; tick <= 40; ++tick) ASSERT_EQ(reader.next(at(static_cast<float>(tick) / 40.0F)).state, PadState::non_slip);
    EXPECT_EQ(reader.after(40, at(1.0F)), state);
  }
}

// 20 mN per window is the least that counts as loading; 0.9 mN per frame are 18 mN.
TEST(ShearRate, AnUnloadedUnitDoesNotSlip) {
  const CoulombPad pad{.normal = {0.06}};
  const auto one = detector(pad.source(1000.0));
  EstimateReader reader(*one);
  for (int tick = 1; tick <= 200; ++tick) {
    ASSERT_EQ(reader.next(pad.after(0.9e-3 / pad.stiffness * tick)).state, PadState::non_slip) << tick;
  }
  EXPECT_EQ(reader.next(CoulombPad{.normal = {0.04}}.after(0.0)).state, PadState::no_contact);
}

// 20 ms are 19.5 samples at 975 Hz: 19 at 950 Hz, 20 at 1 kHz.
TEST(ShearRate, ARateThatDoesNotDivideItsWindowNamesTheNext) {
  EXPECT_THAT(refusal_of([] { (void)detector(vector_source({"force"}, 9, 975.0)); }),
              mentions({"20 ms", "975 Hz", "950 Hz or 1 kHz", "import --rate"}));
  EXPECT_THAT(refusal_of([] { (void)detector(vector_source({"force"}, 9, 20.0)); }), mentions({"at 50 Hz it is one"}));
}

TEST(ShearRate, ReadsForcesAlone) {
  EXPECT_NO_THROW((void)detector(vector_source({"force"}, 9, 1000.0)));
  EXPECT_THROW((void)detector(vector_source({"displacement"}, 9, 1000.0)), SceneValueError);
  EXPECT_THROW((void)detector(vector_source({"force"}, 9, 120.0)), SceneValueError);
}

}  // namespace
}  // namespace slipbench::shear_rate_test

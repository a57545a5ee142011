#include "detectors/detector_kinds.h"

#include <cmath>

#include "tests/detectors/frames.h"

namespace slipbench {
namespace {

std::unique_ptr<Detector> detector(double ratio, const FrameSource& source) {
  Parameters parameters = defaults_of(force_ratio_detector().about.parameters);
  parameters.set("ratio", ratio);
  return force_ratio_detector().create(parameters, source);
}

PadState state_of(Detector& detector, const std::vector<float>& values) { return detector.update({0.0, values}).state; }

// Two units; ratio 0.5, so that f_t = 3 N at an angle (hypot(1.8, 2.4)) slips at f_n = 5.9 N and
// sticks at 6.1 N.
TEST(ForceRatio, CountsTheUnitsThatTouchAndThoseThatSlip) {
  const auto two = detector(0.5, vector_source({"force"}, 2, 1000.0));
  EXPECT_EQ(state_of(*two, {0, 0, 0, 0, 0, 0}), PadState::no_contact);
  EXPECT_EQ(state_of(*two, {1.8F, 2.4F, 6.1F, 1.8F, -2.4F, 6.1F}), PadState::non_slip);
  EXPECT_EQ(state_of(*two, {1.8F, 2.4F, 5.9F, 1.8F, -2.4F, 6.1F}), PadState::incipient);
  EXPECT_EQ(state_of(*two, {1.8F, 2.4F, 5.9F, 1.8F, -2.4F, 5.9F}), PadState::gross);
  // Below 0.05 N a unit does not touch, at any ratio.
  EXPECT_EQ(state_of(*two, {1.8F, 2.4F, 0.049F, 0, 0, 6.1F}), PadState::non_slip);
  EXPECT_EQ(state_of(*two, {1.8F, 2.4F, 0.051F, 0, 0, 6.1F}), PadState::incipient);
  EXPECT_EQ(state_of(*two, {1.8F, 2.4F, -6.0F, 0, 0, 0}), PadState::no_contact);
}

// The law: a unit touches when f_n >= touch. 0.25 is exact as a float.
TEST(ForceRatio, TouchesAtTheThreshold) {
  Parameters parameters = defaults_of(force_ratio_detector().about.parameters);
  parameters.set("touch", 0.25);
  const auto one = force_ratio_detector().create(parameters, vector_source({"force"}, 1, 1000.0));
  EXPECT_EQ(state_of(*one, {0, 0, 0.25F}), PadState::non_slip);
  EXPECT_EQ(state_of(*one, {0, 0, std::nextafter(0.25F, 0.0F)}), PadState::no_contact);
}

TEST(ForceRatio, TellsTheShareThatSticks) {
  const auto two = detector(0.5, vector_source({"force"}, 2, 1000.0));
  const std::vector<float> air(6), both{1, 0, 9, 1, 0, 9}, one{1, 0, 9, 1, 0, 1}, none{1, 0, 1, 1, 0, 1};
  EXPECT_TRUE(std::isnan(two->update({0.0, air}).stuck_fraction));
  EXPECT_EQ(two->update({0.1, both}).stuck_fraction, 1.0);
  EXPECT_EQ(two->update({0.2, one}).stuck_fraction, 0.5);
  EXPECT_EQ(two->update({0.3, none}).stuck_fraction, 0.0);
}

// Units under f_n = 2 N and 4 N on springs k_t = 4 N/mm, dragged at 5 mm/s from t = 0: f_t = k_t v
// t = 20 N/s * t. The ratio 0.4 is exceeded at t = 0.4 f_n / (k_t v) = 40 ms and 80 ms, so slip
// appears first in the frames at 41 ms and 81 ms.
TEST(ForceRatio, SeesTheOnsetInTheFirstFrameAfterTheRatioIsPassed) {
  const auto two = detector(0.4, vector_source({"force"}, 2, 1000.0));
  double incipient = 0.0;
  double gross = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    const double time = 1e-3 * tick;
    // Slightly below the ratio at 40 ms and 80 ms, so that rounding to float does not decide.
    const auto shear = static_cast<float>(20.0 * time - 1e-6);
    const std::array<float, 6> values{shear, 0.0F, 2.0F, 0.0F, -shear, 4.0F};
    const SlipEstimate& estimate = two->update({time, values});
    EXPECT_EQ(estimate.time, time);
    EXPECT_EQ(estimate.latency, 0.0);
    if (incipient == 0.0 && estimate.state == PadState::incipient) incipient = time;
    if (gross == 0.0 && estimate.state == PadState::gross) gross = time;
  }
  EXPECT_EQ(incipient, 41e-3);
  EXPECT_EQ(gross, 81e-3);
}

TEST(ForceRatio, FindsItsChannelAmongOthers) {
  const auto one = detector(0.5, vector_source({"displacement", "force"}, 1, 1000.0));
  EXPECT_EQ(state_of(*one, {9, 9, 9, 0, 0, 1}), PadState::non_slip);
  EXPECT_EQ(state_of(*one, {0, 0, 9, 1, 0, 1}), PadState::gross);
}

TEST(ForceRatio, RefusesASensorWithoutForces) {
  FrameSource source{"skin", "piezo_skin", 1000.0, {{"signal", "1", {8}, {}}, {"force", "N", {9}, {}}}};
  EXPECT_THAT(
      refusal_of<SceneValueError>([&] { detector(0.5, source); }),
      refused_at("detector.sensor", {"force_ratio", "force", "skin", "found: signal, force", "deviation reads any channel"}));
}

// A threshold of 0.05 N would be 0.05 mN in a recording in mN.
TEST(ForceRatio, RefusesForcesInAnotherUnit) {
  FrameSource source = vector_source({"force"}, 9, 1000.0);
  source.channels.front().unit = "mN";
  EXPECT_THAT(refusal_of<SceneValueError>([&] { detector(0.5, source); }),
              refused_at("detector.sensor", {"force_ratio", "force", "in N", "'mN'", "import"}));
  source.channels.front().unit = "counts";
  EXPECT_THAT(refusal_of<SceneValueError>([&] { detector(0.5, source); }),
              refused_at("detector.sensor", {"in N", "'counts'", "what one count is, for example scale: 0.01 N"}));
}

}  // namespace
}  // namespace slipbench

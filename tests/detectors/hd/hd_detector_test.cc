#include "detectors/hd/hd_detector.h"

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "detectors/detector_kinds.h"
#include "tests/detectors/frames.h"
#include "tests/detectors/hd/published.h"
#include "tests/expect.h"

namespace slipbench::hd {
namespace {

const FrameSource papillarray = vector_source({"force", "displacement"}, pillar_count, 1000.0);

Parameters published_parameters() {
  Parameters parameters = defaults_of(detector_parameters());
  parameters.set("memories", published_folder);
  return parameters;
}

using Values = std::array<float, 6 * pillar_count>;

// A frame whose centre pillar is compressed by `compression` [m]; its forces hold other values.
Values pressed(double compression) {
  Values values;
  values.fill(7.0F);
  std::fill(values.begin() + 3 * pillar_count, values.end(), 0.0F);
  values[3 * pillar_count + 3 * centre_pillar + 2] = static_cast<float>(compression);
  return values;
}

// At 1000 Hz every tenth frame is classified: 0, 10, 20. The compression of the centre pillar
// identifies a frame.
TEST(HdDetector, TakesEveryKthFrame) {
  std::vector<float> seen;
  const auto classify = [&seen](std::span<const float> displacement) -> Classified {
    EXPECT_EQ(displacement.size(), 27U);
    seen.push_back(displacement[3 * centre_pillar + 2]);
    return {static_cast<PadState>(seen.size()), 1e-3 * static_cast<double>(seen.size())};
  };
  const auto detector = make_detector(classify, 100.0, {}, papillarray);
  for (std::size_t i = 0; i < 29; ++i) {
    const Values values = pressed(static_cast<double>(i));
    const SlipEstimate& estimate = detector->update({1e-3 * static_cast<double>(i), values});
    EXPECT_EQ(estimate.time, 1e-3 * static_cast<double>(i - i % 10)) << i;
    EXPECT_EQ(static_cast<std::size_t>(estimate.state), 1 + i / 10) << i;
    EXPECT_EQ(estimate.latency, 1e-3 * static_cast<double>(1 + i / 10)) << i;
  }
  EXPECT_EQ(seen, (std::vector{0.0F, 10.0F, 20.0F}));
}

// Slip is reported from the second of two consecutive frames of slip, with the latest class, until
// three consecutive frames are not slip.
TEST(HdDetector, SaysSlipByItsAlarm) {
  constexpr PadState none = PadState::no_contact, hold = PadState::non_slip, part = PadState::incipient, all = PadState::gross;
  const std::vector<PadState> called{none, part, hold, part, all, hold, hold, part, hold, hold, hold, all};
  const std::vector<PadState> expected{none, hold, hold, hold, all, all, all, part, part, part, hold, hold};
  std::size_t next = 0;
  const auto classify = [&](std::span<const float>) { return Classified{called[next++], 0.0}; };
  const auto detector = make_detector(classify, 1000.0, {2, 3, 1}, papillarray);
  for (std::size_t i = 0; i < called.size(); ++i) {
    EXPECT_EQ(detector->update({1e-3 * static_cast<double>(i), pressed(0.0)}).state, expected[i]) << i;
  }
}

// The window of 15 frames at 100 Hz is full with the frame at 140 ms.
TEST(HdDetector, IsSilentUntilItsWindowIsFull) {
  const auto detector = gst_hd_detector().create(published_parameters(), papillarray);
  for (std::size_t i = 0; i < 300; ++i) {
    const Values values = pressed(0.0);
    const SlipEstimate& estimate = detector->update({1e-3 * static_cast<double>(i), values});
    EXPECT_EQ(estimate.state == PadState::no_contact, i < 140) << i;
    EXPECT_EQ(estimate.latency, 0.0);
  }
}

TEST(HdDetector, ReadsTheFolderAndWhatTheSceneSaysDifferently) {
  Parameters parameters = published_parameters();
  SavedModel saved = detector_model(parameters);  // without model.txt
  EXPECT_EQ(saved.model, Model{});
  EXPECT_EQ(saved.quantiser, Quantiser::fixed_point);
  parameters.set("compat", std::string("published_core"));
  parameters.set("ties", std::string("zero"));
  parameters.set("quantiser", std::string("unrounded"));
  saved = detector_model(parameters);
  EXPECT_EQ(saved.model.compat, Compat::published_core);
  EXPECT_EQ(saved.model.ties, Ties::zero);
  EXPECT_EQ(saved.quantiser, Quantiser::unrounded);
}

std::string refusal_at(double rate, const FrameSource& source) {
  return refusal_of<SceneValueError>(
      [&] { make_detector([](std::span<const float>) { return Classified{}; }, rate, {}, source); });
}

TEST(HdDetector, RefusesARateThatDoesNotDivideTheSensors) {
  for (const double rate : {1000.0, 500.0, 250.0, 100.0, 1000.0 / 3.0, 0.1}) EXPECT_EQ(refusal_at(rate, papillarray), "accepted");
  for (const double rate : {2000.0, 1001.0, 999.0, 300.0, 99.99}) {
    EXPECT_THAT(refusal_at(rate, papillarray),
                AllOf(HasSubstr("detector.rate: "), HasSubstr(" does not divide the 1 kHz of sensors.pad")))
        << rate;
  }
}

TEST(HdDetector, RefusesOtherSensors) {
  EXPECT_THAT(refusal_at(100.0, vector_source({"force"}, 9, 1000.0)), mentions({"detector.sensor", "displacement"}));
  EXPECT_THAT(refusal_at(100.0, vector_source({"displacement"}, 8, 1000.0)), mentions({"nine pillars", "papillarray"}));
  FrameSource other = papillarray;
  other.type = "nine_domes";
  EXPECT_THAT(refusal_at(100.0, other), mentions({"pad", "nine_domes"}));
}

TEST(HdDetector, SaysWhereItLookedForMemories) {
  Parameters parameters = published_parameters();
  parameters.set("memories", std::string("/no/such/folder"));
  EXPECT_THAT(refusal_of<SceneValueError>([&] { detector_model(parameters); }),
              HasSubstr("detector.memories: /no/such/folder/AM.hex: "));
}

// Values that are not finite do not reach an engine.
TEST(HdDetector, RefusesWhatIsNotFinite) {
  const auto detector = gst_hd_detector().create(published_parameters(), papillarray);
  Values values = pressed(0.0);
  values[3 * pillar_count + 5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(detector->update({0.0, values}), InputError);
}

}  // namespace
}  // namespace slipbench::hd

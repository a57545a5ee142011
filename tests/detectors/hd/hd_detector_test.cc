#include "detectors/hd/hd_detector.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/core/error.h"
#include "tests/detectors/frames.h"
#include "tests/detectors/hd/published.h"

namespace slipbench::hd {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const FrameSource papillarray = vector_source({"force", "displacement"}, pillar_count, 1000.0);

Parameters published_parameters() {
  Parameters parameters = defaults_of(detector_parameters());
  parameters.set("memories", published_folder);
  return parameters;
}

// Says what it was given: as many frames as contexts are counted, and the last context as the state.
class Listener : public Engine {
 public:
  explicit Listener(std::vector<Frame>& seen) : seen_(seen) {}
  Decision update(const Frame& frame) override {
    seen_.push_back(frame);
    return {static_cast<PadState>(frame.context), {}};
  }
  void reset() override { seen_.clear(); }

 private:
  std::vector<Frame>& seen_;
};

using Values = std::array<float, 6 * pillar_count>;

// A frame whose centre pillar is compressed by `compression` [m], and whose forces would be something else.
Values pressed(double compression) {
  Values values;
  values.fill(7.0F);
  std::fill(values.begin() + 3 * pillar_count, values.end(), 0.0F);
  values[3 * pillar_count + 3 * centre_pillar + 2] = static_cast<float>(compression);
  return values;
}

// At 1000 Hz every tenth frame is classified. Contexts begin at 0.75, 1 and 1.125 mm: frames 0, 10, 20 are 0.5, 0.9375, 1.0625 mm; those
// between are far from that.
TEST(HdDetector, TakesEveryKthFrame) {
  std::vector<Frame> seen;
  const auto detector = make_detector(std::make_unique<Listener>(seen), Quantiser::exact, 100.0, 3e-3, papillarray);
  const std::array<double, 3> compression{0.5e-3, 0.9375e-3, 1.0625e-3};
  for (std::size_t i = 0; i < 29; ++i) {
    const Values values = pressed(i % 10 == 0 ? compression[i / 10] : 3e-3);
    const double time = 1e-3 * static_cast<double>(i);
    const SlipEstimate& estimate = detector->update({time, values});
    EXPECT_EQ(estimate.time, 1e-3 * static_cast<double>(i - i % 10)) << i;
    EXPECT_EQ(estimate.latency, 3e-3);
    EXPECT_EQ(static_cast<std::size_t>(estimate.state), i / 10) << i;
  }
  ASSERT_EQ(seen.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(seen[k].context, k);
}

// The window of 15 frames at 100 Hz is full with the frame at 140 ms.
TEST(HdDetector, IsSilentUntilItsWindowIsFull) {
  const auto detector = make_gst_hd(published_parameters(), papillarray);
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

template <class Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const SceneValueError& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal_of(double rate, const FrameSource& source) {
  std::vector<Frame> seen;
  return refusal([&] { make_detector(std::make_unique<Listener>(seen), Quantiser::exact, rate, 0.0, source); });
}

TEST(HdDetector, RefusesARateThatDoesNotDivideTheSensors) {
  for (const double rate : {1000.0, 500.0, 250.0, 100.0, 1000.0 / 3.0, 0.1}) EXPECT_EQ(refusal_of(rate, papillarray), "accepted");
  for (const double rate : {2000.0, 1001.0, 999.0, 300.0, 99.99}) {
    EXPECT_THAT(refusal_of(rate, papillarray),
                AllOf(HasSubstr("detector.rate: "), HasSubstr(" does not divide the 1 kHz of sensors.pad")))
        << rate;
  }
}

TEST(HdDetector, RefusesOtherSensors) {
  EXPECT_THAT(refusal_of(100.0, vector_source({"force"}, 9, 1000.0)),
              HasSubstr("detector.sensor: the hyperdimensional classifier reads a displacement in three axes"));
  EXPECT_THAT(refusal_of(100.0, vector_source({"displacement"}, 8, 1000.0)),
              HasSubstr("reads the nine pillars of a papillarray"));
  FrameSource other = papillarray;
  other.type = "nine_domes";
  EXPECT_THAT(refusal_of(100.0, other), HasSubstr("'pad' is a nine_domes"));
}

TEST(HdDetector, SaysWhereItLookedForMemories) {
  Parameters parameters = published_parameters();
  parameters.set("memories", std::string("/no/such/folder"));
  EXPECT_THAT(refusal([&] { detector_model(parameters); }), HasSubstr("detector.memories: /no/such/folder/AM.hex: "));
}

// What no displacement can be reaches no engine.
TEST(HdDetector, RefusesWhatIsNotFinite) {
  const auto detector = make_gst_hd(published_parameters(), papillarray);
  Values values = pressed(0.0);
  values[3 * pillar_count + 5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(detector->update({0.0, values}), InputError);
}

}  // namespace
}  // namespace slipbench::hd

// What a network's output means.

#include <gtest/gtest.h>
#include <cmath>
#include <vector>

#include "detectors/network/engine.h"

namespace slipbench::network {
namespace {

// Three classes, of which two slip.
Description three(Output output) {
  Description d;
  d.output = output;
  d.classes = {{"hold", PadState::non_slip}, {"creep", PadState::incipient}, {"slide", PadState::gross}};
  return d;
}

TEST(SlipProbability, OfLogitsIsTheirSoftmax) {
  // exp of 0, log 2, log 5: weights 1, 2, 5, so that slip has 7 of 8.
  const std::vector<float> logits{0.0F, std::log(2.0F), std::log(5.0F)};
  EXPECT_NEAR(slip_probability(three(Output::logits), logits), 0.875, 1e-7);
}

TEST(SlipProbability, OfLargeLogitsIsFinite) {
  EXPECT_EQ(slip_probability(three(Output::logits), std::vector<float>{1e4F, -1e4F, -1e4F}), 0.0);
  EXPECT_EQ(slip_probability(three(Output::logits), std::vector<float>{-1e4F, -1e4F, 1e4F}), 1.0);
}

TEST(SlipProbability, OfProbabilitiesIsTheirSum) {
  EXPECT_NEAR(slip_probability(three(Output::probabilities), std::vector<float>{0.5F, 0.125F, 0.375F}), 0.5, 1e-7);
}

TEST(StateOf, IsTheMostProbableOfThoseThatSlipFromTheThresholdOn) {
  Description d = three(Output::probabilities);
  // Slip has 0.5, of which creep has more, though holding is more probable than either.
  const std::vector<float> output{0.5F, 0.375F, 0.125F};
  d.threshold = 0.5;
  EXPECT_EQ(state_of(d, output), PadState::incipient);
  d.threshold = 0.5625;
  EXPECT_EQ(state_of(d, output), PadState::non_slip);
}

}  // namespace
}  // namespace slipbench::network

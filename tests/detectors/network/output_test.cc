// Meaning of a network's output.

#include <gtest/gtest.h>
#include <cmath>
#include <string>
#include <vector>

#include "detectors/network/engine.h"

namespace slipbench::network {
namespace {

// Three classes, two of which slip.
Description three(Output output) {
  Description d;
  d.output = output;
  d.classes = {{"hold", PadState::non_slip}, {"creep", PadState::incipient}, {"slide", PadState::gross}};
  return d;
}

TEST(SlipProbability, OfLogitsIsTheirSoftmax) {
  // exp of 0, log 2, log 5: weights 1, 2, 5, so that slip has 7/8.
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

// Two consecutive frames begin slip; it lasts at least four frames and until three consecutive ones
// are below.
TEST(AlarmGate, BeginsAndEndsByFramesInARow) {
  AlarmGate gate({.on = 2, .off = 3, .least = 4});
  std::string said;
  for (const char reached : std::string("1011000001101001000")) said += gate.push(reached == '1') ? '1' : '0';
  EXPECT_EQ(said, "0001111000111111110");
  AlarmGate plain({});
  said.clear();
  for (const char reached : std::string("10110")) said += plain.push(reached == '1') ? '1' : '0';
  EXPECT_EQ(said, "10110");
}

TEST(StateOf, IsTheMostProbableOfThoseThatSlipWhereSlipIsSaid) {
  // Among the classes that slip, creep is more probable, although holding is more probable than
  // either.
  const std::vector<float> output{0.5F, 0.375F, 0.125F};
  EXPECT_EQ(state_of(three(Output::probabilities), output, true), PadState::incipient);
  EXPECT_EQ(state_of(three(Output::probabilities), output, false), PadState::non_slip);
}

}  // namespace
}  // namespace slipbench::network

#include "detectors/flip.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace slipbench::flip_test {
namespace {

constexpr double untold = std::numeric_limits<double>::quiet_NaN();

// Returns the same estimate for every frame.
class Saying final : public Detector {
 public:
  explicit Saying(PadState state, double stuck_fraction = untold) {
    estimate_.state = state, estimate_.stuck_fraction = stuck_fraction;
  }

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    return estimate_;
  }

 private:
  SlipEstimate estimate_;
};

FrameSource source_of(std::uint64_t seed, std::uint64_t trial) {
  FrameSource source;
  source.seed = seed;
  source.trial = trial;
  return source;
}

std::vector<PadState> flipped_states(PadState state, double probability, std::uint64_t seed, std::uint64_t trial, int frames) {
  const auto detector = with_flips(std::make_unique<Saying>(state), probability, source_of(seed, trial));
  std::vector<PadState> states;
  for (int k = 0; k < frames; ++k) states.push_back(detector->update({1e-3 * k, {}}).state);
  return states;
}

// Each of the other two classes is returned for n p/2 of n estimates, the right one for n (1 - p),
// with the standard deviation sqrt(n q (1 - q)) of a binomial count of probability q. Six of these
// are exceeded by chance once in 5e8.
TEST(Flip, ReplacesEachClassByTheOthersAlike) {
  constexpr int n = 20'000;
  for (const double p : {0.1, 0.5}) {
    for (const PadState right : {PadState::non_slip, PadState::incipient, PadState::gross}) {
      std::array<int, 4> counts{};
      for (const PadState state : flipped_states(right, p, 7, 3, n)) ++counts[static_cast<std::size_t>(state)];
      EXPECT_EQ(counts[0], 0);
      for (const PadState state : {PadState::non_slip, PadState::incipient, PadState::gross}) {
        const double q = state == right ? 1.0 - p : 0.5 * p;
        EXPECT_NEAR(counts[static_cast<std::size_t>(state)], n * q, 6.0 * std::sqrt(n * q * (1.0 - q))) << "p = " << p;
      }
    }
  }
}

// A detector with accuracy a = 0.8: n (a (1 - p) + (1 - a) p/2) of n estimates are right, because
// half of the flips of a wrong estimate correct it. p = 0.3: 0.56 + 0.03 = 0.59. Given which ones
// were right the count is a sum of independent trials, whose variance is at most n/4.
TEST(Flip, LowersAnAccuracyByTheStatedAmount) {
  constexpr int n = 50'000;
  int right = 0;
  const std::vector<PadState> truly_right = flipped_states(PadState::incipient, 0.3, 1, 0, n * 4 / 5);
  const std::vector<PadState> truly_wrong = flipped_states(PadState::gross, 0.3, 1, 1, n / 5);
  for (const auto& states : {truly_right, truly_wrong}) {
    for (const PadState state : states) right += state == PadState::incipient;
  }
  EXPECT_NEAR(right, 0.59 * n, 6.0 * std::sqrt(0.25 * n));
}

TEST(Flip, WithoutProbabilityIsTheDetectorItself) {
  auto plain = std::make_unique<Saying>(PadState::gross);
  const Detector* const before = plain.get();
  EXPECT_EQ(with_flips(std::move(plain), 0.0, source_of(1, 2)).get(), before);
}

TEST(Flip, WithCertaintyIsNeverRight) {
  for (const PadState state : flipped_states(PadState::incipient, 1.0, 1, 2, 1000)) ASSERT_NE(state, PadState::incipient);
}

TEST(Flip, DrawsFromSeedAndTrialAlone) {
  const auto one = flipped_states(PadState::gross, 0.5, 1, 2, 200);
  EXPECT_EQ(flipped_states(PadState::gross, 0.5, 1, 2, 200), one);
  EXPECT_NE(flipped_states(PadState::gross, 0.5, 2, 2, 200), one);
  EXPECT_NE(flipped_states(PadState::gross, 0.5, 1, 1, 200), one);
}

TEST(Flip, LeavesNoContactAlone) {
  for (const PadState state : flipped_states(PadState::no_contact, 1.0, 1, 2, 100)) ASSERT_EQ(state, PadState::no_contact);
}

// A frame of the same time repeats an old estimate, which keeps its replacement.
TEST(Flip, DrawsOnceAnEstimate) {
  const auto detector = with_flips(std::make_unique<Saying>(PadState::gross), 0.5, source_of(1, 2));
  const std::vector<PadState> each = flipped_states(PadState::gross, 0.5, 1, 2, 100);
  for (int k = 0; k < 100; ++k) {
    for (int again = 0; again < 3; ++again)
      ASSERT_EQ(detector->update({1e-3 * k, {}}).state, each[static_cast<std::size_t>(k)]) << k;
  }
}

TEST(Flip, TellsTheStuckFractionOfTheNewClass) {
  const auto detector = with_flips(std::make_unique<Saying>(PadState::incipient, 0.7), 0.5, source_of(1, 2));
  const auto without = with_flips(std::make_unique<Saying>(PadState::incipient), 0.5, source_of(1, 2));
  std::array<int, 4> seen{};
  for (int k = 0; k < 100; ++k) {
    const SlipEstimate estimate = detector->update({1e-3 * k, {}});
    ++seen[static_cast<std::size_t>(estimate.state)];
    EXPECT_EQ(estimate.stuck_fraction, estimate.state == PadState::non_slip ? 1.0
                                       : estimate.state == PadState::gross  ? 0.0
                                                                            : 0.7);
    EXPECT_TRUE(std::isnan(without->update({1e-3 * k, {}}).stuck_fraction));
  }
  for (const std::size_t state : {1U, 2U, 3U}) EXPECT_GT(seen[state], 0);
}

}  // namespace
}  // namespace slipbench::flip_test

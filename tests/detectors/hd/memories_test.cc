// Random memories, and prototypes from query vectors.
#include "detectors/hd/memories.h"

#include <gtest/gtest.h>

#include "detectors/hd/engine.h"
#include "sim/core/error.h"
#include "sim/core/random.h"

namespace slipbench::hd {
namespace {

std::size_t ones(const Hypervector& vector) { return hamming(vector, Hypervector(vector.dimension())); }

TEST(Memories, LevelsLieOnAStraightWayBetweenOrthogonalEnds) {
  const Memories memories = generate({}, 1);
  ASSERT_EQ(memories.level.size(), 21U);
  for (std::size_t k = 0; k < 21; ++k) {
    for (std::size_t l = k; l < 21; ++l) ASSERT_EQ(hamming(memories.level[k], memories.level[l]), 25 * (l - k)) << k << " " << l;
  }
  ASSERT_EQ(memories.context.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t l = k; l < 4; ++l) {
      ASSERT_EQ(hamming(memories.context[k], memories.context[l]), 500 * l / 3 - 500 * k / 3) << k << " " << l;
    }
  }
  EXPECT_EQ(ones(memories.level[0]), 500U);
  EXPECT_EQ(ones(memories.context[0]), 500U);
}

TEST(Memories, ItemsAreBalancedAndNearlyOrthogonal) {
  const Memories memories = generate({}, 1);
  ASSERT_EQ(memories.item.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(ones(memories.item[i]), 500U);
    for (std::size_t j = 0; j < i; ++j) {
      // Distances of random balanced vectors: mean 500, standard deviation sqrt(1000)/2 = 15.8; six
      // standard deviations are 95.
      EXPECT_NEAR(static_cast<double>(hamming(memories.item[i], memories.item[j])), 500.0, 95.0);
    }
  }
}

TEST(Memories, DependOnSeedAloneAndTheirStreamsDiffer) {
  EXPECT_EQ(generate({}, 7), generate({}, 7));
  const Memories memories = generate({}, 7), other = generate({}, 8);
  EXPECT_NE(memories.item, other.item);
  EXPECT_NE(memories.level, other.level);
  EXPECT_NE(memories.context, other.context);
  EXPECT_NE(memories.level[0], memories.context[0]);
}

TEST(Memories, ShapesAreChecked) {
  EXPECT_THROW(generate({.dimension = 7}, 1), InputError);
  EXPECT_THROW(generate({.dimension = 65536}, 1), InputError);
  EXPECT_THROW(generate({.window = 1001}, 1), InputError);
  const Memories memories = generate({.dimension = 8}, 1);
  EXPECT_NO_THROW(check({.dimension = 8}, memories, false));
  EXPECT_THROW(check({.dimension = 8}, memories, true), InputError);  // not trained
}

// All levels are +1. The two graphs with edges then give +10 times their names, here +1 and -1, and
// cancel; the third gives its name, +1. With `plus` pillars named +1 the sum is 1 + plus - (9 -
// plus) = 2 plus - 8.
TEST(Bundle, IsTheMajorityAndTiesFollowTheRule) {
  for (const Ties ties : {Ties::one, Ties::zero}) {
    for (const std::size_t plus : {3U, 4U, 5U}) {
      const Model model{.dimension = 8, .window = 1, .ties = ties};
      Hypervector one(8);
      for (std::size_t i = 0; i < 8; ++i) one.set(i, true);
      const Hypervector zero(8);
      Memories memories;
      memories.item.assign(9, zero);
      std::fill_n(memories.item.begin(), plus, one);
      memories.item.insert(memories.item.end(), {one, zero, one});
      memories.level.assign(level_count, one);
      memories.context.assign(context_count, one);
      const bool expected = plus == 4 ? ties == Ties::one : plus > 4;
      for (const auto& encoder : {make_reference_encoder(model, memories), make_kernel_encoder(model, memories)}) {
        const Hypervector* const query = encoder->encode(Frame{});
        ASSERT_NE(query, nullptr);
        EXPECT_EQ(*query, expected ? one : zero) << plus;
      }
    }
  }
}

struct Training : testing::Test {
  Model model_{.dimension = 8};
  Memories memories_ = generate(model_, 1);
  static Hypervector bits(const char* hex) { return from_hex(hex, 8); }
};

TEST_F(Training, PrototypesAreMajoritiesOfTheirClass) {
  model_.context_driven = false;
  Prototypes prototypes(model_, memories_);
  for (const char* const query : {"f0", "cc", "aa"}) prototypes.add(bits(query), 0, PadState::incipient);
  prototypes.add(bits("35"), 0, PadState::gross);
  const std::vector<Hypervector> memory = prototypes.bundle();
  ASSERT_EQ(memory.size(), 3U);
  EXPECT_EQ(to_hex(memory[1]), "e8");  // 1111'0000, 1100'1100, 1010'1010: two of three
  EXPECT_EQ(to_hex(memory[2]), "35");
  prototypes.add(bits("f0"), 0, PadState::incipient, -1);
  prototypes.add(bits("0a"), 0, PadState::incipient, 2);
  EXPECT_EQ(to_hex(prototypes.bundle()[1]), "8a");  // 1100'1100, 1010'1010 and twice 0000'1010: more than two of four, or a tie
}

TEST_F(Training, TiesFollowTheRuleAlsoInAClassWithoutSamples) {
  model_.context_driven = false;
  for (const Ties ties : {Ties::one, Ties::zero}) {
    model_.ties = ties;
    Prototypes prototypes(model_, memories_);
    prototypes.add(bits("f0"), 0, PadState::incipient);
    prototypes.add(bits("cc"), 0, PadState::incipient);
    EXPECT_EQ(to_hex(prototypes.bundle()[1]), ties == Ties::one ? "fc" : "c0");
    EXPECT_EQ(to_hex(prototypes.bundle()[0]), ties == Ties::one ? "ff" : "00");
  }
}

TEST_F(Training, ContextsAreBoundToWhatIsLearned) {
  Prototypes prototypes(model_, memories_);
  prototypes.add(bits("5a"), 3, PadState::non_slip);
  EXPECT_EQ(bind(prototypes.bundle()[0], memories_.context[3]), bits("5a"));
}

TEST_F(Training, RefusesWhatIsNoClass) {
  Prototypes prototypes(model_, memories_);
  EXPECT_THROW(prototypes.add(bits("00"), 0, PadState::no_contact), std::out_of_range);
  EXPECT_THROW(prototypes.add(bits("00"), 4, PadState::gross), std::out_of_range);
}

// Frames have the levels of a class within one: the nearest prototype is that of the class.
TEST(Classifier, TellsApartWhatItWasTrainedOn) {
  const Model model;
  Memories memories = generate(model, 3);
  Prototypes prototypes(model, memories);
  RandomStream random(3, 0, "hd test classes");
  const auto frame_of = [&](int state) {
    Frame frame;
    for (std::uint8_t& level : frame.level)
      level = static_cast<std::uint8_t>(1 + 8 * (state - 1) + static_cast<int>(random.integer(3)));
    frame.context = static_cast<std::uint8_t>(random.integer(context_count));
    return frame;
  };
  const auto encoder = make_kernel_encoder(model, memories);
  for (int state = 1; state <= 3; ++state) {
    encoder->reset();
    for (int t = 0; t < 500; ++t) {
      const Frame frame = frame_of(state);
      if (const Hypervector* const query = encoder->encode(frame))
        prototypes.add(*query, frame.context, static_cast<PadState>(state));
    }
  }
  memories.associative = prototypes.bundle();
  const auto engine = make_kernel(model, memories);
  std::size_t right = 0;
  for (int state = 1; state <= 3; ++state) {
    engine->reset();
    for (int t = 0; t < 114; ++t) right += engine->update(frame_of(state)).state == static_cast<PadState>(state) ? 1U : 0U;
  }
  EXPECT_EQ(right, 300U);  // 114 frames, 14 of which fill the window, for three classes
}

}  // namespace
}  // namespace slipbench::hd

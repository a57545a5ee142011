// The algebra of hypervectors: binding, permutation, distance, hexadecimal.
#include "detectors/hd/memories.h"

#include "sim/core/random.h"
#include "tests/expect.h"

namespace slipbench::hd {
namespace {

Hypervector random_vector(std::size_t dimension, std::uint64_t seed) {
  RandomStream random(seed, dimension, "hd test vector");
  Hypervector vector(dimension);
  for (std::size_t i = 0; i < dimension; ++i) vector.set(i, random.integer(2) == 1);
  return vector;
}

std::string refusal(const std::string& text, std::size_t dimension) {
  return refusal_of([&] { from_hex(text, dimension); });
}

struct Algebra : testing::TestWithParam<std::size_t> {
  Hypervector a_ = random_vector(GetParam(), 1), b_ = random_vector(GetParam(), 2), c_ = random_vector(GetParam(), 3);
};

TEST_P(Algebra, BindingIsTheProductOfSigns) {
  const Hypervector product = bind(a_, b_);
  for (std::size_t i = 0; i < GetParam(); ++i) {
    const int expected = (a_.bit(i) ? 1 : -1) * (b_.bit(i) ? 1 : -1);
    ASSERT_EQ(product.bit(i) ? 1 : -1, expected) << i;
  }
}

TEST_P(Algebra, BindingIsItsOwnInverseAndKeepsDistances) {
  EXPECT_EQ(bind(bind(a_, b_), b_), a_);
  EXPECT_EQ(bind(a_, b_), bind(b_, a_));
  EXPECT_EQ(bind(bind(a_, b_), c_), bind(a_, bind(b_, c_)));
  EXPECT_EQ(hamming(bind(a_, c_), bind(b_, c_)), hamming(a_, b_));
}

TEST_P(Algebra, PermutationTurnsByOneAndCommutesWithBinding) {
  const Hypervector turned = rotate(a_);
  for (std::size_t i = 0; i < GetParam(); ++i) ASSERT_EQ(turned.bit(i), a_.bit((i + 1) % GetParam())) << i;
  EXPECT_EQ(rotate(bind(a_, b_)), bind(rotate(a_), rotate(b_)));
  Hypervector around = a_;
  for (std::size_t i = 0; i < GetParam(); ++i) around = rotate(around);
  EXPECT_EQ(around, a_);
}

TEST_P(Algebra, DistanceCountsBits) {
  EXPECT_EQ(hamming(a_, a_), 0U);
  Hypervector other = a_;
  other.set(0, !other.bit(0));
  other.set(GetParam() - 1, !other.bit(GetParam() - 1));
  EXPECT_EQ(hamming(a_, other), 2U);
  // bind(a, -1) is the opposite of a and differs from it in every bit.
  EXPECT_EQ(hamming(bind(a_, Hypervector(GetParam())), a_), GetParam());
}

TEST_P(Algebra, HexadecimalAndBack) {
  EXPECT_EQ(to_hex(a_).size(), (GetParam() + 3) / 4);
  EXPECT_EQ(from_hex(to_hex(a_), GetParam()), a_);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Algebra, testing::Values(8, 63, 64, 65, 1000));

TEST(Hypervector, TheFirstDigitHoldsTheHighestBits) {
  const Hypervector vector = from_hex("81", 8);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(vector.bit(i), i == 0 || i == 7) << i;
  EXPECT_EQ(to_hex(rotate(vector)), "c0");  // to the right in hexadecimal: 10000001 becomes 11000000
  EXPECT_EQ(to_hex(from_hex("1aF", 9)), "1af");
}

TEST(Hypervector, GarbledTextIsRefused) {
  EXPECT_THAT(refusal("123", 16), mentions({"3 digits", "16 bits", "4"}));
  EXPECT_THAT(refusal("12345", 16), mentions({"5 digits", "16 bits", "4"}));
  EXPECT_THAT(refusal("12g4", 16), mentions({"'g'", "column 3"}));
  EXPECT_THAT(refusal("12 4", 16), mentions({"' '", "column 3"}));
  EXPECT_THAT(refusal("21ff", 13), mentions({"2", "13"}));
  EXPECT_EQ(refusal("11ff", 13), "accepted");
}

}  // namespace
}  // namespace slipbench::hd

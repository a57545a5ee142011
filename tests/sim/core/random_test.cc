#include "sim/core/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace slipbench {
namespace {

constexpr std::uint64_t all = ~std::uint64_t{0};

std::vector<double> draws(RandomStream stream, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(stream.uniform());
  return values;
}

TEST(RandomStream, TheSameKeyGivesTheSameNumbers) { EXPECT_EQ(draws({7, 3, "noise"}, 100), draws({7, 3, "noise"}, 100)); }

TEST(RandomStream, EveryPartOfTheKeyMatters) {
  // 2,000 first numbers of 53 bits: a chance collision has probability 2000^2 / 2 / 2^53 = 2e-10.
  std::set<double> first;
  std::size_t keys = 0;
  const auto add = [&](std::uint64_t seed, std::uint64_t trial, const std::string& name) {
    first.insert(RandomStream(seed, trial, name).uniform());
    ++keys;
  };
  for (std::uint64_t i = 0; i < 500; ++i) {
    add(i, 1000, "noise");
    add(1000, i, "noise");
    add(1000, 1000, "noise" + std::to_string(i));
  }
  for (int bit = 0; bit < 64; ++bit) {
    add(1000 ^ (std::uint64_t{1} << bit) ^ (std::uint64_t{1} << 63 >> (bit / 2)), 1001, "bits of the seed");
    add(1001, 1000 ^ (std::uint64_t{1} << bit), "bits of the trial");
  }
  // The parts of a key are not interchangeable.
  add(1, 2, "swap");
  add(2, 1, "swap");
  EXPECT_EQ(first.size(), keys);
}

TEST(RandomStream, ManyAtOnceAreThoseOfOneDrawAfterTheOther) {
  for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{0xFFFFFFFA}}) {  // the counter's lower half overflows
    RandomStream together(7, 3, "bits"), one(7, 3, "bits");
    together.seek(first);
    one.seek(first);
    for (const std::size_t count : {2U, 38U, 64U}) {
      std::vector<std::uint64_t> bits(count);
      together.bits(bits);
      for (const std::uint64_t draw : bits) EXPECT_EQ(static_cast<double>(draw >> 11) * 0x1p-53, one.uniform());
    }
    std::vector<double> normal(20'016);  // 312 times the block size, plus a remainder
    together.normal(normal);
    for (const double draw : normal) EXPECT_EQ(draw, one.normal());
    EXPECT_EQ(together.uniform(), one.uniform());
    std::vector<std::uint64_t> bits(2);
    EXPECT_THROW(together.bits(bits), std::logic_error) << "in the middle of a pair";
    EXPECT_THROW(one.bits(std::span(bits).first(1)), std::logic_error);
  }
}

TEST(RandomStream, NormalPairsLieOnTheirCircle) {
  // Box and Muller: sqrt(-2 ln(1 - u)) times cosine and sine of 2 pi v. The root, the logarithm,
  // the angle and the product each err by an ulp or two, and an angle's ulp counts up to 2 pi times
  // where the cosine is steep: 4e-15 of the radius is twice all of that.
  RandomStream stream(3, 0, "circle"), uniform(3, 0, "circle");
  for (int pair = 0; pair < 100'000; ++pair) {
    const double u = uniform.uniform(), v = uniform.uniform();
    const long double radius = std::sqrt(-2.0L * std::log(1.0L - static_cast<long double>(u)));
    const long double angle = 2.0L * std::numbers::pi_v<long double> * static_cast<long double>(v);
    const double bound = 4e-15 * static_cast<double>(radius);
    ASSERT_NEAR(stream.normal(), static_cast<double>(radius * std::cos(angle)), bound) << "u " << u << ", v " << v;
    ASSERT_NEAR(stream.normal(), static_cast<double>(radius * std::sin(angle)), bound) << "u " << u << ", v " << v;
  }
}

TEST(RandomStream, DoesNotDependOnTheOrderInWhichStreamsAreUsed) {
  RandomStream a(1, 2, "a");
  RandomStream b(1, 2, "b");
  std::vector<double> interleaved_a;
  std::vector<double> interleaved_b;
  for (int i = 0; i < 10; ++i) {
    interleaved_a.push_back(a.uniform());
    interleaved_b.push_back(b.uniform());
  }
  EXPECT_EQ(interleaved_a, draws({1, 2, "a"}, 10));
  EXPECT_EQ(interleaved_b, draws({1, 2, "b"}, 10));
}

// The sample mean of n draws of standard deviation s has the deviation s / sqrt(n); the bounds are
// five of these. The keys are fixed, so a test either always passes or never does.
constexpr int n = 200'000;
const double root_n = std::sqrt(static_cast<double>(n));

TEST(RandomStream, UniformHasTheMomentsOfTheUniformDistribution) {
  RandomStream stream(11, 0, "uniform");
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < n; ++i) {
    const double u = stream.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / n, 0.5, 5.0 * std::sqrt(1.0 / 12.0) / root_n);
  // Var(u^2) = E(u^4) - E(u^2)^2 = 1/5 - 1/9 = 4/45.
  EXPECT_NEAR(squares / n, 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0) / root_n);
}

TEST(RandomStream, NormalHasTheMomentsOfTheNormalDistribution) {
  RandomStream stream(11, 0, "normal");
  std::array<double, 5> moments{};
  double lag = 0.0;
  double previous = 0.0;
  for (int i = 0; i < n; ++i) {
    const double z = stream.normal();
    ASSERT_TRUE(std::isfinite(z));
    for (std::size_t k = 1; k < moments.size(); ++k) moments[k] += std::pow(z, static_cast<double>(k));
    lag += z * previous;  // the two halves of a Box-Muller pair are independent
    previous = z;
  }
  // Var(z^k) = E(z^2k) - E(z^k)^2 with E(z^2) = 1, E(z^4) = 3, E(z^6) = 15, E(z^8) = 105: 1, 2, 15,
  // 96.
  EXPECT_NEAR(moments[1] / n, 0.0, 5.0 * 1.0 / root_n);
  EXPECT_NEAR(moments[2] / n, 1.0, 5.0 * std::sqrt(2.0) / root_n);
  EXPECT_NEAR(moments[3] / n, 0.0, 5.0 * std::sqrt(15.0) / root_n);
  EXPECT_NEAR(moments[4] / n, 3.0, 5.0 * std::sqrt(96.0) / root_n);
  EXPECT_NEAR(lag / n, 0.0, 5.0 / root_n);
}

TEST(RandomStream, NormalTakesMeanAndDeviation) {
  RandomStream stream(1, 1, "scaled");
  RandomStream standard(1, 1, "scaled");
  for (int i = 0; i < 10; ++i) EXPECT_EQ(stream.normal(3.0, 0.5), 3.0 + 0.5 * standard.normal());
}

TEST(RandomStream, UniformStaysInAHalfOpenInterval) {
  RandomStream stream(5, 0, "interval");
  const double min = 1.0;
  const double max = std::nextafter(1.0, 2.0);  // the only value in [min, max) is min: half of all sums round up to max
  for (int i = 0; i < 100; ++i) EXPECT_EQ(stream.uniform(min, max), min);
  EXPECT_EQ(stream.uniform(2.0, 2.0), 2.0);
  EXPECT_THROW(stream.uniform(2.0, 1.0), std::logic_error);
  EXPECT_THROW(stream.uniform(-1e308, 1e308), std::logic_error);
}

TEST(RandomStream, IntegerIsUniform) {
  RandomStream stream(5, 0, "integer");
  constexpr std::size_t bound = 6;
  std::array<int, bound> counts{};
  for (int i = 0; i < n; ++i) ++counts.at(stream.integer(bound));
  // Each count is binomial: mean n/6, variance n (1/6)(5/6).
  for (const int count : counts) EXPECT_NEAR(count, n / 6.0, 5.0 * std::sqrt(n * 5.0 / 36.0));
  EXPECT_EQ(stream.integer(1), 0u);
  for (int i = 0; i < 100; ++i) EXPECT_LT(stream.integer(all), all);
  EXPECT_THROW(stream.integer(0), std::logic_error);
}

}  // namespace
}  // namespace slipbench

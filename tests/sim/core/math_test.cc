#include "sim/core/math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/core/random.h"

namespace slipbench {
namespace {

std::uint64_t bits_of(double x) { return std::bit_cast<std::uint64_t>(x); }

// Distance in units in the last place of `expected`.
double ulps(double value, long double expected) {
  const double nearest = static_cast<double>(expected);
  const double unit = std::nextafter(std::abs(nearest), INFINITY) - std::abs(nearest);
  return static_cast<double>(std::abs(value - expected)) / unit;
}

struct Function {
  std::string name;
  double (*ours)(double);
  long double (*wide)(long double);  // the C library's, in extended precision
  double low, high;
  double error;  // largest, in units in the last place
};

const std::vector<Function>& functions() {
  static const std::vector<Function> all{
      {"exp", math::exp, std::exp, -700.0, 700.0, 1.0},  {"expm1", math::expm1, std::expm1, -3.0, 3.0, 1.0},
      {"log", math::log, std::log, 1e-9, 1e3, 1.0},      {"log1p", math::log1p, std::log1p, -0.999, 10.0, 1.0},
      {"log2", math::log2, std::log2, 1e-9, 1e3, 1.0},   {"log10", math::log10, std::log10, 1e-9, 1e3, 1.0},
      {"sin", math::sin, std::sin, -1e4, 1e4, 1.0},      {"cos", math::cos, std::cos, -1e4, 1e4, 1.0},
      {"tan", math::tan, std::tan, -10.0, 10.0, 1.0},    {"asin", math::asin, std::asin, -1.0, 1.0, 1.0},
      {"acos", math::acos, std::acos, -1.0, 1.0, 1.0},   {"atan", math::atan, std::atan, -50.0, 50.0, 1.0},
      {"sinh", math::sinh, std::sinh, -20.0, 20.0, 1.0}, {"cosh", math::cosh, std::cosh, -20.0, 20.0, 1.0},
      {"tanh", math::tanh, std::tanh, -3.0, 3.0, 1.0},   {"asinh", math::asinh, std::asinh, -1e3, 1e3, 1.0},
      {"cbrt", math::cbrt, std::cbrt, -10.0, 10.0, 1.0}, {"erf", math::erf, std::erf, -3.0, 3.0, 1.0},
      {"erfc", math::erfc, std::erfc, -3.0, 10.0, 1.5},  {"lgamma", math::lgamma, std::lgamma, 3.0, 1e4, 1.0},
  };
  return all;
}

TEST(Math, FunctionsOfOneAreWithinTheirError) {
  for (const Function& function : functions()) {
    RandomStream stream(1, 0, function.name);
    double worst = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      const double x = stream.uniform(function.low, function.high);
      worst = std::max(worst, ulps(function.ours(x), function.wide(x)));
    }
    EXPECT_LE(worst, function.error) << function.name;
    EXPECT_GT(worst, 0.4) << function.name << ": nothing was compared";
  }
}

TEST(Math, FunctionsOfTwoAreWithinTheirError) {
  RandomStream stream(1, 0, "pairs");
  for (int k = 0; k < 20'000; ++k) {
    const double x = stream.uniform(1e-3, 10.0), y = stream.uniform(-10.0, 10.0);
    EXPECT_LE(ulps(math::pow(x, y), std::pow(static_cast<long double>(x), static_cast<long double>(y))), 1.0) << x << ' ' << y;
    EXPECT_LE(ulps(math::atan2(y, x - 5.0), std::atan2(static_cast<long double>(y), static_cast<long double>(x - 5.0))), 1.5)
        << y << ' ' << x - 5.0;
    EXPECT_LE(ulps(math::hypot(x, y), std::hypot(static_cast<long double>(x), static_cast<long double>(y))), 1.1);
  }
}

TEST(Math, BoundariesAreExact) {
  EXPECT_EQ(math::exp(0.0), 1.0);
  EXPECT_EQ(math::exp(-INFINITY), 0.0);
  EXPECT_EQ(math::log(1.0), 0.0);
  EXPECT_EQ(math::log(0.0), -INFINITY);
  EXPECT_EQ(math::expm1(-INFINITY), -1.0);
  EXPECT_EQ(math::sin(0.0), 0.0);
  EXPECT_EQ(math::cos(0.0), 1.0);
  EXPECT_EQ(math::sincos(0.0).sin, 0.0);
  EXPECT_EQ(math::sincos(0.0).cos, 1.0);
  EXPECT_EQ(math::tanh(INFINITY), 1.0);
  EXPECT_EQ(math::erfc(INFINITY), 0.0);
  EXPECT_EQ(math::pow(0.0, 2.0), 0.0);
  EXPECT_TRUE(std::isnan(math::exp(NAN)));
}

TEST(Math, EveryLaneOfAQuadHasTheBitsOfTheFunctionOfOne) {
  RandomStream stream(1, 0, "numbers");
  for (int trial = 0; trial < 20'000; ++trial) {
    Quad x, y;
    for (std::size_t lane = 0; lane < quad; ++lane) {
      x[lane] = std::ldexp(stream.uniform(-1.0, 1.0), trial % 60 - 50);
      y[lane] = stream.uniform(-3.0, 3.0);
    }
    const Quad above = 1.0 + x * x;
    const Quad exp = math::exp(x), expm1 = math::expm1(x), log = math::log(above), pow = math::pow(above, y);
    const math::QuadSinCos turn = math::sincos(x);
    for (std::size_t lane = 0; lane < quad; ++lane) {
      ASSERT_EQ(bits_of(exp[lane]), bits_of(math::exp(x[lane]))) << x[lane];
      ASSERT_EQ(bits_of(expm1[lane]), bits_of(math::expm1(x[lane]))) << x[lane];
      ASSERT_EQ(bits_of(log[lane]), bits_of(math::log(above[lane]))) << above[lane];
      ASSERT_EQ(bits_of(pow[lane]), bits_of(math::pow(above[lane], y[lane]))) << above[lane] << ' ' << y[lane];
      ASSERT_EQ(bits_of(turn.sin[lane]), bits_of(math::sincos(x[lane]).sin)) << x[lane];
      ASSERT_EQ(bits_of(turn.cos[lane]), bits_of(math::sincos(x[lane]).cos)) << x[lane];
    }
  }
}

}  // namespace
}  // namespace slipbench

// The skewed noise against its law, n = z + p_t m - t - s: moments, and the frequency of large
// negative and positive values.

#include "tests/expect.h"
#include "tests/sensors/electronics/model.h"

namespace slipbench {
namespace {

struct Moments {
  double mean = 0.0, variance = 0.0, below = 0.0, above = 0.0;  // shares below -6 and above +4.5
};

Moments moments(const std::vector<float>& values, std::size_t count) {
  Moments m;
  const double share = 1.0 / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) m.mean += share * static_cast<double>(values[i]);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = static_cast<double>(values[i]);
    m.variance += share * (x - m.mean) * (x - m.mean);
    m.below += x < -6.0 ? share : 0.0;
    m.above += x > 4.5 ? share : 0.0;
  }
  return m;
}

TEST(SkewedNoise, HasTheMomentsAndTheSpikesOfItsLaw) {
  // Spikes: E s = .0075 * 7.4 = .0555, E s^2 = .0075 (3.2^2 + 3.2*11.6 + 11.6^2)/3 = .4548. Tail:
  // .1 * 1.29 = .129 is added back; E t^2 = .1 * 2 * 1.29^2 = .3328. Variance 1 + .3328 - .129^2 +
  // .4548 - .0555^2 = 1.7679, so sd 1.330: 4.1 counts if the normal part has 3.1. Below -6: from
  // spikes P(s > 6 + z'), about (11.6 - 6)/8.4 = .667 of .0075; z', the rest, has mean 0 and sd
  // 1.15, and the density of s is flat around 6, so z' changes nothing. From the tail alone .1 P(z
  // + .129 - t < -6) = .1 exp(-(6.129)/1.29 + 1/(2*1.29^2)) = .1 * .0117 = .0012. Together .0062.
  // Above 4.5: z > 4.371, 6e-6.
  const auto n = outputs({part("skewed_noise")}, two_values_a_source(many), 0.0F, {0.0, 0.014}).back();
  const Moments m = moments(n, many);
  // Standard errors: of the mean sd/sqrt(20000) = .0094; of the variance sqrt((E x^4 -
  // var^2)/20000) with E s^4 = .0075 (11.6^5 - 3.2^5)/(5*8.4) = 37.4 and E t^4 = .1 * 24 * 1.29^4 =
  // 6.6, some 55 in all: .052; of a share p sqrt(p/20000) = .00056.
  EXPECT_NEAR(m.mean, -0.0555, 5.0 * 0.0094);
  EXPECT_NEAR(m.variance, 1.7679, 5.0 * 0.052);
  EXPECT_NEAR(m.below, 0.0062, 5.0 * 0.00056);
  EXPECT_LT(m.above, 4.0 / 20000.0) << "0.1 are expected";
}

TEST(SkewedNoise, NeedsTheLeastDepthOfASpikeFirst) {
  Named reversed = part("skewed_noise"), even = part("skewed_noise");
  reversed.parameters.set("spike", std::vector{11.6, 3.2});
  even.parameters.set("spike", std::vector{5.0, 5.0});
  EXPECT_NO_THROW(Electronics({even}, two_values_a_source(1), default_key));
  EXPECT_THAT(scene_refusal_of([&] { Electronics({reversed}, two_values_a_source(1), default_key); }),
              refused_at("sensors.pad.electronics.skewed_noise.spike", {"[11.6, 3.2]", "depth"}));
}

TEST(SkewedNoise, IsDrawnAnewForEachSourceAndSample) {
  const auto n = outputs({part("skewed_noise")}, two_values_a_source(many), 0.0F, {0.0, 0.014});
  double samples = 0.0, neighbours = 0.0;
  for (std::size_t i = 0; i + 1 < many; ++i) {
    samples += static_cast<double>(n[0][i]) * static_cast<double>(n[1][i]) / static_cast<double>(many);
    neighbours += static_cast<double>(n[0][i]) * static_cast<double>(n[0][i + 1]) / static_cast<double>(many);
    EXPECT_FLOAT_EQ(n[0][many + i], 3.0F * n[0][i]) << "three times as much on the same source";
  }
  // Independent: a mean product of 0 (the means are .0555, .003 squared) with a standard error of
  // variance/sqrt(20000) = .0125.
  EXPECT_NEAR(samples, 0.003, 5.0 * 0.0125);
  EXPECT_NEAR(neighbours, 0.003, 5.0 * 0.0125);
}

}  // namespace
}  // namespace slipbench

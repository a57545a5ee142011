// The converter, and the sensors' declarations of their parts.

#include <array>
#include <cmath>
#include <stdexcept>

#include "tests/expect.h"
#include "tests/sensors/electronics/model.h"

namespace slipbench {
namespace {

Named converter(std::int64_t bits) {
  Named result = part("quantisation");
  result.parameters.set("bits", bits);
  return result;
}

// One value whose converter spans [lowest, highest].
SignalModel one_value(double lowest, double highest) {
  SignalModel model;
  model.rate = 1000.0;
  model.sources = 1;
  model.source = {0};
  model.converter = {{lowest, highest}};
  return model;
}

float converted(const SignalModel& model, std::int64_t bits, float input) {
  return outputs({converter(bits)}, model, input, {0.0}).front().front();
}

TEST(Quantisation, TakesTheNearestLevel) {
  // Two bits over [-1, 2]: the levels -1, 0, 1, 2.
  const SignalModel model = one_value(-1.0, 2.0);
  EXPECT_EQ(converted(model, 2, -0.51F), -1.0F);
  EXPECT_EQ(converted(model, 2, -0.49F), 0.0F);
  EXPECT_EQ(converted(model, 2, 0.49F), 0.0F);
  EXPECT_EQ(converted(model, 2, 0.51F), 1.0F);
  // One bit: the two ends.
  EXPECT_EQ(converted(model, 1, 0.49F), -1.0F);
  EXPECT_EQ(converted(model, 1, 0.51F), 2.0F);
  // A range of 2^bits - 1 counts has steps of one count.
  const SignalModel counts = one_value(-2048.0, 2047.0);
  EXPECT_EQ(converted(counts, 12, -1.3F), -1.0F);
  EXPECT_EQ(converted(counts, 12, 1046.7F), 1047.0F);
}

TEST(Quantisation, EndsWithItsRange) {
  const SignalModel counts = one_value(0.0, 8191.0);
  EXPECT_EQ(converted(counts, 13, 1e6F), 8191.0F);
  EXPECT_EQ(converted(counts, 13, -1e6F), 0.0F);
}

TEST(Quantisation, CountsTheSamplesThatItCutsOff) {
  // Two bits over [-1, 2] in steps of 1: values from half a step beyond an end on are clipped.
  // Several clipped values count as one sample.
  SignalModel model = one_value(-1.0, 2.0);
  model.source = {0, 0};
  model.converter.push_back({-1.0, 2.0});
  Electronics electronics({converter(2)}, model, default_key);
  const auto saturated_after = [&](float first, float second) {
    std::array<float, 2> values{first, second};
    electronics.apply(values, 0.0);
    return electronics.saturated();
  };
  EXPECT_EQ(saturated_after(0.0F, 2.49F), 0u);
  EXPECT_EQ(saturated_after(-1.49F, 0.0F), 0u);
  EXPECT_EQ(saturated_after(0.0F, 2.51F), 1u);
  EXPECT_EQ(saturated_after(-1.51F, 2.51F), 2u);
  EXPECT_EQ(saturated_after(0.0F, 0.0F), 2u);
  EXPECT_EQ(Electronics({part("noise")}, two_values_a_source(1), default_key).saturated(), 0u) << "no converter";
}

TEST(Quantisation, AddsAnErrorOfATwelfthOfASquaredStep) {
  // Noise of sd 1 in steps of q = 4/63: the error is uniform in [-q/2, q/2] up to a bias of
  // relative size exp(-2 pi^2/q^2). The range of two sd clips 4.6 % of the draws; these are left
  // out.
  SignalModel model = two_values_a_source(many);
  const auto exact = outputs({part("noise")}, model, 0.0F, {0.0}).front();
  const auto read = outputs({part("noise"), converter(6)}, model, 0.0F, {0.0}).front();
  const double q = 4.0 / 63.0;
  double sum = 0.0;
  std::size_t inside = 0;
  for (std::size_t v = 0; v < many; ++v) {
    if (std::abs(exact[v]) > 2.0F) continue;
    const double error = static_cast<double>(read[v]) - static_cast<double>(exact[v]);
    ASSERT_LE(std::abs(error), 0.5 * q * (1.0 + 1e-5));
    sum += error * error;
    ++inside;
  }
  // Kurtosis of a uniform error 9/5: standard error of the mean square sqrt(4/5/n) = 0.65 %.
  EXPECT_NEAR(sum / static_cast<double>(inside) / (q * q / 12.0), 1.0, 5.0 * std::sqrt(0.8 / static_cast<double>(inside)));
}

TEST(WhiteNoise, ForgetsBetweenTwoSamples) {
  Named white = part("noise");
  white.parameters.set("corner", std::numeric_limits<double>::infinity());
  const auto y = outputs({white}, two_values_a_source(many), 0.0F, {0.0, 0.001});
  double square = 0.0, lag = 0.0;
  for (std::size_t v = 0; v < many; ++v) {
    square += static_cast<double>(y[0][v] * y[0][v]) / static_cast<double>(many);
    lag += static_cast<double>(y[0][v] * y[1][v]) / static_cast<double>(many);
  }
  EXPECT_NEAR(square, 1.0, 5.0 * std::sqrt(2.0 / static_cast<double>(many)));
  EXPECT_NEAR(lag, 0.0, 5.0 / std::sqrt(static_cast<double>(many)));
}

TEST(ElectronicsOfASensor, HaveItsSourcesAndDefaultsInItsOrder) {
  const std::vector<Entry> parts =
      electronics_of("Skin", {{"noise", "idle", {{"corner", "inf", "no corner seen"}}}, {"quantisation", "data sheet", {}}});
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "noise");
  EXPECT_THAT(parts[0].source, StartsWith("Skin: idle. General: "));
  EXPECT_EQ(parts[0].parameters[1].default_text, "inf");
  EXPECT_EQ(parts[0].parameters[1].source, "no corner seen");
  EXPECT_EQ(parts[1].parameters[0].default_text, "12") << "the part's own";
  EXPECT_THROW(electronics_of("Skin", {{"hum", "", {}}}), std::logic_error);
  EXPECT_THROW(electronics_of("Skin", {{"noise", "", {{"colour", "red", ""}}}}), std::logic_error);
}

}  // namespace
}  // namespace slipbench

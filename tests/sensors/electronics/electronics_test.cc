#include "sensors/electronics/electronics.h"

#include <algorithm>
#include <cmath>

#include "tests/expect.h"
#include "tests/sensors/electronics/model.h"

namespace slipbench {
namespace {

// Five standard errors of a mean square of `many` normal draws, relative to the variance:
// 5*sqrt(2/many) = 5 %; half of that for a standard deviation.
const double sd_tolerance = 2.5 * std::sqrt(2.0 / static_cast<double>(many));
const double mean_tolerance = 5.0 / std::sqrt(static_cast<double>(many));

double mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}

double sd_about(double centre, const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += (value - centre) * (value - centre);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

std::vector<double> slice(const std::vector<float>& x, std::size_t first, std::size_t count) {
  const auto begin = x.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

TEST(Electronics, EmptyChainLeavesTheSampleAlone) {
  const auto y = outputs({}, two_values_a_source(10), 0.1F, {0.0, 1.0});
  for (const auto& sample : y) EXPECT_THAT(sample, Each(0.1F));
}

TEST(Electronics, PartsSayWhatTheyAreAndStandAtTheirOwnFigures) {
  for (const Entry& entry : electronics_entries()) {
    EXPECT_FALSE(entry.summary.empty()) << entry.name;
    EXPECT_FALSE(entry.law.empty()) << entry.name;
    EXPECT_FALSE(entry.source.ends_with("General: ")) << entry.name;
    const Parameters defaults = defaults_of(entry.parameters);
    const bool has_scale = entry.name != "quantisation" && entry.name != "scan" && entry.name != "low_pass";
    EXPECT_TRUE(!has_scale || defaults.number("scale") == 1.0) << entry.name;
  }
}

// The scene's reader checks which parts a sensor has.
TEST(Electronics, RefusesAnUnknownPart) {
  EXPECT_THROW(Electronics({{"ofset", {}}}, two_values_a_source(1), default_key), std::logic_error);
}

TEST(Electronics, RefusesAPartNamedTwice) {
  EXPECT_THAT(scene_refusal_of([&] {
                const Electronics electronics({part("gain"), part("noise"), part("gain")}, two_values_a_source(1), default_key);
              }),
              AllOf(StartsWith("sensors.pad.electronics | "), HasSubstr("'gain' is listed twice")));
}

TEST(Electronics, ScaleZeroLeavesTheSampleAlone) {
  SignalModel model = two_values_a_source(10);
  model.couplings = {{0, 1, 1.0}};
  for (const std::string name : {"coupling", "gain", "offset", "drift", "noise"}) {
    const auto y = outputs({part(name, 0.0)}, model, 0.1F, {0.0, 0.5});
    for (const auto& sample : y) EXPECT_THAT(sample, Each(0.1F)) << name;
  }
}

TEST(Electronics, ScaleIsAFactorOnTheDisturbance) {
  // A factor of two is exact in binary, so the disturbance of zero doubles bit-exactly.
  for (const std::string name : {"offset", "drift", "noise"}) {
    const auto once = outputs({part(name)}, two_values_a_source(10), 0.0F, {0.25, 0.5});
    auto twice = outputs({part(name, 2.0)}, two_values_a_source(10), 0.0F, {0.25, 0.5});
    for (auto& sample : twice) std::for_each(sample.begin(), sample.end(), [](float& value) { value /= 2.0F; });
    EXPECT_EQ(once, twice) << name;
  }
}

TEST(Electronics, DrawsDoNotShiftWhenAPartIsAdded) {
  SignalModel model = two_values_a_source(10);
  model.couplings = {{0, 1, 1.0}};
  const std::vector<double> times{0.0, 0.001, 0.002, 0.003};
  const auto noise = outputs({part("noise")}, model, 0.0F, times);
  const auto offset = outputs({part("offset")}, model, 0.0F, times);
  // Coupling and gain come first and leave zero at zero. The noise is then added to zero, and the
  // offset to the noise, with a single rounding as here.
  const auto all = outputs({part("coupling"), part("gain"), part("noise"), part("offset")}, model, 0.0F, times);
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (std::size_t v = 0; v < model.source.size(); ++v) EXPECT_EQ(all[k][v], noise[k][v] + offset[k][v]);
  }
}

TEST(Electronics, StreamsAreKeyedBySeedTrialDeviceAndName) {
  const SignalModel model = two_values_a_source(10);
  const auto with = [&](const std::string& name, const ElectronicsKey& key) {
    return outputs({part(name)}, model, 1.0F, {1.0}, key);
  };
  const ElectronicsKey seed{.seed = 12, .trial = 3, .device = 0, .sensor_name = "pad"};
  const ElectronicsKey trial{.seed = 11, .trial = 4, .device = 0, .sensor_name = "pad"};
  const ElectronicsKey device{.seed = 11, .trial = 3, .device = 1, .sensor_name = "pad"};
  const ElectronicsKey sensor{.seed = 11, .trial = 3, .device = 0, .sensor_name = "pad2"};
  for (const std::string name : {"offset", "drift", "noise", "gain"}) {
    const auto reference = with(name, default_key);
    EXPECT_EQ(with(name, default_key), reference) << name;
    EXPECT_NE(with(name, seed), reference) << name;
    EXPECT_NE(with(name, sensor), reference) << name;
    // A gain belongs to the device and is the same in each trial; the others are new in each trial.
    EXPECT_EQ(with(name, trial) == reference, name == "gain") << name;
    EXPECT_EQ(with(name, device) != reference, name == "gain") << name;
  }
}

TEST(Offset, IsConstantWithTheStatedSpread) {
  const auto y = outputs({part("offset")}, two_values_a_source(many), 0.0F, {0.0, 0.5, 10.0});
  EXPECT_EQ(y[0], y[1]);
  EXPECT_EQ(y[0], y[2]);
  const auto unit = slice(y[0], 0, many);
  EXPECT_NEAR(mean(unit), 0.0, mean_tolerance);
  EXPECT_NEAR(sd_about(0.0, unit), 1.0, sd_tolerance);
  for (std::size_t s = 0; s < many; ++s) ASSERT_FLOAT_EQ(y[0][many + s], 3.0F * y[0][s]);
}

TEST(Drift, GrowsInProportionToTimeWithTheStatedSpread) {
  const auto y = outputs({part("drift")}, two_values_a_source(many), 0.0F, {0.0, 1.0, 2.0});
  EXPECT_THAT(y[0], Each(0.0F));
  const auto slope = slice(y[1], 0, many);
  EXPECT_NEAR(mean(slope), 0.0, mean_tolerance);
  EXPECT_NEAR(sd_about(0.0, slope), 1.0, sd_tolerance);
  for (std::size_t s = 0; s < many; ++s) {
    ASSERT_EQ(y[2][s], 2.0F * y[1][s]);
    ASSERT_FLOAT_EQ(y[1][many + s], 3.0F * y[1][s]);
  }
}

TEST(Gain, HasMeanOneAndTheStatedSpread) {
  const auto y = outputs({part("gain")}, two_values_a_source(many), 1.0F, {0.0, 5.0});
  EXPECT_EQ(y[0], y[1]);
  EXPECT_GT(*std::min_element(y[0].begin(), y[0].end()), 0.0F);
  // Lognormal with sd 0.3: s^2 = ln(1.09) = 0.0862, kurtosis e^{4s^2} + 2e^{3s^2} + 3e^{2s^2} - 3 =
  // 4.57, so the relative standard error of the sd is sqrt((4.57 - 1)/many)/2 = 0.67 %; with sd 0.1
  // (kurtosis 3.16) it is 0.52 %.
  const auto narrow = slice(y[0], 0, many);
  const auto wide = slice(y[0], many, many);
  EXPECT_NEAR(mean(narrow), 1.0, 0.1 * mean_tolerance);
  EXPECT_NEAR(sd_about(1.0, narrow) / 0.1, 1.0, 5.0 * 0.0052);
  EXPECT_NEAR(mean(wide), 1.0, 0.3 * mean_tolerance);
  EXPECT_NEAR(sd_about(1.0, wide) / 0.3, 1.0, 5.0 * 0.0067);
}

TEST(Gain, LeavesAValueWithoutGainErrorAlone) {
  SignalModel model = two_values_a_source(2);
  model.gain_sd[1] = 0.0;
  const auto y = outputs({part("gain")}, model, 0.1F, {0.0});
  EXPECT_EQ(y[0][1], 0.1F);
  EXPECT_NE(y[0][0], 0.1F);
}

TEST(Gain, MultipliesTheValue) {
  const SignalModel model = two_values_a_source(10);
  const auto gain = outputs({part("gain")}, model, 1.0F, {0.0});
  const auto y = outputs({part("gain")}, model, -0.7F, {0.0});
  for (std::size_t v = 0; v < model.source.size(); ++v) EXPECT_EQ(y[0][v], -0.7F * gain[0][v]);
}

TEST(CouplingPart, DrawsItsCoefficientsUniformlyWithinTheLimit) {
  // For even v, value v+1 leaks into value v; the even values of the input are zero, so the output
  // is the coefficient itself.
  SignalModel model = two_values_a_source(many);
  for (std::size_t v = 0; v < 2 * many; v += 2) model.couplings.push_back({v, v + 1, 0.5});
  Electronics electronics({part("coupling")}, model, default_key);
  std::vector<float> sample(2 * many);
  for (std::size_t v = 1; v < sample.size(); v += 2) sample[v] = 1.0F;
  electronics.apply(sample, 0.0);

  std::vector<double> coefficients;
  for (std::size_t v = 0; v < sample.size(); v += 2) {
    coefficients.push_back(static_cast<double>(sample[v]));
    ASSERT_EQ(sample[v + 1], 1.0F);
    ASSERT_LE(std::abs(sample[v]), 0.5F);
  }
  // Uniform in [-L, L]: variance L^2/3; its estimate has the relative standard error
  // sqrt(4/5/many), the sd half of it.
  const double n = static_cast<double>(many);
  EXPECT_NEAR(mean(coefficients), 0.0, 5.0 * 0.5 / std::sqrt(3.0 * n));
  EXPECT_NEAR(sd_about(0.0, coefficients) * std::sqrt(3.0) / 0.5, 1.0, 2.5 * std::sqrt(0.8 / n));
}

// A limit of 0 takes its draw but adds no term: the coefficients of the other pairs do not change.
TEST(CouplingPart, ALimitOfZeroLeavesTheOtherDrawsAlone) {
  SignalModel model = two_values_a_source(2);
  model.couplings = {{0, 1, 0.5}, {1, 2, 0.5}, {2, 3, 0.5}};
  const auto all = outputs({part("coupling")}, model, 1.0F, {0.0});
  model.couplings[1].limit = 0.0;
  const auto without = outputs({part("coupling")}, model, 1.0F, {0.0});
  EXPECT_EQ(without[0][0], all[0][0]);
  EXPECT_EQ(without[0][1], 1.0F);
  EXPECT_NE(all[0][1], 1.0F);
  EXPECT_EQ(without[0][2], all[0][2]);
}

TEST(ValidRange, CountsSamplesBeyondTheRangeAndChangesNothing) {
  // The range is -2 to 2 and -6 to 6 (model.h), ends included.
  Electronics electronics({part("valid_range")}, two_values_a_source(1), default_key);
  const auto after = [&](float first, float second) {
    std::vector<float> sample{first, second};
    electronics.apply(sample, 0.0);
    EXPECT_THAT(sample, ElementsAre(first, second));
    return electronics.saturated();
  };
  EXPECT_EQ(after(2.0F, -6.0F), 0U);
  EXPECT_EQ(after(2.01F, 0.0F), 1U);
  EXPECT_EQ(after(-2.01F, 6.01F), 2U) << "a sample counts once";
  EXPECT_EQ(after(0.0F, 0.0F), 2U);
  // Half of the range.
  Electronics narrow({part("valid_range", 0.5)}, two_values_a_source(1), default_key);
  std::vector<float> sample{1.5F, 0.0F};
  narrow.apply(sample, 0.0);
  EXPECT_EQ(narrow.saturated(), 1U);
}

// Four values, two a flag: value 0 and 2 raise flag 1, value 1 and 3 flag 0. The range is -2 to 2
// and -6 to 6 by turns (model.h).
TEST(ValidRange, RaisesTheFlagOfEachValueBeyondTheRange) {
  SignalModel model = two_values_a_source(2);
  model.valid = {{-2.0, 2.0}, {-6.0, 6.0}, {-2.0, 2.0}, {-6.0, 6.0}};
  EXPECT_TRUE(Electronics({part("valid_range")}, model, default_key).range_flags().empty());
  model.range_flag = {1, 0, 1, 0};
  EXPECT_TRUE(Electronics({part("gain")}, model, default_key).range_flags().empty());
  Electronics electronics({part("gain", 0.0), part("valid_range")}, model, default_key);
  const std::span<const float> flags = electronics.range_flags();
  const auto after = [&](std::vector<float> sample) {
    const std::vector<float> before = sample;
    electronics.apply(sample, 0.0);
    EXPECT_EQ(sample, before);
    return electronics.saturated();
  };
  EXPECT_EQ(after({2.0F, -6.0F, 0.0F, 0.0F}), 0U);
  EXPECT_THAT(flags, ElementsAre(0.0F, 0.0F));
  EXPECT_EQ(after({0.0F, 0.0F, -2.01F, 0.0F}), 1U);
  EXPECT_THAT(flags, ElementsAre(0.0F, 1.0F));
  EXPECT_EQ(after({2.01F, 6.01F, 2.01F, 0.0F}), 2U) << "a sample counts once";
  EXPECT_THAT(flags, ElementsAre(1.0F, 1.0F));
  EXPECT_EQ(after({0.0F, 0.0F, 0.0F, 0.0F}), 2U);
  EXPECT_THAT(flags, ElementsAre(0.0F, 0.0F)) << "a flag is of one sample";
}

TEST(CouplingPart, ReadsTheUndisturbedSample) {
  // Two values that leak into each other: y(1,1) = y(1,0) + y(0,1) holds for any linear map. If the
  // second value read the first one after its disturbance, y(1,0) and y(0,1) would contain products
  // of coefficients, and the diagonal would not be 1.
  SignalModel model = two_values_a_source(1);
  model.couplings = {{0, 1, 0.5}, {1, 0, 0.5}};
  Electronics electronics({part("coupling")}, model, default_key);
  std::vector<float> first{1.0F, 0.0F};
  std::vector<float> second{0.0F, 1.0F};
  electronics.apply(first, 0.0);
  electronics.apply(second, 0.0);
  EXPECT_EQ(first[0], 1.0F);
  EXPECT_EQ(second[1], 1.0F);
  EXPECT_NE(first[1], 0.0F);
  EXPECT_NE(second[0], 0.0F);
}

std::vector<float> sample(Electronics& electronics, const SignalModel& model, int tick) {
  std::vector<float> values(model.source.size(), 0.5F);
  electronics.apply(values, 1e-3 * tick);
  return values;
}

void copy_memory(const Electronics& from, const Electronics& to) {
  const auto saved = from.memory(), loaded = to.memory();
  ASSERT_EQ(saved.size(), loaded.size());
  for (std::size_t k = 0; k < saved.size(); ++k) std::copy(saved[k].begin(), saved[k].end(), loaded[k].begin());
}

TEST(ElectronicsMemory, CopiedIntoAnotherChainItGoesOnToTheSameBits) {
  const SignalModel model = two_values_a_source(7);  // an odd number of sources
  std::vector<Named> every_part;
  for (const Entry& entry : electronics_entries()) every_part.push_back(part(entry.name));
  for (const int saved_at : {0, 1, 50}) {
    Electronics lasting(every_part, model, default_key), fresh(every_part, model, default_key),
        used(every_part, model, default_key);
    for (int tick = 0; tick < saved_at; ++tick) sample(lasting, model, tick);
    for (int tick = 0; tick < 33; ++tick) sample(used, model, tick);
    copy_memory(lasting, fresh);
    copy_memory(lasting, used);
    std::vector<float> last;
    for (int tick = saved_at; tick < saved_at + 50; ++tick) {
      const std::vector<float> values = sample(lasting, model, tick);
      ASSERT_EQ(values, sample(fresh, model, tick)) << "tick " << tick << " after " << saved_at;
      ASSERT_EQ(values, sample(used, model, tick)) << "tick " << tick << " after " << saved_at << " in the used chain";
      EXPECT_NE(values, last) << "noise changes from sample to sample";
      last = values;
    }
  }
}

TEST(ElectronicsMemory, IdealElectronicsHaveNone) {
  EXPECT_TRUE(Electronics({}, two_values_a_source(2), default_key).memory().empty());
}

}  // namespace
}  // namespace slipbench

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "detectors/detector_kinds.h"
#include "tests/detectors/frames.h"

namespace slipbench::yardsticks_test {
namespace {

constexpr double rate = 100.0;  // Hz: the window of 0.5 s has 50 frames
constexpr int frames = 50;

FrameSource scalar_source(std::size_t values) { return {"pad", "biotac_sp", rate, {{"electrodes", "counts", {values}, {}}}}; }

using Signal = std::function<std::vector<float>(int)>;

// The estimate after `count` frames of `signal`.
SlipEstimate after(const DetectorKind& kind, const FrameSource& source, double threshold, int count, const Signal& signal) {
  Parameters parameters = defaults_of(kind.about.parameters);
  parameters.set("threshold", threshold);
  const auto detector = kind.create(parameters, source);
  SlipEstimate last;
  for (int k = 0; k < count; ++k) {
    const std::vector<float> values = signal(k);
    last = detector->update({k / rate, values});
  }
  return last;
}

// s of the law, from slip_probability = s/(s + threshold) with threshold 1.
double score(const DetectorKind& kind, const FrameSource& source, const Signal& signal, int count = 3 * frames) {
  const double p = after(kind, source, 1.0, count, signal).features.at(0);
  return p / (1.0 - p);
}

// float32 values carry seven digits.
constexpr double digits = 1e-5;

// A whole number of periods of a sinusoid of amplitude A: standard deviation A/sqrt(2), whatever its
// level and its phase. The second value is constant: the mean halves it.
TEST(Deviation, IsThatOfASinusoid) {
  const auto sinusoid = [](double level) -> Signal {
    return [level](int k) {
      return std::vector<float>{static_cast<float>(level + 4.0 * std::sin(2.0 * std::numbers::pi * k / 25.0)), 7.0F};
    };
  };
  for (const int count : {frames, frames + 13, 40 * frames}) {
    EXPECT_NEAR(score(deviation_detector(), scalar_source(2), sinusoid(0.0), count), 0.5 * 4.0 / std::sqrt(2.0), digits) << count;
    // A float32 at 3,000 is rounded to 1.2e-4 of a count.
    EXPECT_NEAR(score(deviation_detector(), scalar_source(2), sinusoid(3000.0), count), 0.5 * 4.0 / std::sqrt(2.0), 1e-4)
        << count;
  }
}

// A default threshold belongs to the sensor on which it was measured: about others the detector gives a notice.
TEST(Yardsticks, SayThatADefaultThresholdIsOfAnotherSensor) {
  const auto notice = [](const DetectorKind& kind, const FrameSource& source, double factor) {
    Parameters parameters = defaults_of(kind.about.parameters);
    parameters.set("threshold", factor * parameters.number("threshold"));
    return kind.create(parameters, source)->notice();
  };
  const FrameSource forces{"pad", "papillarray", rate, {{"force", "N", {9, 3}, {}}}};
  EXPECT_EQ(notice(deviation_detector(), scalar_source(24), 1.0), "");
  EXPECT_THAT(notice(deviation_detector(), forces, 1.0),
              testing::HasSubstr("default threshold of 6 was measured on a biotac_sp"));
  EXPECT_EQ(notice(deviation_detector(), forces, 2.0), "");
  EXPECT_THAT(notice(sum_change_detector(), forces, 1.0), testing::HasSubstr("default threshold of 1 is assumed"));
}

// A line with the slope b per frame: variance b^2 (n^2 - 1)/12 of n frames.
TEST(Deviation, IsThatOfALine) {
  const Signal line = [](int k) { return std::vector<float>{0.25F * static_cast<float>(k)}; };
  EXPECT_NEAR(score(deviation_detector(), scalar_source(1), line), 0.25 * std::sqrt((frames * frames - 1) / 12.0), digits);
}

// Vectors: sinusoids of 0.3 N along x and 0.1 N along y, at 2 N and -4 N of two units, whose levels do not
// cancel. The normal force's own sinusoid averages to 0 and does not count.
TEST(RelativeDeviation, IsShearOverNormalLevel) {
  const Signal pad = [](int k) {
    const double wave = std::sin(2.0 * std::numbers::pi * k / 25.0);
    const auto f = [](double value) { return static_cast<float>(value); };
    return std::vector<float>{f(0.3 * wave), f(0.1 * wave), f(2.0 + wave), f(0.3 * wave), f(0.1 * wave), f(-4.0 - wave)};
  };
  const double shear = 2.0 * 0.5 * (0.3 + 0.1) / std::sqrt(2.0), level = 2.0 + 4.0;
  EXPECT_NEAR(score(relative_deviation_detector(), vector_source({"force"}, 2, rate), pad), shear / level, digits);
}

// Values without axes: amplitude 3 at the level 12, negative here, whose sign does not matter.
TEST(RelativeDeviation, OfValuesWithoutAxesIsOverTheirOwnLevel) {
  const Signal wave = [](int k) {
    return std::vector<float>{static_cast<float>(-12.0 + 3.0 * std::sin(2.0 * std::numbers::pi * k / 25.0))};
  };
  EXPECT_NEAR(score(relative_deviation_detector(), scalar_source(1), wave), 3.0 / std::sqrt(2.0) / 12.0, digits);
}

// Nothing touches: 0/0 is not slip, and a deviation over a level of 0 is.
TEST(RelativeDeviation, IsDefinedAtLevelZero) {
  const Signal nothing = [](int /*k*/) { return std::vector<float>{0.0F}; };
  const SlipEstimate still = after(relative_deviation_detector(), scalar_source(1), 1.0, frames, nothing);
  EXPECT_EQ(still.state, PadState::non_slip);
  EXPECT_EQ(still.features.at(0), 0.0);
  const Signal alternating = [](int k) { return std::vector<float>{k % 2 == 0 ? 1.0F : -1.0F, 0.0F, 0.0F}; };
  const SlipEstimate moving = after(relative_deviation_detector(), vector_source({"force"}, 1, rate), 1.0, frames, alternating);
  EXPECT_EQ(moving.state, PadState::gross);
  EXPECT_EQ(moving.features.at(0), 1.0);
}

// Two units with opposite shear of 1 N along x, 0.3 N more along x on one and 0.4 N along y on the other:
// the sum is (0.3, 0.4) N, of length 0.5 N, at 2 N + 3 N.
TEST(ShearRatio, IsThatOfTheWholePad) {
  const Signal pad = [](int /*k*/) { return std::vector<float>{1.3F, 0.0F, 2.0F, -1.0F, 0.4F, 3.0F}; };
  EXPECT_NEAR(score(shear_ratio_detector(), vector_source({"force"}, 2, rate), pad), 0.5 / 5.0, digits);
  EXPECT_THROW((void)after(shear_ratio_detector(), scalar_source(2), 1.0, 1, pad), SceneValueError);
}

// Three values that grow by 0.5, 0.25 and -0.125 per frame: 49 steps lie between the first and the last
// of 50 frames.
TEST(SumChange, IsTheChangeOverTheWindow) {
  const Signal lines = [](int k) {
    return std::vector<float>{0.5F * static_cast<float>(k), 0.25F * static_cast<float>(k), -0.125F * static_cast<float>(k)};
  };
  EXPECT_NEAR(score(sum_change_detector(), scalar_source(3), lines), 0.625 * (frames - 1), 1e-4);
  // As one vector: the length of (0.5, 0.25, -0.125) per frame.
  EXPECT_NEAR(score(sum_change_detector(), vector_source({"force"}, 1, rate), lines),
              std::sqrt(0.25 + 0.0625 + 0.015625) * (frames - 1), 1e-4);
}

TEST(Yardsticks, DecideAtTheThresholdOnceTheWindowIsFull) {
  const Signal line = [](int k) { return std::vector<float>{static_cast<float>(k)}; };
  EXPECT_EQ(after(sum_change_detector(), scalar_source(1), 49.0, frames - 1, line).state, PadState::no_contact);
  EXPECT_TRUE(std::isnan(after(sum_change_detector(), scalar_source(1), 49.0, frames - 1, line).features.at(0)));
  const SlipEstimate at = after(sum_change_detector(), scalar_source(1), 49.0, frames, line);
  EXPECT_EQ(at.state, PadState::gross);
  EXPECT_EQ(at.features.at(0), 0.5);
  EXPECT_EQ(after(sum_change_detector(), scalar_source(1), 49.01, frames, line).state, PadState::non_slip);
}

// At 2 Hz the window of 0.5 s would have one frame: two are compared.
TEST(Yardsticks, NeedTwoFramesAtLeast) {
  FrameSource slow = scalar_source(1);
  slow.rate = 2.0;
  const Signal line = [](int k) { return std::vector<float>{static_cast<float>(k)}; };
  EXPECT_EQ(after(sum_change_detector(), slow, 1.0, 2, line).state, PadState::gross);
}

}  // namespace
}  // namespace slipbench::yardsticks_test

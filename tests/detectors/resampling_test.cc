// Even frames at another rate against closed forms: straight lines, sines, white noise.
#include "detectors/resampling.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/core/random.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

struct Made {
  double time = 0.0;       // s, of the frame
  double available = 0.0;  // s, time of the sample with which it came
  std::vector<float> values;
};

// Keeps the frames that it gets.
class Keeper final : public Detector {
 public:
  explicit Keeper(std::vector<Made>& made) : made_(&made) {}
  const SlipEstimate& update(const SensorFrame& frame) override {
    made_->push_back({frame.time, 0.0, {frame.values.begin(), frame.values.end()}});
    return estimate_ = {frame.time, 0.0, PadState::gross};
  }

 private:
  std::vector<Made>* made_;
  SlipEstimate estimate_;
};

FrameSource source_at(double rate, std::span<const double> uneven = {}, bool interpolate = false) {
  return {.sensor = "pad",
          .type = "skin",
          .rate = rate,
          .channels = {{"force", "N", {2}, {}}},
          .uneven_times = uneven,
          .interpolate = interpolate};
}

// The frames at `wanted` [Hz] from samples at `times` with the values {signal(t), -signal(t)}.
std::vector<Made> made_from(const FrameSource& source, const std::vector<double>& times, double wanted,
                            const std::function<double(double)>& signal) {
  std::vector<Made> made;
  const Resampling resampling = resampling_of(source, wanted, "the reader");
  const auto detector = resampled(std::make_unique<Keeper>(made), resampling, source, "told");
  EXPECT_EQ(detector->notice(), "told");
  for (const double time : times) {
    const auto value = static_cast<float>(signal(time));
    const std::vector<float> values{value, -value};
    const std::size_t before = made.size();
    const SlipEstimate& said = detector->update({time, values});
    for (std::size_t k = before; k < made.size(); ++k) made[k].available = time;
    if (made.size() > before) {
      EXPECT_EQ(said.time, time) << "of the newest sample that was used";
    }
  }
  return made;
}

std::vector<double> clock(double rate, std::size_t count) {
  std::vector<double> times;
  for (std::size_t k = 0; k < count; ++k) times.push_back(5.0 + static_cast<double>(k) / rate);
  return times;
}

// A straight line is exact at every ratio, and no frame comes more than 1.5 samples late, or before
// its time.
TEST(Resampling, OfAStraightLineIsExactAndCausal) {
  for (const double rate : {150.0, 137.0, 101.5, 1000.0, 1234.5}) {
    const auto made = made_from(source_at(rate), clock(rate, 400), 100.0, [](double t) { return 3.0 * t - 14.0; });
    ASSERT_GE(static_cast<double>(made.size()), std::floor(398.5 / rate * 100.0)) << rate;
    for (std::size_t k = 0; k < made.size(); ++k) {
      const double time = 5.0 + 0.01 * static_cast<double>(k);
      EXPECT_NEAR(made[k].time, time, 1e-9) << rate;
      EXPECT_NEAR(made[k].values[0], 3.0 * time - 14.0, 1e-5) << rate << " Hz, frame " << k;
      EXPECT_EQ(made[k].values[1], -made[k].values[0]);
      EXPECT_GE(made[k].available, made[k].time - 1e-9);
      EXPECT_LE(made[k].available, made[k].time + 1.5 / rate + 1e-9);
    }
  }
}

// At 1.5 times the rate every second frame is a sample s(t) = sin(w t), and the next lies x = half a
// step h after the nearest sample n, the earlier of two: s_n + x (s_{n+1} - s_{n-1})/2
// = sin(w t_n) + x sin(w h) cos(w t_n).
TEST(Resampling, OfASineIsTheNearestSampleMovedAlongTheSlope) {
  const double w = 2.0 * std::numbers::pi * 20.0, step = 1.0 / 150.0;
  const auto made = made_from(source_at(150.0), clock(150.0, 100), 100.0, [w](double t) { return std::sin(w * (t - 5.0)); });
  ASSERT_GE(made.size(), 60U);
  for (std::size_t k = 2; k < made.size(); ++k) {
    const double at = 1.5 * static_cast<double>(k), nearest = std::floor(at), x = at - nearest, phase = w * nearest * step;
    EXPECT_NEAR(made[k].values[0], std::sin(phase) + x * std::sin(w * step) * std::cos(phase), 1e-5) << k;
  }
}

// White noise of variance 1. A frame at x steps from its nearest sample adds up this sample and two
// others times x/2 and -x/2, so its variance is 1 + x^2/2: at 1.5 times the rate x is 0 or 1/2, on
// average 1 + 1/16; at 1.37 times x is uniform in -1/2 to 1/2, 1 + 1/24; at whole multiples 1.
// Interpolation between two samples would give 3/4 and 2/3, a mean over 10 samples 1/10. The
// variance of n values has a standard deviation of sqrt(2/n), here .8 %.
TEST(Resampling, KeepsTheVarianceOfWhiteNoise) {
  for (const auto& [ratio, variance] : {std::pair{1.5, 1.0 + 1.0 / 16.0}, {1.37, 1.0 + 1.0 / 24.0}, {10.0, 1.0}}) {
    RandomStream random(7, 0, "noise");
    const double rate = 100.0 * ratio;
    const auto made = made_from(source_at(rate), clock(rate, static_cast<std::size_t>(30'000.0 * ratio)), 100.0,
                                [&](double) { return random.normal(); });
    double sum = 0.0;
    for (const Made& one : made) sum += double{one.values[0]} * double{one.values[0]};
    EXPECT_NEAR(sum / static_cast<double>(made.size()), variance, 0.03) << ratio;
  }
}

TEST(Resampling, TakesTheSamplesThemselvesAtAMultiple) {
  for (const double rate : {1000.0, 1004.0}) {  // a clock that is off by less than 1 %
    const auto made = made_from(source_at(rate), clock(rate, 95), 100.0, [](double t) { return std::sin(40.0 * t); });
    ASSERT_EQ(made.size(), 10U);
    for (std::size_t k = 0; k < made.size(); ++k)
      EXPECT_EQ(made[k].values[0], static_cast<float>(std::sin(40.0 * (5.0 + static_cast<double>(10 * k) / rate))));
  }
  EXPECT_FALSE(resampling_of(source_at(100.5), 100.0, "the reader").needed());
}

// Stamps whose steps [ms] repeat; `lost`: the step with this number is longer by 10 ms.
std::vector<double> stamps(const std::vector<double>& steps, std::size_t count, std::size_t lost = SIZE_MAX) {
  std::vector<double> times{5.0};
  for (std::size_t k = 0; k < count; ++k)
    times.push_back(times.back() + 1e-3 * (steps[k % steps.size()] + (k == lost ? 10.0 : 0.0)));
  return times;
}

// Steps of 9 and 11 ms are 100 Hz whatever their median is, and so are steps of 6 and 14 ms. Of 201
// short and 200 long steps the one with the lost sample is left out: 400 steps in 4 s, or, if it is
// a long one, in 3.998 s or 3.992 s, 100.2 Hz. 37 Hz in stamps of 10 ms has steps of 20 and 30 ms.
// One sample in ten missing: the step of 20 ms is no part of the rate.
TEST(SampledRate, IsThatOfTheStepsThatAreNoGaps) {
  for (const std::size_t lost : {std::size_t{200}, std::size_t{201}}) {
    for (const std::vector<double>& steps : {std::vector{9.0, 11.0}, {6.0, 14.0}, {10.0}})
      EXPECT_NEAR(sampled_rate(stamps(steps, 401, lost)), 100.0, 0.21) << steps.front() << ", " << lost;
  }
  std::vector<double> rounded;
  for (int k = 0; k <= 370; ++k) rounded.push_back(0.01 * std::round(k / 0.37));
  EXPECT_NEAR(sampled_rate(rounded), 37.0, 1e-9);
  EXPECT_NEAR(sampled_rate(stamps({10, 10, 10, 10, 10, 10, 10, 10, 10, 20}, 400)), 100.0, 1e-9);
  EXPECT_NEAR(sampled_rate(std::vector{0.0, 0.02}), 50.0, 1e-9);
}

// Stamps at 100 Hz that are off by up to 20 % of a step, and a lost sample. The sum of the steps is
// wrong by two stamps and the gap by two more, together at most 8 ms of 2 s: .4 %. The median step
// of so few was off by more than 1 % in a sixth of the recordings.
TEST(SampledRate, OfJitterIsWithinHalfAPercent) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    RandomStream random(seed, 0, "jitter");
    std::vector<double> times;
    for (int k = 0; k < 200; ++k) times.push_back(0.01 * (k + 0.4 * (random.uniform() - 0.5) + (k > 100 ? 1.0 : 0.0)));
    EXPECT_NEAR(sampled_rate(times), 100.0, 0.5) << seed;
    EXPECT_EQ(resampling_of(source_at(99.5, times), 100.0, "the network").stride, 1.0) << seed;
  }
}

// 200 steps of 10 ms, 200 of 14.6 ms, less than 1.5 frames at 100 Hz: 400/(4.92 s) = 81.3 Hz, of
// which 100 Hz are 1.23 times as much. After 260 steps of 5 ms, 14.6 ms are gaps of the recording,
// but not of the network's frames, and last 2.92 s of 4.22 s: ten stretches, and 69 %.
TEST(Resampling, RefusesOrSaysAChangeOfTheRate) {
  const auto slowed = [](double step, std::size_t count) {
    std::vector<double> times = stamps({step}, count);
    for (std::size_t k = 0; k < 200; ++k) times.push_back(times.back() + 0.0146);
    return times;
  };
  const std::vector<double> from_100 = slowed(10.0, 200), from_200 = slowed(5.0, 260);
  EXPECT_THAT(refusal_of([&] { resampling_of(source_at(81.3, from_100), 100.0, "the network"); }),
              mentions({"81.3 Hz", "100 Hz", "1.23 times as much", "--resample"}));
  EXPECT_THAT(refusal_of([&] { resampling_of(source_at(108.0, from_200), 100.0, "the network"); }),
              mentions({"200 Hz", "68.49 Hz", "100 Hz", "69 %", "10 %", "--resample", "import --rate"}));
  const FrameSource any = source_at(108.0, from_200, true);
  EXPECT_THAT(resampling_text(resampling_of(any, 100.0, "the network"), any, "net.onnx"),
              mentions({"down to 68.49 Hz in places", "figures"}));
  // A network that reads 50 Hz has all that it needs.
  const FrameSource enough = source_at(108.0, from_200);
  EXPECT_EQ(resampling_text(resampling_of(enough, 50.0, "the network"), enough, "net.onnx"),
            "resampled from 200 Hz to 50 Hz for net.onnx; down to 68.49 Hz in places");
  // 20 steps of 12.5 ms in 12.25 s are 2 %; 10 % of a recording may be slow, as gaps may.
  std::vector<double> brief = stamps({10.0}, 600);
  for (std::size_t k = 0; k < 20; ++k) brief.push_back(brief.back() + 0.0125);
  for (std::size_t k = 0; k < 600; ++k) brief.push_back(brief.back() + 0.01);
  const FrameSource mostly = source_at(99.6, brief);
  EXPECT_EQ(resampling_text(resampling_of(mostly, 100.0, "the network"), mostly, "net.onnx"),
            "resampled evenly at 100 Hz for net.onnx; down to 80 Hz in places");
}

// A detector of any rate is refused for gaps alone.
TEST(Resampling, EvensAtTheRecordingsOwnRate) {
  for (const std::size_t count : {400U, 401U}) {
    const std::vector<double> pairs = stamps({6.0, 14.0}, count);
    const Resampling even = even_resampling_of(source_at(100.0, pairs), "deviation");
    EXPECT_NEAR(even.rate, 100.0, 0.2);
    EXPECT_EQ(even.stride, 1.0);
    EXPECT_EQ(even.gaps, 0U);
  }
  std::vector<double> changed = stamps({10.0}, 200);
  for (std::size_t k = 0; k < 200; ++k) changed.push_back(changed.back() + 0.0146);
  const FrameSource source = source_at(81.0, changed);
  EXPECT_EQ(resampling_text(even_resampling_of(source, "deviation"), source, "deviation"),
            "resampled evenly at 81.3 Hz for deviation; down to 68.49 Hz in places");
  // Steps of 1.6 typical ones are gaps, as for a network: 200 of 16 ms in 4 s.
  const std::vector<double> packets = stamps({16.0, 4.0}, 400);
  EXPECT_THAT(refusal_of([&] { even_resampling_of(source_at(100.0, packets), "deviation"); }),
              mentions({"200 gaps", "80 %", "--resample"}));
}

// Every 10 ms with a jitter of 1 %; after sample 40 a step of 15.9 ms. A straight line is exact but
// for 5 % of a step, within which a stamp counts as the frame's time.
TEST(Resampling, BridgesAShortGap) {
  RandomStream random(3, 0, "jitter");
  std::vector<double> times;
  for (int k = 0; k < 100; ++k) times.push_back(0.01 * k + 1e-4 * (random.uniform() - 0.5) + (k > 40 ? 0.0059 : 0.0));
  times.front() = 0.0;
  const FrameSource source = source_at(99.4, times);
  const auto made = made_from(source, times, 100.0, [](double t) { return 2.0 * t; });
  ASSERT_GE(made.size(), 99U);
  for (std::size_t k = 0; k < made.size(); ++k) {
    EXPECT_NEAR(made[k].values[0], 2.0 * 0.01 * static_cast<double>(k), 2.0 * 0.0006) << k;
    EXPECT_LE(made[k].time, made[k].available);
  }
  const Resampling bridged = resampling_of(source, 100.0, "x");
  EXPECT_THAT(resampling_text(bridged, source, "net.onnx"), mentions({"100 Hz", "net.onnx", "1 gap", "15.9"}));
  EXPECT_FALSE(bridged.made_up) << "the gap is below 0.1 s";
}

TEST(Resampling, RefusesWithTheRemedy) {
  const auto refusal = [](const FrameSource& source) { return refusal_of([&] { resampling_of(source, 100.0, "the network"); }); };
  EXPECT_THAT(refusal(source_at(37.0)), mentions({"37 Hz", "100 Hz", "2.7 times", "--resample"}));
  std::vector<double> gap = clock(100.0, 200), packets;
  for (std::size_t k = 100; k < 200; ++k) gap[k] += 0.3;
  EXPECT_THAT(refusal(source_at(80.0, gap)), mentions({"310 ms", "990 ms", "0.1 s", "--resample", "import --rate"}));
  for (std::size_t k = 0; k < 200; ++k)
    packets.push_back(0.1 * static_cast<double>(k / 10) + 0.001 * static_cast<double>(k % 10));
  // 19 steps of 91 ms in 1.909 s
  EXPECT_THAT(refusal(source_at(104.0, packets)), mentions({"19 gaps", "91 %", "--resample", "import --rate"}));
  for (const auto& times : {gap, packets}) {
    EXPECT_NO_THROW(resampling_of(source_at(100.0, times, true), 100.0, "the network"));
  }
}

// Below the rate, frames lie on the straight lines between samples: 40 Hz to 100 Hz, k/2.5 samples.
TEST(Resampling, InterpolatesASlowSensorWhenAsked) {
  const FrameSource source = source_at(40.0, {}, true);
  const auto parabola = [](double t) { return (t - 5.0) * (t - 5.0); };
  const auto made = made_from(source, clock(40.0, 41), 100.0, parabola);
  ASSERT_EQ(made.size(), 101U);
  for (std::size_t k = 0; k < made.size(); ++k) {
    const double at = static_cast<double>(k) / 2.5, low = std::floor(at + 1e-9), share = at - low;
    const double expected = (1.0 - share) * parabola(5.0 + low / 40.0) + share * parabola(5.0 + (low + 1.0) / 40.0);
    EXPECT_NEAR(made[k].values[0], expected, 1e-6) << k;
  }
  EXPECT_THAT(resampling_text(resampling_of(source, 100.0, "x"), source, "net.onnx"),
              mentions({"interpolated", "40 Hz", "100 Hz", "figures"}));
}

// 1e9 s at 100 Hz are 1e11 frames.
TEST(Resampling, RefusesAStepOfAMillionFrames) {
  std::vector<double> times = clock(100.0, 50);
  for (std::size_t k = 25; k < 50; ++k) times[k] += 1e9;
  EXPECT_THAT(refusal_of([&] { resampling_of(source_at(100.0, times, true), 100.0, "x"); }), mentions({"100 Hz", "million"}));
  EXPECT_THAT(refusal_of([] { resampling_of(source_at(1e-5, {}, true), 100.0, "x"); }), mentions({"million"}));
}

// A detector that is made for sensors of 40 Hz or more reads them without being asked.
TEST(Resampling, InterpolatesTheRatesThatADetectorIsMadeFor) {
  const Resampling made_for = resampling_of(source_at(50.0), 100.0, "the network", 40.0);
  EXPECT_EQ(made_for.rate, 100.0);
  EXPECT_EQ(made_for.stride, 0.5);
  EXPECT_EQ(resampling_text(made_for, source_at(50.0), "net.onnx"), "interpolated from 50 Hz to 100 Hz for net.onnx");
  EXPECT_THAT(refusal_of([] { resampling_of(source_at(20.0), 100.0, "the network", 40.0); }),
              mentions({"20 Hz", "40 Hz or more", "2 times"}));
  // Its steps of 20 ms are no gaps.
  std::vector<double> times = clock(50.0, 100);
  for (std::size_t k = 50; k < times.size(); ++k) times[k] += 0.012;
  EXPECT_EQ(resampling_of(source_at(49.7, times), 100.0, "the network", 40.0).gaps, 1U);
}

// A channel that is new in every third sample keeps the value of the latest sample at its time.
TEST(Resampling, HoldsASlowChannel) {
  FrameSource source = source_at(150.0);
  source.channels.front().every = 3;
  const auto made = made_from(source, clock(150.0, 90), 100.0, [](double t) { return std::round((t - 5.0) * 150.0); });
  for (std::size_t k = 0; k < made.size(); ++k) EXPECT_EQ(made[k].values[0], std::floor(1.5F * static_cast<float>(k))) << k;
}

}  // namespace
}  // namespace slipbench

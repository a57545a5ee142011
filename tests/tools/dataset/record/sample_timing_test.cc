// Rates from time stamps, and even spacing. Expected values are those of the clocks that make the
// stamps.
#include "tools/dataset/record/sample_timing.h"

#include <cmath>
#include <functional>
#include <vector>

#include "sim/core/random.h"
#include "tests/expect.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench {
namespace {

std::vector<double> stamps(std::size_t count, const std::function<double(double)>& at) {
  std::vector<double> times;
  for (std::size_t k = 0; k < count; ++k) times.push_back(at(static_cast<double>(k)));
  return times;
}

// As a source writes them: multiples of its resolution.
std::vector<double> rounded(std::vector<double> times, double resolution) {
  for (double& time : times) time = std::round(time / resolution) * resolution;
  return times;
}

struct Clock {
  double rate;        // Hz
  std::size_t count;  // stamps
  double resolution;  // s
};

// (n - 1)/T has the relative uncertainty q/T. For 444 Hz in ms over 6.75 s this is 1.5e-4, 0.07 Hz:
// the only three-digit value within is 444.
TEST(RateOf, IsTheClocksOwnWhereTheStampsAllowIt) {
  for (const Clock& clock :
       {Clock{44'100, 4410, 1e-9}, Clock{48'000, 4800, 1e-9}, Clock{30, 90, 1e-9}, Clock{700e3, 3000, 1e-9},
        Clock{2e6, 3000, 1e-9}, Clock{3000, 3000, 1e-9}, Clock{2400, 2400, 1e-9}, Clock{444, 3000, 1e-3}, Clock{60, 600, 1e-3},
        Clock{1000, 10, 1e-3}, Clock{44'100, 4410, 1e-6}, Clock{0.1, 100, 1.0}, Clock{99.99, 500, 1e-6}, Clock{1000, 2, 1e-3}}) {
    const auto times = rounded(stamps(clock.count, [&](double k) { return k / clock.rate; }), clock.resolution);
    EXPECT_EQ(rate_of(times, clock.resolution), clock.rate) << clock.rate << " Hz in " << clock.resolution << " s";
    EXPECT_TRUE(evenly_spaced(times, clock.resolution)) << clock.rate << " Hz";
    EXPECT_FALSE(steps_vary(timing_of(times, clock.resolution))) << clock.rate << " Hz";
  }
}

// A clock 0.01 % slow: 500 stamps in us give its rate within 2e-7, stamps in ms within 2e-4, which
// includes 100 Hz.
TEST(RateOf, OfASlowClockIsNotRounded) {
  EXPECT_EQ(rate_of(rounded(stamps(500, [](double k) { return 0.010001 * k; }), 1e-6), 1e-6), 99.99);
  EXPECT_EQ(rate_of(rounded(stamps(500, [](double k) { return 0.010001 * k; }), 1e-3), 1e-3), 100.0);
}

// Times since 1970 in ns: doubles are 0.24 us apart there.
TEST(RateOf, OfAnEpochIsThatOfItsSteps) {
  const auto times = stamps(600, [](double k) { return (1581073084690542592.0 + 10e6 * k) * 1e-9; });
  EXPECT_EQ(rate_of(times, 1e-9), 100.0);
  EXPECT_TRUE(evenly_spaced(times, 1e-9));
}

struct Uneven {
  const char* name;
  std::size_t count;
  std::function<double(double)> at;
  double mean, median, gap, gap_at;  // Hz, Hz, s, s; gap_at is NaN if several steps are equally long
};

// Ten samples 1 ms apart every 0.1 s: 599 steps in 59 * 0.1 s + 9 ms. 300 at 100 Hz and 300 at 50
// Hz: 3 s and 299/50 s. A pause of 0.5 s: 5.99 s + 0.5 s. One of 1,000 samples missing: 998 steps
// in 0.999 s.
const std::vector<Uneven> uneven{
    {"bursts", 600, [](double k) { return 0.1 * std::floor(k / 10.0) + 0.001 * std::fmod(k, 10.0); }, 599.0 / 5.909, 1000.0,
     0.091, NAN},
    {"two rates", 600, [](double k) { return k < 300.0 ? k / 100.0 : 3.0 + (k - 300.0) / 50.0; }, 599.0 / 8.98, 100.0, 0.02, NAN},
    {"gap", 600, [](double k) { return k / 100.0 + (k < 300.0 ? 0.0 : 0.5); }, 599.0 / 6.49, 100.0, 0.51, 2.99},
    {"lost sample", 999, [](double k) { return (k < 500.0 ? k : k + 1.0) / 1000.0; }, 998.0 / 0.999, 1000.0, 0.002, 0.499}};

TEST(SampleTiming, HasMeanMedianAndLongestStep) {
  for (const Uneven& one : uneven) {
    const auto times = stamps(one.count, one.at);
    const SampleTiming timing = timing_of(times, 1e-6);
    EXPECT_NEAR(timing.mean_rate, one.mean, 1e-9 * one.mean) << one.name;
    EXPECT_NEAR(timing.median_rate, one.median, 1e-6 * one.median) << one.name;
    EXPECT_NEAR(timing.largest_gap, one.gap, 1e-9) << one.name;
    if (!std::isnan(one.gap_at)) {
      EXPECT_NEAR(timing.largest_gap_at, one.gap_at, 1e-9) << one.name;
    }
    EXPECT_NEAR(rate_of(times, 1e-6), one.mean, 2e-6 * one.mean) << one.name;
    EXPECT_TRUE(steps_vary(timing)) << one.name;
    EXPECT_FALSE(evenly_spaced(times, 1e-6)) << one.name;
  }
}

// Two steps, of 1 s and 3 s: the median is halfway.
TEST(SampleTiming, MedianOfAnEvenNumberOfSteps) {
  EXPECT_DOUBLE_EQ(timing_of(std::vector{0.0, 1.0, 4.0}, 1e-6).median_rate, 1.0 / 2.0);
}

// Mean and median agree although a third of the recording has another rate: 90, 100 and 110 Hz. The
// same holds for a clock that slows down continuously.
TEST(EvenlySpaced, LooksAtEveryStretch) {
  const auto three = [](double k) {
    if (k < 200.0) return k / 90.0;
    if (k < 400.0) return 200.0 / 90.0 + (k - 200.0) / 100.0;
    return 200.0 / 90.0 + 2.0 + (k - 400.0) / 110.0;
  };
  EXPECT_FALSE(evenly_spaced(stamps(600, three), 1e-6));
  EXPECT_FALSE(evenly_spaced(stamps(600, [](double k) { return k / 100.0 * (1.0 + 1e-4 * k); }), 1e-6));
}

// Each stamp is off by up to 20 % of a step, so two differ by at most 40 % of a step, less than
// half. The steps vary by more than 1 %.
TEST(EvenlySpaced, ToleratesJitterOfLessThanHalfAStep) {
  RandomStream random(1, 0, "jitter");
  const auto times = stamps(600, [&](double k) { return (k + 0.2 * (2.0 * random.uniform() - 1.0)) / 111.0; });
  EXPECT_TRUE(evenly_spaced(times, 1e-6));
  EXPECT_TRUE(steps_vary(timing_of(times, 1e-6)));
  EXPECT_NEAR(rate_of(times, 1e-6), 111.0, 0.4 / 599.0 * 111.0);
}

TEST(EvenlySpaced, IsASingleSample) {
  EXPECT_TRUE(evenly_spaced(std::vector<double>{}, 1e-6));
  EXPECT_TRUE(evenly_spaced(std::vector<double>{1.0}, 1e-6));
}

TEST(CheckEvenlySpaced, NamesTheGap) {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.time = stamps(600, uneven[2].at);
  EXPECT_THAT(refusal_of([&] { check_evenly_spaced(sensor); }),
              refused_at("sensor pad", {"92.2958 Hz", "100 Hz", "0.51 s", "2.99 s", "--rate"}));
}

}  // namespace
}  // namespace slipbench

// The multiplexed scan: the instant of each reading, the average of si, and the state carried
// between readings.
#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "tests/sensors/nib_pad/rig.h"

namespace slipbench::nib_pad_test {
namespace {

constexpr double scan_time = 1.0 / 2400.0;

// The frame after `readings` readings from t = 0 of a contact that changes with time.
std::vector<float> after(Sensor& sensor, std::size_t readings, const std::function<ContactFrame(double)>& truth) {
  std::vector<float> values;
  for (std::size_t k = 0; k < readings; ++k) {
    ContactFrame now = truth(static_cast<double>(k) * scan_time);
    now.time = static_cast<double>(k) * scan_time;
    const SensorFrame& frame = sensor.measure(now);
    values.assign(frame.values.begin(), frame.values.end());
  }
  return values;
}

// 20 N/s on every nib: a reading at t shows the gap under 20 t N.
double pressed(double t) { return 20.0 * t / 10.4; }
ContactFrame ramp(double t) { return contact(20.0 * t); }

TEST(NibPadScan, EachValueIsReadAtItsOwnInstant) {
  const auto sensor = make({{"average", std::int64_t{1}}});
  ASSERT_EQ(sensor->scans(), 8U);
  const auto values = after(*sensor, 9 * 8, ramp);
  // The last sample begins with reading 64: fl N, fl S, fr +, fr -.
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(values[fl + k], counts(300.0, 36.0 * risen(pressed(static_cast<double>(64 + k) * scan_time))));
    EXPECT_EQ(values[fr + k], counts(300.0, 48.0 * risen(pressed(static_cast<double>(66 + k) * scan_time))));
  }
  // Taxel t is read in sample t, from its fifth reading on.
  for (std::size_t taxel = 0; taxel < 9; ++taxel) {
    for (std::size_t side = 0; side < 4; ++side) {
      const double t = static_cast<double>(8 * taxel + 4 + side) * scan_time;
      EXPECT_EQ(values[si(taxel, side)], counts(850.0, 4.0 * risen(pressed(t)))) << taxel << " " << side;
    }
  }
}

// Effect of the skew: under growing pressure the first cluster reads less than the second.
TEST(NibPadScan, SkewLooksLikeShear) {
  const auto values = after(*make(), 80, ramp);
  EXPECT_LT(values[fl], values[fl + 1]);
  const auto at_one_instant = image(*make(at_once()), ramp(79.0 * scan_time));
  EXPECT_EQ(at_one_instant[fl], at_one_instant[fl + 1]);
}

TEST(NibPadScan, ChannelsSayHowOldTheirValuesAre) {
  // Ages in readings before the last one: fl 7 and 6; fr 5 and 4; si from 67 (taxel 0, W) to 0
  // (taxel 8, S).
  const auto multiplexed = make();
  EXPECT_NEAR(multiplexed->channels()[1].age, 6.5 * scan_time, 1e-15);
  EXPECT_NEAR(multiplexed->channels()[2].age, 4.5 * scan_time, 1e-15);
  EXPECT_NEAR(multiplexed->channels()[0].age, 33.5 * scan_time, 1e-15);
  EXPECT_EQ(multiplexed->channels()[0].every, 9U);
  EXPECT_EQ(multiplexed->channels()[1].every, 1U);
  const auto simultaneous = make(at_once());
  for (const Channel& channel : simultaneous->channels()) EXPECT_EQ(channel.age, 0.0);
  EXPECT_EQ(simultaneous->channels()[0].every, 9U);
  EXPECT_EQ(simultaneous->scans(), 1U);
}

TEST(NibPadScan, SimultaneousImageIsThatOfTheNinthSample) {
  const auto sensor = make(at_once());
  for (int k = 0; k < 9; ++k) {
    const auto before = after(*sensor, 1, [&](double) { return contact(0.1 * k); });
    EXPECT_EQ(before[fl], counts(300.0, 36.0 * risen(0.1 * k / 10.4)));
    EXPECT_EQ(before[si(0, west)], k < 8 ? 6962.0F : counts(850.0, 4.0 * risen(0.8 / 10.4))) << k;
  }
}

// A step of the force before the second image: after n images with the force the mean of five has
// covered n/5 of the step. With fewer than five images it is their mean.
TEST(NibPadScan, SiIsTheMeanOfTheLastFiveImages) {
  const double pressed_counts = counts(850.0, 4.0 * risen(0.4 / 10.4));
  const auto sensor = make();
  EXPECT_EQ(image(*sensor, contact())[0], 6962.0F);
  for (int n = 1; n <= 7; ++n) {
    const double images = std::min(n + 1, 5), with = std::min(n, 5);
    EXPECT_FLOAT_EQ(image(*sensor, contact(0.4))[0], static_cast<float>(6962.0 + (pressed_counts - 6962.0) * with / images)) << n;
  }
}

TEST(NibPadScan, FrameChangesWhenItsSampleIsComplete) {
  const auto sensor = make();
  for (std::size_t reading = 0; reading < 7; ++reading) {
    const SensorFrame& frame = sensor->measure(contact(0.4));
    EXPECT_TRUE(std::ranges::all_of(frame.values, [](float value) { return value == 6962.0F; }));
  }
  const SensorFrame& frame = sensor->measure(contact(0.4));
  EXPECT_GT(frame.values[fl], 6962.0F);
  EXPECT_GT(frame.values[si(0, west)], 6962.0F);
  EXPECT_EQ(frame.values[si(1, west)], 6962.0F);
}

// The state is moved to another sensor in the middle of a sample and an image, with fewer than five
// images read.
TEST(NibPadScan, MemoryIsAllThatIsCarried) {
  const auto one = make(), other = make();
  const auto push = [](double t) { return contact(5.0 * t, 1e-3 * t, -2e-3 * t); };
  after(*one, 3 * 72 + 29, push);
  after(*other, 11, ramp);
  const auto from = one->memory(), to = other->memory();
  ASSERT_EQ(from.size(), to.size());
  for (std::size_t i = 0; i < from.size(); ++i) std::ranges::copy(from[i], to[i].begin());
  for (int reading = 0; reading < 200; ++reading) {
    const ContactFrame truth = push(0.1 + 1e-4 * reading);
    const auto expected = one->measure(truth).values, got = other->measure(truth).values;
    ASSERT_TRUE(std::ranges::equal(expected, got)) << reading;
  }
}

// Typical noise before rounding: white, sd 1.5 counts for si and 1.2 for clusters; rounding adds
// 1/12. Over 4,500 samples of two clusters and 500 images of 36 values the relative standard errors
// of an sd are 1/sqrt(2 n) = 0.75 % and 0.53 %, those of a correlation between successive readings
// 1/sqrt(n) = 1.1 % and 0.75 %; five of each are allowed.
TEST(NibPadScan, NoiseIsWhiteAndOfItsSize) {
  std::vector<Named> parts;
  for (const Entry& entry : nib_pad_sensor().electronics) {
    if (entry.name == "noise") parts.push_back({entry.name, defaults_of(entry.parameters)});
  }
  ASSERT_EQ(parts.size(), 1U);
  Parameters parameters = defaults_of(nib_pad_sensor().about.parameters);
  parameters.set("average", std::int64_t{1});
  const auto sensor = nib_pad_sensor().create(parameters, parts, 7, 0, "pad");
  struct Sums {
    double square = 0.0, product = 0.0;
    int count = 0;
  } si_sums, fl_sums;
  const auto add = [](Sums& sums, double now, double before) {
    sums.square += now * now;
    sums.product += now * before;
    ++sums.count;
  };
  std::vector<float> image_before(36, 6962.0F), cluster_before(2, 6962.0F);
  for (int k = 0; k < 500; ++k) {
    for (int sample = 0; sample < 9; ++sample) {
      const auto values = after(*sensor, 8, [](double) { return contact(); });
      for (std::size_t c = 0; c < 2; ++c) {
        add(fl_sums, values[fl + c] - 0.85 * 8191.0, cluster_before[c] - 0.85 * 8191.0);
        cluster_before[c] = values[fl + c];
      }
      if (sample != 8) continue;
      for (std::size_t v = 0; v < 36; ++v) {
        add(si_sums, values[v] - 0.85 * 8191.0, image_before[v] - 0.85 * 8191.0);
        image_before[v] = values[v];
      }
    }
  }
  EXPECT_NEAR(std::sqrt(fl_sums.square / fl_sums.count) / std::sqrt(1.2 * 1.2 + 1.0 / 12.0), 1.0, 5.0 * 0.0075);
  EXPECT_NEAR(std::sqrt(si_sums.square / si_sums.count) / std::sqrt(1.5 * 1.5 + 1.0 / 12.0), 1.0, 5.0 * 0.0053);
  EXPECT_NEAR(fl_sums.product / fl_sums.square, 0.0, 5.0 * 0.011);
  EXPECT_NEAR(si_sums.product / si_sums.square, 0.0, 5.0 * 0.0075);
}

}  // namespace
}  // namespace slipbench::nib_pad_test

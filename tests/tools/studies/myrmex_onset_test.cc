// The third sensor's rule and the true onset, of made-up recordings.
#include "tools/studies/myrmex_tactile_cnn/myrmex_onset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "sim/simulation/stage_setup.h"

namespace slipbench::reproduce {
namespace {

// 500 Hz for 4 s.
std::vector<double> times() {
  std::vector<double> t;
  for (int k = 0; k < 2000; ++k) t.push_back(k / 500.0);
  return t;
}

// A sum of 100 that falls from 3 s on by 50 a second.
std::vector<double> falling(const std::vector<double>& time) {
  std::vector<double> sum;
  for (const double t : time) sum.push_back(t < 3.0 ? 100.0 : 100.0 - 50.0 * (t - 3.0));
  return sum;
}

TEST(DecreaseOnset, IsWhereTheSumLeavesItsLevelForGood) {
  const std::vector<double> t = times();
  // At once without a threshold: the first sample below 100 is at 3.002 s. By 10 it lies below after 0.2 s.
  EXPECT_NEAR(decrease_onset(t, falling(t), {0.0, 0.0}, 1.0, 2.0, 4.0).value(), 3.002, 1e-9);
  EXPECT_NEAR(decrease_onset(t, falling(t), {0.0, 0.0}, 1.0, 2.0, 4.0, 9.99).value(), 3.2, 1e-9);
  EXPECT_FALSE(decrease_onset(t, falling(t), {0.0, 0.0}, 1.0, 2.0, 2.9).has_value()) << "not before the end";
  std::vector<double> dips = falling(t);
  dips[1200] = 0.0;
  EXPECT_NEAR(decrease_onset(t, dips, {0.0, 0.0}, 1.0, 2.0, 4.0).value(), 3.002, 1e-9) << "a dip is no onset";
}

TEST(DecreaseOnset, ThresholdCountsTheNoiseOfTheRest) {
  // +1 and -1 by turns: sd 1, by n - 1 of 500 samples sqrt(500/499). Three of them below 100 - 50 (t - 3) +- 1 for good: on the upper samples, 4.003
  // below the line, so from 3.0801 s on; an even sample is an upper one, 3.082 s (k = 1541) a lower one before the next upper.
  const std::vector<double> t = times();
  std::vector<double> sum = falling(t);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += k % 2 == 0 ? 1.0 : -1.0;
  EXPECT_NEAR(decrease_onset(t, sum, {0.0, 3.0}, 1.0, 2.0, 4.0).value(), 3.082, 1e-9);
  // A mean over two samples (3 ms hold two) is without noise, and that of a ramp is that of its middle: 1 ms late.
  EXPECT_NEAR(decrease_onset(t, sum, {0.003, 3.0}, 1.0, 2.0, 4.0, 10.0).value(), 3.202, 1e-9);
}

// A pad of two taxels that carry 3 N and 1 N.
SensorRecord pad(const std::vector<std::array<UnitState, 2>>& states) {
  SensorRecord sensor;
  sensor.type = "myrmex";
  sensor.labels.k_normal = {1.0, 1.0};
  SensorColumn taxels{"taxels", "counts", {1, 2}, {}, {}};
  for (std::size_t k = 0; k < states.size(); ++k) {
    sensor.time.push_back(static_cast<double>(k));
    const bool touches = states[k][0] != UnitState::detached;
    for (std::size_t u = 0; u < 2; ++u) {
      sensor.labels.unit_state.push_back(static_cast<std::uint8_t>(states[k][u]));
      sensor.labels.force.insert(sensor.labels.force.end(), {0.0F, 0.0F, !touches ? 0.0F : u == 0 ? 3.0F : 1.0F});
      taxels.values.push_back(touches ? 3000.0F : 4095.0F);
    }
    sensor.labels.state.push_back(static_cast<std::uint8_t>(touches ? PadState::non_slip : PadState::no_contact));
  }
  sensor.channels.push_back(taxels);
  return sensor;
}

constexpr UnitState stick = UnitState::stick, slip = UnitState::slip, apart = UnitState::detached;

TEST(TrueSlip, BeginsWhereHalfOfTheLoadSlipsForGoodOnBothPads) {
  const std::vector<std::array<UnitState, 2>> one{{stick, slip}, {slip, stick}, {stick, slip}, {slip, stick},
                                                  {slip, slip},  {slip, slip},  {apart, apart}};
  const std::vector<std::array<UnitState, 2>> other{{stick, stick}, {slip, slip}, {slip, slip}, {stick, slip},
                                                    {slip, stick},  {slip, slip}, {slip, slip}};
  // Both carry half or more on what slips at 1 s, and from 4 s on; contact is lost at 6 s.
  const TrueSlip found = true_slip(pad(one), pad(other), 0.0);
  EXPECT_EQ(found.onset.value(), 4.0);
  EXPECT_EQ(found.end, 5.0);
  EXPECT_FALSE(true_slip(pad({{stick, stick}}), pad({{slip, slip}}), 0.0).onset.has_value());
  EXPECT_EQ(slipping_share(pad(one))[0], 0.25);
  EXPECT_EQ(slipping_share(pad(one))[6], 0.0);
  // The other pad touches to the end, with 1,095 counts missing of each of its two taxels.
  EXPECT_EQ(contact_end(pad(one), pad(other), {false, 0.0, 205.0}), 6.0);
  EXPECT_EQ(contact_end(pad(one), pad(one), {false, 0.0, 205.0}), 5.0);
  EXPECT_EQ(contact_end(pad(one), pad(other), {false, 0.0, 1100.0}), 0.0) << "no taxel misses so much";
  EXPECT_EQ(contact_end(pad(one), pad(one), {true, 0.0, 1100.0}), 5.0) << "but both together";
  // A mean of two samples: at 6 s of 2,190 and 0.
  EXPECT_EQ(contact_end(pad(one), pad(one), {true, 2.0, 1090.0}), 6.0);
  EXPECT_EQ(contact_end(pad(one), pad(one), {true, 2.0, 1100.0}), 5.0);
  EXPECT_EQ(sum_of_contacts(pad(one))[0], 2.0 * 1095.0);
}

TEST(SideOfMass, IsWhereTheBodyIsHeldAndHowItsMassLies) {
  const auto shape = std::ranges::find(body_catalogue(), "cylinder", &Entry::name);
  BodyScene body{.name = "object", .shape = {"cylinder", defaults_of(shape->parameters)}};
  body.shape.parameters.set("position", std::vector<double>{0.0, 15e-3, 0.0});
  body.shape.parameters.set("rotation", std::vector<double>{-0.5 * std::numbers::pi, 0.0, 0.0});
  body.shape.parameters.set("centre_of_mass", std::vector<double>{0.0, 0.0, 10e-3});
  EXPECT_NEAR(side_of_mass(body), 25e-3, 1e-15) << "Z of a cylinder turned by -90 degrees about X is Y of the world";
}

}  // namespace
}  // namespace slipbench::reproduce

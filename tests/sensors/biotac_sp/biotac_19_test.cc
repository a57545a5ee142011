// The older BioTac with 19 electrodes: its skin, scan and noise.
#include <algorithm>
#include <cmath>

#include "sensors/biotac_sp/skin.h"
#include "tests/expect.h"
#include "tests/sensors/biotac_sp/rig.h"

namespace slipbench::biotac_sp_test {
namespace {

constexpr std::size_t count = biotac_sp::electrodes_19;

std::unique_ptr<Sensor> finger(const Changes& changes = {}, bool noisy = false) {
  Parameters parameters = defaults_of(biotac_19_sensor().about.parameters);
  for (const auto& [key, value] : changes) parameters.set(key, value);
  std::vector<Named> parts;
  for (const Entry& entry : biotac_19_sensor().electronics) {
    if (noisy && entry.name == "skewed_noise") {
      parts.push_back({entry.name, defaults_of(entry.parameters)});
      parts.back().parameters.set("tail_share", 0.0);
      parts.back().parameters.set("spike_share", 0.0);
    }
  }
  return biotac_19_sensor().create(parameters, parts, 7, 0, "finger");
}

TEST(BioTac19, HasItsSkinAboveItsElectrodes) {
  // The published skin is 7 mm from the finger's axis above the electrodes of the cylinder, and 7
  // mm from its origin above those of the round end, where x > 0. Half an ellipsoid of 16 x 7 x 7
  // mm about x = -7 mm is within 1.4 mm of this skin. Above E19, at x = -13.6 mm and 5.08 mm from
  // the axis, it is 5.08/sqrt((6.6/16)^2 + (5.08/7)^2) = 6.09 mm from the axis. Above E7, at
  // (4.763, 0, -2.33) mm, the ray from x = -7 mm meets it at (11.763, -2.33)/sqrt((11.763/16)^2 +
  // (2.33/7)^2) = (14.58, -2.89) mm, 8.11 mm from the origin.
  const biotac_sp::Skin skin =
      biotac_sp::make_skin({300, {16e-3, 7e-3, 7e-3}, 27.8e3, 0.5}, "sensors.finger", biotac_sp::electrode_places_19());
  ASSERT_EQ(skin.above.size(), count);
  const auto from_the_axis = [&](std::size_t e) {
    const Eigen::Vector3d& point = skin.above[e];  // in P, whose origin is 7 mm below the axis
    return std::hypot(point.y(), point.z() - 7e-3);
  };
  EXPECT_NEAR(from_the_axis(18), 6.09e-3, 5e-6);
  EXPECT_NEAR(std::hypot(skin.above[6].x() - 7e-3, from_the_axis(6)), 8.11e-3, 5e-6);
  for (std::size_t e = 0; e < count; ++e) {
    const double x = skin.above[e].x() - 7e-3, outwards = x > 0.0 ? std::hypot(x, from_the_axis(e)) : from_the_axis(e);
    EXPECT_NEAR(outwards, 7e-3, 1.4e-3) << e;
    EXPECT_GT(skin.layout.units[e].count, 0U) << e;
  }
  // Area of half the prolate ellipsoid: pi b^2 (1 + a/(b k) asin k), k^2 = 1 - b^2/a^2 = 0.8086:
  // 591 mm2. The mesh agrees to a thousandth.
  double area = 0.0;
  for (const double one : skin.area) area += one;
  EXPECT_NEAR(area, 591e-6, 1e-6);
}

TEST(BioTac19, ReadsEachElectrodeOnceARow) {
  // Rows of 11 cycles, rounds of 22 slots: cycle k of each row has the slots 2k and 2k + 1. The
  // skin sinks by 1 um per cycle, so that each value shows when it was read: it equals the value of
  // a finger that reads all electrodes at once at that depth.
  const auto depth = [](std::size_t n) { return 1e-6 * static_cast<double>(n); };
  const auto sensor = finger(), all = finger({{"scan", std::string("ideal")}, {"cycle_rate", 100.0}});
  std::vector<std::vector<float>> at_once_at;
  for (std::size_t n = 0; n < 55; ++n) {
    const SensorFrame& frame = all->measure(evenly_dented(*all, depth(n)));
    at_once_at.emplace_back(frame.values.begin(), frame.values.end());
  }
  ASSERT_EQ(sensor->scans(), 11U);
  for (std::size_t n = 0; n < 55; ++n) {
    const SensorFrame& frame = sensor->measure(evenly_dented(*sensor, depth(n)));
    if (n % 11 != 10) continue;
    for (std::size_t value = 0; value <= count; ++value) {  // and pdc, in slot 19
      EXPECT_EQ(frame.values[value], at_once_at[n - 10 + value / 2][value]) << n << ' ' << value;
    }
  }
  // Mean age: electrode e is read 10 - floor(e/2) cycles before the row's end, 19 * 10 - 81 = 109
  // in total; pdc one cycle. pac: 22 readings, whose middle is 10.5 half-cycles before the last.
  ASSERT_EQ(sensor->channels().size(), 3U);
  EXPECT_EQ(sensor->channels()[0].size(), 19U);
  EXPECT_EQ(sensor->channels()[2].size(), 22U);
  EXPECT_NEAR(sensor->channels()[0].age, 109.0 / 19.0 / 1100.0, 1e-12);
  EXPECT_NEAR(sensor->channels()[1].age, 1.0 / 1100.0, 1e-12);
  EXPECT_NEAR(sensor->channels()[2].age, 10.5 / 2200.0, 1e-12);
}

TEST(BioTac19, HasTheNoiseOfItsOwnRecordings) {
  // Noise of 1.25 counts plus rounding to whole counts, 1/12: sqrt(1.5625 + 0.0833) = 1.283. Over
  // 19 * 500 readings the standard error is 1/sqrt(2 n) = 0.73 %.
  const auto sensor = finger({}, true);
  double sum = 0.0, square = 0.0;
  constexpr int rows = 500;
  for (int n = 0; n < 11 * rows; ++n) {
    const SensorFrame& frame = sensor->measure(evenly_dented(*sensor, 0.0));
    if (n % 11 != 10) continue;
    for (std::size_t e = 0; e < count; ++e) {
      const double value = static_cast<double>(frame.values[e]) / (rows * count);
      sum += value;
      square += value * static_cast<double>(frame.values[e]);
    }
  }
  EXPECT_NEAR(std::sqrt(square - sum * sum) / 1.283, 1.0, 5.0 * 0.0073);
}

TEST(BioTac19, SaysItsOwnRadiiWhereTheyLeaveAnElectrodeWithoutSkin) {
  EXPECT_THAT(scene_refusal_of([] {
                finger({{"radii", std::vector{100e-3, 1e-3, 1e-3}}});
              }),
              refused_at("sensors.finger.radii", {"[100 mm, 1 mm, 1 mm]", "[16 mm, 7 mm, 7 mm]"}));
}

}  // namespace
}  // namespace slipbench::biotac_sp_test

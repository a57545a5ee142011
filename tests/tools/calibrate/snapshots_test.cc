#include "tools/calibrate/snapshots.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sensors/papillarray/papillarray.h"
#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/scenes.h"

namespace slipbench::calibrate::snapshots_test {
namespace {

using ::testing::HasSubstr;

// The law of the data: F_z = k_n d_z, F_x = k_t d_x + c k_n d_z, F_y = k_t d_y - c k_n d_z, with
// noise on d that F repeats.
struct Law {
  double normal = 6e3, tangential = 2.5e3;  // N/m
  double coupling = 0.1;                    // N/N
  double scatter = 0.0;                     // stiffness of unit u: 1 + scatter for even u, 1 - scatter for odd u
  double noise = 0.0;                       // factor on the PapillArray's figures
};

constexpr std::size_t units = 8, snapshots = 400;

// The first half of the snapshots is pressed by up to 0.5 mm, the second half is idle.
RawRecording recording_of(const Law& law, bool sheared = true) {
  RandomStream stream(1, 0, "snapshots");
  const SignalModel model = papillarray::signal_model({law.normal, law.tangential}, 500.0, {});
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "papillarray";
  sensor.rate = 500.0;
  SensorColumn force{.name = "force", .unit = "N", .shape = {units, 3}, .values = {}};
  SensorColumn displacement{.name = "displacement", .unit = "m", .shape = {units, 3}, .values = {}};
  for (std::size_t row = 0; row < snapshots; ++row) {
    sensor.time.push_back(static_cast<double>(row) / sensor.rate);
    for (std::size_t unit = 0; unit < units; ++unit) {
      const double factor = unit % 2 == 0 ? 1.0 + law.scatter : 1.0 - law.scatter;
      std::array<double, 3> d{}, n{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        n[axis] = stream.normal();
        if (row < snapshots / 2 && (sheared || axis == 2))
          d[axis] = axis == 2 ? 50e-6 + 450e-6 * stream.uniform() : 600e-6 * (stream.uniform() - 0.5);
      }
      const double lateral = law.coupling * law.normal * d[2];
      const std::array<double, 3> f{factor * (law.tangential * d[0] + lateral), factor * (law.tangential * d[1] - lateral),
                                    factor * law.normal * d[2]};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto sd = [&](std::size_t channel) { return law.noise * model.noise_sd[channel + axis]; };
        force.values.push_back(static_cast<float>(f[axis] + sd(0) * n[axis]));
        displacement.values.push_back(static_cast<float>(d[axis] + sd(papillarray::channel_size) * n[axis]));
      }
    }
  }
  sensor.channels = {force, displacement};
  return {.name = "made", .sensors = {sensor}, .params = "{}"};
}

Json key_of(const Json& result, const std::string& name) {
  for (const Json& one : result.at("keys")) {
    if (one.at("key") == "sensors.pad." + name) return one;
  }
  throw std::runtime_error("no key " + name);
}
double value_of(const Json& result, const std::string& name) { return key_of(result, name).at("value").get<double>(); }
double error_of(const Json& result, const std::string& name) { return key_of(result, name).at("standard_error").get<double>(); }

// Without noise the law comes back to the resolution of float32, 6e-8 of up to 3 N over 0.5 mm.
TEST(Snapshots, AnExactLawComesBack) {
  const Json result = fit_snapshots({recording_of({})}, "", default_idle);
  EXPECT_NEAR(value_of(result, "k_normal"), 6e3, 0.01);
  EXPECT_NEAR(value_of(result, "k_tangential"), 2.5e3, 0.01);
  EXPECT_EQ(result.at("snapshots"), snapshots);
  const Json& unit = result.at("units").at(0);
  EXPECT_EQ(unit.at("pressed"), snapshots / 2);
  EXPECT_EQ(unit.at("idle"), snapshots / 2);
  EXPECT_EQ(unit.at("pulled"), 0);
  EXPECT_NEAR(unit.at("matrix").at(0).at(2).get<double>(), 600.0, 0.01);  // c k_n
  EXPECT_NEAR(unit.at("matrix").at(1).at(2).get<double>(), -600.0, 0.01);
  // c = +-0.1 in every unit: limit = sqrt(3 * 0.1^2) = 0.1732.
  EXPECT_NEAR(value_of(result, "electronics.coupling.normal_to_shear"), 0.1732, 1e-5);
  EXPECT_NEAR(value_of(result, "electronics.coupling.shear_to_normal"), 0.0, 1e-5);
  EXPECT_NEAR(value_of(result, "electronics.coupling.shear_to_shear"), 0.0, 1e-5);
}

// Shear raises the normal force by 0.5 N/mm of d_x: rms of 500 and 0 N/m is 353.6 N/m. Over k_t =
// 2.5 N/mm that is 0.2 and 0 N/N, whose limit is sqrt(3 * 0.2^2/2) = 0.2449.
TEST(Snapshots, ShearInTheNormalForceIsFitted) {
  RawRecording recording = recording_of({});
  std::vector<float>& force = recording.sensors.front().channels[0].values;
  const std::vector<float>& displacement = recording.sensors.front().channels[1].values;
  for (std::size_t value = 2; value < force.size(); value += 3) force[value] += 500.0F * displacement[value - 2];
  const Json result = fit_snapshots({recording}, "", default_idle);
  EXPECT_NEAR(result.at("shear_to_normal").get<double>(), 353.6, 0.1);
  EXPECT_NEAR(value_of(result, "electronics.coupling.shear_to_normal"), 0.2449, 1e-4);
  EXPECT_NEAR(value_of(result, "k_normal"), 6e3, 0.01);
}

// Eight units of 1 +- 0.1: sd = 0.1 sqrt(8/7) = 0.1069. Gain: the ratios to the figures are
// 0.1069/0.18 twice and 0.1069/0.093, so sqrt((0.594^2 + 0.594^2 + 1.149^2)/3) = 0.822. Error of
// the mean: 0.1069 * 6000/sqrt(8) = 226.8 N/m.
TEST(Snapshots, ScatterOfTheUnitsIsTheErrorAndTheGain) {
  const Json result = fit_snapshots({recording_of({.scatter = 0.1})}, "", default_idle);
  EXPECT_NEAR(value_of(result, "k_normal"), 6e3, 0.01);
  EXPECT_NEAR(error_of(result, "k_normal"), 226.8, 0.1);
  EXPECT_NEAR(value_of(result, "electronics.gain.scale"), 0.822, 0.001);
}

// Noise of twice the device's figures. Each of 200 snapshots of a unit has six sds of three
// sources: a relative error of 1/sqrt(2*199*3) = 2.9 % a unit, 1.3 % of the median of eight.
TEST(Snapshots, NoiseComesBackWithinItsError) {
  const Json result = fit_snapshots({recording_of({.noise = 2.0})}, "", default_idle);
  EXPECT_NEAR(value_of(result, "electronics.noise.scale"), 2.0, 3 * 0.013 * 2.0);
  EXPECT_LT(error_of(result, "electronics.noise.scale"), 2 * 0.013 * 2.0);
  EXPECT_NEAR(value_of(result, "k_normal"), 6e3, 4.0 * error_of(result, "k_normal"));
  EXPECT_NEAR(value_of(result, "k_tangential"), 2.5e3, 4.0 * error_of(result, "k_tangential"));
  // FZ: 5.3 mN at 7.1 N/mm, so 2 * 5.3 * 6/7.1 = 8.96 mN; DZ: 2.8 um.
  EXPECT_NEAR(result.at("noise").at("force").at(2).get<double>(), 8.96e-3, 0.06 * 8.96e-3);
  EXPECT_NEAR(result.at("noise").at("displacement").at(2).get<double>(), 2.8e-6, 0.06 * 2.8e-6);
}

TEST(Snapshots, PulledUnitsAreLeftOut) {
  RawRecording recording = recording_of({});
  SensorColumn& force = recording.sensors.front().channels[0];
  SensorColumn& displacement = recording.sensors.front().channels[1];
  // Unit 0 is pulled in ten snapshots, with a force that its stiffness does not explain.
  for (std::size_t row = 0; row < 10; ++row) {
    displacement.values[3 * units * row + 2] = -1e-3F;
    force.values[3 * units * row + 2] = -1.0F;
  }
  const Json result = fit_snapshots({recording}, "", default_idle);
  EXPECT_EQ(result.at("units").at(0).at("pulled"), 10);
  EXPECT_NEAR(value_of(result, "k_normal"), 6e3, 0.01);
}

TEST(Snapshots, RefusalsNameTheCause) {
  const auto refusal = [](const RawRecording& recording, const std::string& sensor) {
    return refusal_of([&] { fit_snapshots({recording}, sensor, default_idle); });
  };
  EXPECT_THAT(refusal(recording_of({}, false), ""), refused_at("made", {"no unit of 'pad'", "vary independently"}));
  RawRecording other = recording_of({});
  other.sensors.front().channels.pop_back();
  EXPECT_THAT(refusal(other, ""), refused_at("made", {"force (N) and displacement (m)"}));
  EXPECT_THAT(refusal(recording_of({}), "skin"), refused_at("made", {"no sensor 'skin'", "pad"}));
  RawRecording two = recording_of({});
  two.sensors.push_back(two.sensors.front());
  two.sensors.back().name = "other";
  EXPECT_THAT(refusal(two, ""), refused_at("made", {"pad, other", "--sensor"}));
  EXPECT_NO_THROW(fit_snapshots({two}, "other", default_idle));
}

// A scene whose sensors are those of `text`, which ends with a block `sensors`.
Scene scene_with(const std::string& text) {
  return parsed(
      "slipbench: 1\nduration: 1 s\nsurface: {material: rubber}\nmotion: {kind: stage, start: 1 s, speed: 0, compression: 1 mm}\n" +
      text.substr(text.find("sensors:")));
}

// Pasted into a scene, the text gives the electronics `typical` except for the fitted values, which
// are printed to three digits.
TEST(Snapshots, TheTextIsABlockOfASceneWithAllParts) {
  const Json result = fit_snapshots({recording_of({.scatter = 0.1, .noise = 2.0})}, "", default_idle);
  const Scene fitted = scene_with(snapshot_text(result));
  const Scene typical = scene_with("sensors: {pad: {type: papillarray, electronics: typical}}");
  const Parameters& stiffness = fitted.sensors.at(0).parameters;
  EXPECT_NEAR(stiffness.number("k_normal") / value_of(result, "k_normal"), 1.0, 5e-4);
  EXPECT_NEAR(stiffness.number("k_tangential") / value_of(result, "k_tangential"), 1.0, 5e-4);

  const std::vector<Named>& parts = fitted.sensors.at(0).electronics;
  const std::vector<Named>& all = typical.sensors.at(0).electronics;
  ASSERT_EQ(parts.size(), all.size());
  std::size_t replaced = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(parts[k].name, all[k].name);
    for (const auto& [name, value] : all[k].parameters.values()) {
      const auto key = std::ranges::find(result.at("keys"), "sensors.pad.electronics." + all[k].name + "." + name,
                                         [](const Json& one) { return one.at("key").get<std::string>(); });
      if (key == result.at("keys").end()) {
        EXPECT_EQ(parts[k].parameters.values().at(name), value) << all[k].name << "." << name;
      } else {
        const double expected = key->at("value").get<double>();
        EXPECT_NEAR(parts[k].parameters.number(name), expected, 5e-3 * expected) << all[k].name << "." << name;
        ++replaced;
      }
    }
  }
  EXPECT_EQ(replaced, 5U) << "three limits of the coupling, the scales of gain and noise";
  EXPECT_EQ(snapshot_unit_table(result).rows.size(), units);
}

// Without idle units the noise is not fitted; its part stays at its default.
TEST(Snapshots, APartThatIsNotFittedStaysAtItsDefault) {
  RawRecording recording = recording_of({});
  SensorRecord& sensor = recording.sensors.front();
  sensor.time.resize(snapshots / 2);
  for (SensorColumn& channel : sensor.channels) channel.values.resize(3 * units * snapshots / 2);
  const std::string text = snapshot_text(fit_snapshots({recording}, "", default_idle));
  EXPECT_THAT(text, HasSubstr("      - noise\n"));
  EXPECT_EQ(scene_with(text).sensors.at(0).electronics.size(), papillarray::electronics_parts().size());
}

// Only for the PapillArray are the parts of the device known.
TEST(Snapshots, AnotherSensorsTextHasNoElectronics) {
  RawRecording recording = recording_of({});
  recording.sensors.front().type = "taxels";
  EXPECT_THAT(snapshot_text(fit_snapshots({recording}, "", default_idle)), ::testing::Not(HasSubstr("electronics")));
}

}  // namespace
}  // namespace slipbench::calibrate::snapshots_test

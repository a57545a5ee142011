// Several sensors in one scene: each sensor, its labels and a loop that reads it are independent of
// the other sensors.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenes.h"
#include "tests/tools/trial/same_record.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/run_trial.h"

namespace slipbench {
namespace {

using testing_run::expect_same_control;
using testing_run::expect_same_sensor;

// Press and slide with shaking motors; `types` are the sensors, each named after its type, in that
// order.
Scene scene_of(const std::vector<std::string>& types, const std::string& effects, const std::string& read) {
  std::string text =
      "slipbench: 1\nseed: 3\nduration: 0.6 s\nmotion: {compression: 0.3 mm, start: 0.3 s, speed: 8 mm/s, acceleration: 500 mm/s2, vibration: 1}\neffects: " +
      effects + "\nsensors:\n";
  for (const std::string& type : types) text += "  " + type + ": {type: " + type + ", electronics: typical}\n";
  if (!read.empty()) text += "detector: {type: truth, sensor: " + read + ", latency: 3 ms, flip: 0.1}\n";
  return parsed(text);
}

TrialRecord run(const std::vector<std::string>& types, const std::string& effects, const std::string& read) {
  return run_trial(scene_of(types, effects, read), 0, Recording::full).record;
}

std::vector<std::string> all_types() {
  std::vector<std::string> types;
  for (const Entry& entry : pad_catalogues().sensors) types.push_back(entry.name);
  std::erase(types, "plugin");  // not a sensor without a library
  return types;
}

// Without sensors whose elements have dashpots, which exclude tips with mass.
std::vector<std::string> types_without_dashpots() {
  std::vector<std::string> types = all_types();
  std::erase_if(types, [](const std::string& type) {
    const Scene scene = scene_of({type}, "[]", "");
    const auto sensor = make_sensor(scene.sensors.front(), 0, 0);
    return std::ranges::any_of(sensor->layout().elements,
                               [](const Element& element) { return element.c_normal > 0.0 || element.c_tangential > 0.0; });
  });
  return types;
}

void expect_each_as_alone(std::vector<std::string> types, const std::string& effects) {
  std::vector<TrialRecord> alone;
  for (const std::string& type : types) alone.push_back(run({type}, effects, type));
  const auto compare = [&](const std::vector<std::string>& order, const std::string& read) {
    const TrialRecord together = run(order, effects, read);
    for (std::size_t i = 0; i < types.size(); ++i) {
      const auto found = std::ranges::find(together.sensors, types[i], &SensorRecord::name);
      if (found == together.sensors.end()) continue;
      expect_same_sensor(*found, alone[i].sensors.front());
      if (types[i] == read) expect_same_control(*together.control, *alone[i].control);
    }
  };
  for (const std::string& read : types) compare(types, read);
  std::vector<std::string> other = types;
  std::ranges::reverse(other);
  compare(other, types.front());
  for (std::size_t i = 0; i + 1 < types.size(); ++i) compare({types[i + 1], types[i]}, types[i]);
}

TEST(SeveralSensors, LeaveEveryByteOfEachOther) {
  ASSERT_GE(all_types().size(), 3U);
  expect_each_as_alone(all_types(), "[patchy_friction, texture, ageing]");
}

TEST(SeveralSensors, LeaveEveryByteOfEachOtherWhereTipsHaveMass) {
  const std::vector<std::string> types = types_without_dashpots();
  ASSERT_GE(types.size(), 2U);
  expect_each_as_alone(types, "[patchy_friction, texture, {inertia: {scatter: 0.2}}]");
}

// The comparisons are meaningful only with effects, noise and slip.
TEST(SeveralSensors, AreComparedOnSomethingThatIsDrawn) {
  for (const std::string& type : all_types()) {
    const SensorRecord one = run({type}, "[patchy_friction]", type).sensors.front();
    EXPECT_GT(one.labels.state_count[3] + one.labels.state_count[2], 0U) << type << " never slips";
    EXPECT_FALSE(one.labels.event_time.empty()) << type;
  }
}

// Rates that do not divide each other, 2,400, 1,000 and 700 Hz: j/2400 and k/1000 coincide every 5
// ms, k/1000 and l/700 every 10 ms, so 140 and 70 times in 0.7 s.
TEST(SeveralSensors, HaveTheirCommonTimesToTheBit) {
  const Scene scene = parsed(
      "slipbench: 1\nduration: 0.7 s\nmotion: {compression: 0.3 mm, start: 0.6 s}\nsensors:\n"
      "  fast: {type: piezo_skin, rate: 2.4 kHz}\n  middle: {type: piezo_skin, rate: 1 kHz}\n"
      "  slow: {type: piezo_skin, rate: 700 Hz}\n");
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  const auto common = [&](std::size_t a, std::size_t b) {
    std::vector<double> both;
    std::ranges::set_intersection(record.sensors[a].time, record.sensors[b].time, std::back_inserter(both));
    return both.size();
  };
  EXPECT_EQ(common(0, 1), 140U);
  EXPECT_EQ(common(1, 2), 70U);
}

// t of every sensor: multiples of its sampling time, within the rounding of k dt (half a unit in
// the last place of dt and of the product).
TEST(SeveralSensors, HaveTimesThatAreMultiplesOfTheirOwnSamplingTime) {
  const TrialRecord record = run(all_types(), "[]", "");
  for (const SensorRecord& sensor : record.sensors) {
    ASSERT_GT(sensor.time.size(), 10U);
    for (const double time : sensor.time) {
      const double samples = (time - sensor.time.front()) * sensor.rate;
      EXPECT_NEAR(samples, std::round(samples), 1e-9) << sensor.name << " at " << time << " s";
    }
  }
  const auto rows = std::ranges::max_element(record.sensors, {}, [](const SensorRecord& s) { return s.rate; })->time.size();
  EXPECT_EQ(record.body_time.size(), rows) << "bodies are recorded with the fastest sensor";
}

}  // namespace
}  // namespace slipbench

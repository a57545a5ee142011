// Sensors that follow the pad of a grasp or a body: the rest of the dataset is byte-identical
// without them.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenes.h"
#include "tests/tools/trial/same_record.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/run_trial.h"

namespace slipbench::testing_run {
namespace {

TrialRecord run(const std::string& file, const std::string& detector, const std::vector<Override>& changes) {
  SceneFile scene = shipped(file, changes);
  if (!detector.empty()) scene.apply({"detector", detector});
  return run_trial(parsed(scene), 0, Recording::full).record;
}

// A follower of every kind, each named after its type.
std::vector<Override> followers_of(const std::string& pad) {
  std::vector<Override> all;
  for (const Entry& entry : pad_catalogues().sensors) {
    if (entry.name == "plugin") continue;  // not a kind without a library
    all.push_back({"sensors.f_" + entry.name, "{type: " + entry.name + ", electronics: typical, follows: " + pad + "}"});
  }
  return all;
}

void expect_same_bodies(const TrialRecord& one, const TrialRecord& other) {
  EXPECT_TRUE(same_bytes(one.body_time, other.body_time));
  ASSERT_EQ(one.bodies.size(), other.bodies.size());
  for (std::size_t b = 0; b < one.bodies.size(); ++b) {
    EXPECT_EQ(one.bodies[b].name, other.bodies[b].name);
    EXPECT_TRUE(same_bytes(one.bodies[b].pose, other.bodies[b].pose)) << one.bodies[b].name;
    EXPECT_TRUE(same_bytes(one.bodies[b].velocity, other.bodies[b].velocity)) << one.bodies[b].name;
  }
}

// `pads`: number of sensors without the followers.
void expect_same_without(const TrialRecord& with, const TrialRecord& without, std::size_t pads) {
  ASSERT_EQ(without.sensors.size(), pads);
  for (std::size_t i = 0; i < pads; ++i) expect_same_sensor(with.sensors[i], without.sensors[i]);
  expect_same_bodies(with, without);
  TrialOutcome outcome = with.outcome;
  for (std::size_t i = pads; i < with.sensors.size(); ++i) outcome.saturated.erase(with.sensors[i].name);
  EXPECT_EQ(outcome_json(outcome), outcome_json(without.outcome));
  ASSERT_EQ(with.control.has_value(), without.control.has_value());
  if (with.control) expect_same_control(*with.control, *without.control);
}

// Expects the sensors of `with` that also occur in a scene with one of them alone to be equal.
void expect_each_as_alone(const TrialRecord& with, const std::string& file, const std::string& detector,
                          const std::vector<Override>& changes, const std::vector<Override>& followers, std::size_t pads) {
  for (std::size_t i = 0; i < followers.size(); ++i) {
    std::vector<Override> one = changes;
    one.push_back(followers[i]);
    const TrialRecord alone = run(file, detector, one);
    expect_same_sensor(with.sensors[pads + i], alone.sensors[pads]);
    EXPECT_GT(with.sensors[pads + i].labels.event_time.size(), 0U) << "what touches nothing shows nothing";
  }
}

const std::vector<Override> short_lift{
    {"duration", "2.4 s"}, {"motion.distance", "30 mm"}, {"friction", "{static: 0.3, kinetic: 0.3}"}};

TEST(Followers, LeaveEveryByteOfALift) {
  const std::string stepping = "{type: force_ratio, ratio: 0.25, sensor: pad}";
  const TrialRecord without = run("grasp/lift.yaml", stepping, short_lift);
  std::vector<Override> changes = short_lift;
  const std::vector<Override> followers = followers_of("pad");
  changes.insert(changes.end(), followers.begin(), followers.end());
  changes.push_back({"sensors.other", "{type: piezo_skin, electronics: typical, follows: second_pad}"});
  const TrialRecord with = run("grasp/lift.yaml", stepping, changes);
  ASSERT_EQ(with.sensors.size(), followers.size() + 2);
  expect_same_without(with, without, 1);
  EXPECT_FALSE(std::isnan(with.outcome.first_slip_time)) << "nothing slips: this would test little";
  expect_each_as_alone(with, "grasp/lift.yaml", stepping, short_lift, followers, 1);
}

TEST(Followers, LeaveEveryByteOfTwoFingersThatHoldABox) {
  const std::vector<Override> effects{{"effects", "[patchy_friction, stribeck]"}};
  const TrialRecord without = run("bodies/held_box.yaml", "", effects);
  std::vector<Override> changes = effects;
  const std::vector<Override> followers = followers_of("right");
  changes.insert(changes.end(), followers.begin(), followers.end());
  const TrialRecord with = run("bodies/held_box.yaml", "", changes);
  expect_same_without(with, without, 2);
  expect_each_as_alone(with, "bodies/held_box.yaml", "", effects, followers, 2);
}

// A spring longer by h is pressed by h more: k h of force. The box leans by less than 0.03, and 1 -
// cos(0.03) is 4.5e-4.
TEST(Followers, StandAheadOfThePad) {
  constexpr double h = 0.2e-3;
  const std::vector<Override> changes{{"duration", "2.4 s"},
                                      {"motion.distance", "30 mm"},
                                      {"friction", "{static: 0.9, kinetic: 0.9}"},
                                      {"sensors.even", "{type: papillarray, follows: pad}"},
                                      {"sensors.proud", "{type: papillarray, follows: pad, ahead: 0.2 mm}"}};
  const TrialRecord record = run("grasp/lift.yaml", "{type: truth, sensor: pad}", changes);
  const LabelRecord &even = record.sensors[1].labels, &proud = record.sensors[2].labels;
  ASSERT_EQ(even.force.size(), proud.force.size());
  const std::size_t units = even.k_normal.size();
  for (std::size_t u = 0; u < units; ++u) EXPECT_DOUBLE_EQ(proud.unit_heights[u], even.unit_heights[u] - h);
  std::size_t pressed = 0;
  for (std::size_t i = 2; i < even.force.size(); i += 3) {
    if (even.force[i] <= 0.0) continue;
    ++pressed;
    const double more = even.k_normal[i / 3 % units] * h;
    EXPECT_NEAR(proud.force[i] - even.force[i], more, 4.5e-4 * more) << i;
  }
  EXPECT_GT(pressed, even.force.size() / 9);
}

// A detector may read a follower, and the controller uses it; its rows are the follower's samples,
// and at the gripper's ticks the loop sees the latest one.
TEST(Followers, MayBeWhatTheDetectorReads) {
  std::vector<Override> changes = short_lift;
  changes.push_back({"sensors.skin", "{type: piezo_skin, follows: pad}"});
  const TrialRecord record = run("grasp/lift.yaml", "{type: truth, sensor: skin}", changes);
  const SensorRecord& skin = record.sensors.back();
  const ControlRecord& control = record.control.value();
  EXPECT_EQ(control.sensor, "skin");
  EXPECT_EQ(control.rate, skin.rate);
  EXPECT_TRUE(same_bytes(control.time, skin.time));
  EXPECT_EQ(control.grip.command.size(), 3 * skin.time.size());
  EXPECT_EQ(control.grip.grip_force.size(), skin.time.size());
  EXPECT_FALSE(std::isnan(record.outcome.detection_time));
  // The oracle reports the sample's state; a loop that runs once per step of the bench (under 1 ms)
  // sees it at the next tick at the latest.
  std::size_t late = 0;
  for (std::size_t row = 10; row < skin.time.size(); ++row) {
    const auto seen = control.detector_class[row];
    const auto first = skin.labels.state.begin() + static_cast<std::ptrdiff_t>(row) - 10;
    late += std::find(first, first + 11, seen) == first + 11 ? 1 : 0;
  }
  EXPECT_EQ(late, 0U);
}

}  // namespace
}  // namespace slipbench::testing_run

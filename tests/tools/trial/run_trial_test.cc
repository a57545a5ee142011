#include "tools/trial/run_trial.h"

#include <tuple>
#include <utility>

#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/trial_run.h"

namespace slipbench {
namespace {

TrialRecord record_of(const Scene& scene) { return run_trial(scene, 0, Recording::full).record; }

TEST(RunTrial, IdealSensorReportsTheTruth) {
  const TrialRecord record = record_of(stage_scene({}));
  ASSERT_EQ(record.sensors.size(), 1U);
  const SensorRecord& sensor = record.sensors[0];
  EXPECT_EQ(sensor.name, "pad");
  EXPECT_EQ(sensor.type, "papillarray");
  EXPECT_EQ(sensor.rate, 1000.0);
  ASSERT_EQ(sensor.time.size(), 4000U);  // 4 s at 1 kHz
  EXPECT_EQ(sensor.time[0], 0.0);
  EXPECT_DOUBLE_EQ(sensor.time[3999], 3.999);
  ASSERT_EQ(sensor.channels[0].name, "force");
  EXPECT_EQ(sensor.channels[0].values, sensor.labels.force);
  EXPECT_EQ(sensor.channel_names.size(), 54U);
}

TEST(RunTrial, OutcomeDoesNotDependOnTheRecording) {
  const Scene scene = stage_scene({});
  const TrialResult whole = run_trial(scene, 0, Recording::full);
  const TrialRecord& full = whole.record;
  const TrialResult short_one = run_trial(scene, 0, Recording::outcome);
  const TrialRecord& brief = short_one.record;
  EXPECT_EQ(outcome_json(full.outcome), outcome_json(brief.outcome));
  EXPECT_EQ(full.sensors[0].labels.onset_time, brief.sensors[0].labels.onset_time);
  EXPECT_EQ(full.sensors[0].labels.state_count, brief.sensors[0].labels.state_count);
  EXPECT_TRUE(brief.sensors[0].labels.force.empty());
  EXPECT_TRUE(brief.sensors[0].channels.empty());
  ASSERT_EQ(short_one.units.size(), 1U);
  ASSERT_EQ(short_one.units[0].size(), 9U);
  const LabelRecord& labels = full.sensors[0].labels;
  const std::size_t last = labels.slip_distance.size() - 9;  // the last tick is the last sample: both have 1 kHz
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    const UnitOutcome& unit = short_one.units[0][pillar];
    EXPECT_EQ(unit.touch_time, whole.units[0][pillar].touch_time);
    EXPECT_EQ(unit.onset_time, labels.onset_time[pillar]);
    EXPECT_EQ(unit.micro_onset_time, labels.micro_onset_time[pillar]);
    EXPECT_EQ(unit.slip_distance, labels.slip_distance[last + pillar]);
    EXPECT_EQ(unit.load, labels.force[3 * (last + pillar) + 2]);
    EXPECT_EQ(unit.margin, labels.margin[last + pillar]);
  }
}

// The centre pillar is pressed by 1 mm at the default 4 mm/s: it touches when the gap is used up,
// before the compression is reached.
TEST(RunTrial, EachUnitHasItsTouch) {
  const TrialResult result = run_trial(stage_scene({}), 0, Recording::outcome);
  double earliest = std::numeric_limits<double>::infinity();
  for (const UnitOutcome& unit : result.units[0]) earliest = std::min(earliest, unit.touch_time);
  EXPECT_EQ(earliest, result.record.outcome.touch_time);
  EXPECT_EQ(earliest, result.units[0][4].touch_time);  // the centre pillar is the tallest
  EXPECT_GT(result.units[0][0].touch_time, earliest);
}

// 1e300 m/s, which the parser would refuse, for two seconds gives a position that is finite as a
// double, but not as a dataset's float.
TEST(RunTrial, WhatIsNotFiniteIsRefused) {
  Scene scene = stage_scene({{"motion.acceleration", "inf"}});
  scene.motion.parameters.set("speed", 1e300);
  for (const Recording recording : {Recording::full, Recording::outcome}) {
    const std::string said = refusal_of([&] { run_trial(scene, 0, recording); });
    EXPECT_THAT(said, HasSubstr(" is not finite at "));
    EXPECT_THAT(said, HasSubstr(": the simulation has overflowed with the values of the scene"));
  }
}

// Onset of a pillar in a slide at speed v that starts at rest with acceleration a (closed form of
// PHYSICS, oracle 1, with the ramp): the shear mu*f_n/k_t is reached at t = start + d/v + v/(2a),
// after v is reached.
TEST(RunTrial, OnsetsFollowTheClosedForm) {
  const TrialRecord record =
      record_of(stage_scene({{"motion.speed", "4 mm/s"}, {"motion.acceleration", "1 m/s2"}, {"motion.compression", "1 mm"}}));
  const LabelRecord& labels = record.sensors[0].labels;
  double latest = 0.0;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    const double f_n = labels.k_normal[pillar] * (1e-3 - labels.unit_heights[pillar]);
    const double shear = labels.mu_static[pillar] * f_n / labels.k_tangential[pillar];
    const double onset = 2.0 + shear / 4e-3 + 4e-3 / (2.0 * 1.0);
    EXPECT_NEAR(labels.onset_time[pillar], onset, 1e-3 * (onset - 2.0)) << pillar;
    latest = std::max(latest, labels.onset_time[pillar]);
  }
  EXPECT_EQ(record.outcome.gross_slip_time, latest);
  EXPECT_EQ(record.outcome.first_slip_time, *std::min_element(labels.onset_time.begin(), labels.onset_time.end()));
  // With one bristle per pillar, micro-slip and full slip begin together.
  EXPECT_EQ(labels.micro_onset_time, labels.onset_time);
}

// Pressed at 10 mm/s without ramps, the centre pillar touches after 0.5 mm, at 50 ms. FZ of a
// pillar of 7.1 N/mm passes 15 N at 15/7.1 = 2.113 mm, before DZ passes 2.5 mm: at 261.3 ms; of an
// edge, which is 0.2 mm shorter, at 281.3 ms. A corner, 0.45 mm shorter, ends at 2.4 - 0.45 = 1.95
// mm.
TEST(RunTrial, APillarIsFlaggedFromTheMomentItsForceLeavesTheRange) {
  const std::vector<Override> pressed{
      {"motion", "{kind: stage, compression: 2.4 mm, gap: 0.5 mm, approach_speed: 10 mm/s, acceleration: inf, start: 0.4 s}"},
      {"duration", "0.4 s"},
      {"sensors.pad.electronics", "[valid_range]"}};
  std::vector<Override> flagged = pressed;
  flagged.push_back({"sensors.pad.range_flag", "true"});
  const TrialRecord plain = record_of(stage_scene(pressed)), record = record_of(stage_scene(flagged));
  const SensorRecord& sensor = record.sensors[0];
  ASSERT_EQ(sensor.channels.size(), 3U);
  EXPECT_EQ(sensor.channels[2].name, "out_of_range");
  const std::vector<float>& out = sensor.channels[2].values;
  ASSERT_EQ(out.size(), 400U * 9U);
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    const std::size_t from = pillar == 4 ? 262 : pillar % 2 == 1 ? 282 : 400;  // samples are 1 ms apart
    for (std::size_t row = 0; row < 400; ++row)
      ASSERT_EQ(out[9 * row + pillar], row < from ? 0.0F : 1.0F) << "P" << pillar << " at " << row << " ms";
  }
  // Without the flag the same is recorded but for its channel.
  ASSERT_EQ(plain.sensors[0].channels.size(), 2U);
  for (std::size_t channel = 0; channel < 2; ++channel)
    EXPECT_EQ(plain.sensors[0].channels[channel].values, sensor.channels[channel].values);
  EXPECT_EQ(outcome_json(plain.outcome), outcome_json(record.outcome));
}

TEST(RunTrial, SlowSensorsSampleEveryNthTick) {
  const TrialRecord fast = record_of(stage_scene({}));
  const TrialRecord slow = record_of(stage_scene({{"sensors.pad.rate", "250 Hz"}, {"time_step", "1 ms"}}));
  const SensorRecord& sensor = slow.sensors[0];
  ASSERT_EQ(sensor.time.size(), 1000U);
  EXPECT_EQ(slow.num_samples(), 1000U);
  for (std::size_t row = 0; row < sensor.time.size(); ++row) {
    EXPECT_EQ(sensor.time[row], fast.sensors[0].time[4 * row]);
    EXPECT_EQ(sensor.labels.force[27 * row + 14], fast.sensors[0].labels.force[4 * 27 * row + 14]);
    EXPECT_EQ(slow.body_time[row], fast.body_time[4 * row]);
  }
  // Events come from every tick.
  EXPECT_EQ(sensor.labels.event_time, fast.sensors[0].labels.event_time);
}

TEST(RunTrial, BodiesMoveAsTheSceneSays) {
  const TrialRecord record = record_of(stage_scene({{"motion.direction", "0 deg"}}));
  ASSERT_EQ(record.bodies.size(), 2U);
  const BodyRecord& pad = record.bodies[0];
  EXPECT_EQ(pad.name, "pad");
  EXPECT_EQ(record.bodies[1].name, "surface");
  // 0.5 s before the end the pad slides along x at 4 mm/s.
  const float* velocity = pad.velocity.data() + 6 * 3500;
  EXPECT_FLOAT_EQ(velocity[0], 4e-3F);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_EQ(velocity[i], 0.0F);
  for (std::size_t row = 0; row < record.num_samples(); ++row) {
    const float* q = pad.pose.data() + 7 * row + 3;
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1.0F, 1e-6F);
  }
}

// In more than half a turn the quaternion leaves its initial half-space: its sign must not jump
// there.
TEST(RunTrial, QuaternionsAreContinuous) {
  const TrialRecord record =
      record_of(stage_scene({{"motion.rotation", "360 deg/s"}, {"motion.angular_acceleration", "3600 deg/s2"}}));
  const BodyRecord& pad = record.bodies[0];
  float least = 1.0F;
  for (std::size_t row = 1; row < record.num_samples(); ++row) {
    const float* q = pad.pose.data() + 7 * row + 3;
    least = std::min(least, q[0] * q[-7] + q[1] * q[-6] + q[2] * q[-5] + q[3] * q[-4]);
  }
  // 0.36 degrees a sample: the dot product of neighbours is cos(0.18 deg) = 1 - 5e-6.
  EXPECT_GT(least, 0.9999F);
}

// The least loaded of six bristles carries w = 1e-60 of the mean load, which 2 - (2 - w) rounds to 0.
TEST(RunTrial, ElementWithoutASpringIsRefused) {
  const Scene scene = parsed("slipbench: 1\nsensors: {pad: {type: papillarray, bristles: 6, bristle_spread: 1e-60}}\n");
  EXPECT_THAT(scene_refusal_of([&] { static_cast<void>(check_trial(scene, 0)); }),
              refused_at("sensors.pad", {"stiffness", "0 N/m"}));
}

TEST(RunTrial, HopOfMoreThanAMillionSamplesIsRefused) {
  const Scene scene = parsed("slipbench: 1\nsensors: {pad: {type: nib_pad}}\ndetector: {type: nib_slip_kind, hop: 1e30}\n");
  EXPECT_THAT(scene_refusal_of([&] { static_cast<void>(check_trial(scene, 0)); }), refused_at("detector.hop", {"1,000,000"}));
}

TEST(RunTrial, RecordThatWouldFillTheMemoryIsRefused) {
  // A day at 1 kHz is 8.64e7 rows; with a frame of 9 x 2 x 3 floats alone that is 18.7 GB.
  Scene scene = stage_scene({});
  scene.duration = 86400.0;
  EXPECT_THAT(scene_refusal_of([&] { run_trial(scene, 0, Recording::full); }), refused_at("duration", {"4 GB"}));
}

// A sample is a time, 54 values, 9 units of 1 + 8 + 4 + 4 + 12 bytes, 3 states and five numbers of
// 4 bytes (the centre has two, plus stuck fraction, direction and angle); a row of the bodies is a
// time and two times 13 floats.
TEST(RunTrial, RecordCountsSensorsAndBodies) {
  const double sample = 8 + 4 * 54 + 9 * 29 + 3 + 4 * 5;
  const double bodies = 8 + 2 * 4 * 13;
  EXPECT_EQ(check_trial(stage_scene({}), 0), 4000 * (sample + bodies));
  EXPECT_EQ(check_trial(stage_scene({{"sensors.second", "{type: papillarray, rate: 500 Hz}"}}), 0),
            4000 * (sample + bodies) + 2000 * sample);
}

// An event has 8 + 4 + 1 bytes.
TEST(RunTrial, EventsCountToo) {
  const Scene scene = stage_scene({});
  const std::size_t events = record_of(scene).sensors[0].labels.event_time.size();
  EXPECT_GE(events, 18U) << "a touch and a slip of each pillar";
  const double size = check_trial(scene, 0) + 13.0 * static_cast<double>(events);
  EXPECT_NO_THROW(run_trial(scene, 0, Recording::full, size));
  EXPECT_THROW(run_trial(scene, 0, Recording::full, size - 1.0), SceneValueError);
  EXPECT_NO_THROW(run_trial(scene, 0, Recording::outcome, 0.0));
}

TEST(RunTrial, SeveralSensorsAreRecordedSideBySide) {
  const TrialRecord record = record_of(stage_scene({{"sensors.second", "{type: papillarray, rate: 500 Hz}"}}));
  ASSERT_EQ(record.sensors.size(), 2U);
  EXPECT_EQ(record.sensors[1].name, "second");
  EXPECT_EQ(record.sensors[0].time.size(), 4000U);
  EXPECT_EQ(record.sensors[1].time.size(), 2000U);
  EXPECT_EQ(record.num_samples(), 4000U);  // of the fastest sensor
}

TEST(MakeSensor, RefusesAnUnknownType) {
  SensorScene scene;
  scene.name = "pad";
  scene.type = "nose";
  EXPECT_THROW(make_sensor(scene, 0, 0), InputError);
}

TEST(ProgramCatalogues, NameEverythingOnce) {
  const Catalogues& catalogues = slipbench::catalogues();
  EXPECT_FALSE(catalogues.materials.empty());
  for (const auto* entries : {&catalogues.surfaces, &catalogues.motions, &catalogues.sensors,
                              &catalogues.electronics.at("papillarray"), &catalogues.effects}) {
    std::vector<std::string> names;
    for (const Entry& entry : *entries) names.push_back(entry.name);
    ASSERT_FALSE(names.empty());
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  }
}

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float undefined = std::numeric_limits<float>::quiet_NaN();

template <class... Arguments>
std::string answer(const Arguments&... arguments) {
  return refusal_of([&] { check_finite(arguments...); });
}

std::string refusal(const std::string& what, const std::string& when) {
  return what + " is not finite at " + when + ": the simulation has overflowed with the values of the scene";
}

// Two units over three samples, of which the second never touches; one body.
TrialRecord record() {
  TrialRecord record;
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.time = {0.0, 0.25, 0.5};
  sensor.channels = {{"force", "N", {2, 3}, std::vector<float>(18, 1.0F)}};
  LabelRecord& labels = sensor.labels;
  labels.k_normal = {1.0, 1.0};
  labels.unit_state = {1, 0, 1, 0, 2, 0};
  labels.margin = {0.5F, undefined, 0.25F, undefined, 0.0F, undefined};
  labels.force.assign(18, 1.0F);
  labels.slip_velocity.assign(12, 0.0F);
  labels.slip_distance.assign(6, 0.0F);
  labels.slip_direction = {undefined, undefined, 1.0F};
  record.sensors = {sensor};
  record.body_time = sensor.time;
  record.bodies = {{"pad", std::vector<float>(21, 0.0F), std::vector<float>(18, 0.0F)}};
  return record;
}

TEST(Finite, UndefinedIsAllowedWhereNothingTouchesOrSlips) { EXPECT_EQ(answer(record()), "accepted"); }

TEST(Finite, EveryColumnIsWatched) {
  // Index 7 of 18 values in three rows is in row 1; 3 of 6 and 8 of 21 as well; 10 of 12 in row 2.
  const std::vector<std::tuple<std::function<void(TrialRecord&)>, std::string, std::string>> cases = {
      {[](TrialRecord& bad) { bad.sensors[0].channels[0].values[7] = infinite; }, "sensors.pad: force", "0.25 s"},
      {[](TrialRecord& bad) { bad.sensors[0].labels.force[7] = undefined; }, "sensors.pad: contact force", "0.25 s"},
      {[](TrialRecord& bad) { bad.sensors[0].labels.slip_velocity[10] = -infinite; }, "sensors.pad: slip velocity", "0.5 s"},
      {[](TrialRecord& bad) { bad.sensors[0].labels.slip_distance[3] = infinite; }, "sensors.pad: slip distance", "0.25 s"},
      // Margin of the unit in contact.
      {[](TrialRecord& bad) { bad.sensors[0].labels.margin[4] = undefined; }, "sensors.pad: margin", "0.5 s"},
      {[](TrialRecord& bad) { bad.bodies[0].pose[8] = infinite; }, "pose of the body pad", "0.25 s"},
      {[](TrialRecord& bad) { bad.bodies[0].velocity[7] = infinite; }, "velocity of the body pad", "0.25 s"},
  };
  for (const auto& [change, what, when] : cases) {
    TrialRecord bad = record();
    change(bad);
    EXPECT_EQ(answer(bad), refusal(what, when));
  }
}

TEST(Finite, TheEarliestIsNamed) {
  TrialRecord bad = record();
  bad.sensors[0].channels[0].values[17] = infinite;
  bad.bodies[0].pose[0] = infinite;
  bad.bodies[0].velocity[7] = infinite;
  EXPECT_EQ(answer(bad), refusal("pose of the body pad", "0 s"));
}

ContactFrame frame() {
  ContactFrame frame;
  frame.time = 0.5;
  frame.force.setZero(3, 2);
  frame.contact_force.setZero(3, 2);
  frame.displacement.setZero(3, 2);
  frame.slip_velocity.setZero(2, 2);
  frame.slip_distance.setZero(2);
  frame.margin.setConstant(2, std::numeric_limits<double>::quiet_NaN());
  frame.margin(0) = 0.5;
  frame.unit_state = {UnitState::stick, UnitState::detached};
  return frame;
}

TEST(Finite, AFrameIsWatchedAsTheDatasetWouldHoldIt) {
  const std::string pad = "pad";
  EXPECT_EQ(answer(pad, frame()), "accepted");
  const std::vector<std::pair<std::function<void(ContactFrame&)>, std::string>> cases = {
      {[](ContactFrame& bad) { bad.force(2, 1) = 1e39; }, "force"},  // a float ends at 3.4e38
      {[](ContactFrame& bad) { bad.contact_force(0, 0) = -1e39; }, "contact force"},
      {[](ContactFrame& bad) { bad.displacement(0, 0) = 1e39; }, "displacement"},
      {[](ContactFrame& bad) { bad.slip_velocity(1, 0) = 1e39; }, "slip velocity"},
      {[](ContactFrame& bad) { bad.slip_distance(1) = 1e39; }, "slip distance"},
      {[](ContactFrame& bad) { bad.unit_state[1] = UnitState::slip; }, "margin"},  // in contact without a margin
  };
  for (const auto& [change, what] : cases) {
    ContactFrame bad = frame();
    change(bad);
    EXPECT_EQ(answer(pad, bad), refusal("sensors.pad: " + what, "0.5 s"));
  }
}

TEST(Finite, ASampleIsWatched) {
  const std::vector<Channel> channels{{"force", "N", {2}, {}}, {"displacement", "m", {1}, {}}};
  std::vector<float> values{1.0F, 2.0F, 3.0F};
  EXPECT_EQ(answer(std::string("pad"), channels, SensorFrame{0.5, values}), "accepted");
  values[2] = infinite;
  EXPECT_EQ(answer(std::string("pad"), channels, SensorFrame{0.5, values}), refusal("sensors.pad: displacement", "0.5 s"));
  values[1] = undefined;
  EXPECT_EQ(answer(std::string("pad"), channels, SensorFrame{0.5, values}), refusal("sensors.pad: force", "0.5 s"));
}

TEST(Finite, BodiesAreWatched) {
  std::vector<NamedBody> bodies{{"pad", {}}};
  bodies[0].state.pose.position.setZero();
  bodies[0].state.pose.rotation.setIdentity();
  bodies[0].state.velocity.setZero();
  bodies[0].state.angular_velocity.setZero();
  EXPECT_EQ(answer(0.5, bodies), "accepted");
  bodies[0].state.pose.position.x() = 1e39;
  EXPECT_EQ(answer(0.5, bodies), refusal("pose of the body pad", "0.5 s"));
  bodies[0].state.pose.position.setZero();
  bodies[0].state.angular_velocity.z() = 1e39;
  EXPECT_EQ(answer(0.5, bodies), refusal("velocity of the body pad", "0.5 s"));
}

}  // namespace
}  // namespace slipbench

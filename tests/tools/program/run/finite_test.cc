#include "tools/program/run/trial_run.h"

#include <tuple>
#include <utility>

#include "tests/expect.h"

namespace slipbench {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float undefined = std::numeric_limits<float>::quiet_NaN();

template <class... Arguments>
std::string answer(const Arguments&... arguments) {
  return refusal_of([&] { check_finite(arguments...); });
}

std::string refusal(const std::string& what, const std::string& when) {
  return what + " is not finite at " + when + ": the scene's values are beyond what the bench can compute";
}

// Two units over three samples, the second unit never touches; one body.
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
  // Index 7 of 18 values in three rows stands in row 1; 3 of 6 and 8 of 21 likewise; 10 of 12 in row 2.
  const std::vector<std::tuple<std::function<void(TrialRecord&)>, std::string, std::string>> cases = {
      {[](TrialRecord& bad) { bad.sensors[0].channels[0].values[7] = infinite; }, "sensors.pad: force", "0.25 s"},
      {[](TrialRecord& bad) { bad.sensors[0].labels.force[7] = undefined; }, "sensors.pad: contact force", "0.25 s"},
      {[](TrialRecord& bad) { bad.sensors[0].labels.slip_velocity[10] = -infinite; }, "sensors.pad: slip velocity", "0.5 s"},
      {[](TrialRecord& bad) { bad.sensors[0].labels.slip_distance[3] = infinite; }, "sensors.pad: slip distance", "0.25 s"},
      // Of the unit that touches.
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
      {[](ContactFrame& bad) { bad.unit_state[1] = UnitState::slip; }, "margin"},  // touches, without a margin
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

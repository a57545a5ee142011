#include "tools/program/report/report_parts.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/expect.h"
#include "tests/tools/program/report/sample.h"

namespace slipbench::report {
namespace {

constexpr std::size_t everything = 1'000'000;

std::vector<std::vector<double>> curve(const Json& payload, const std::string& key) {
  return unpack(payload.at("curves").at(key).at("data"));
}

// From row 3 on the arm rises by 2 mm a row, the box by 1 mm, and the box turns about the vertical by 0.01 rad a row (sample.h).
TEST(GraspPayload, SlipIsInTheArmsFrameFromTheLiftOn) {
  const Json payload = grasp_payload(sample_grasp(0), everything, "demo_0");
  EXPECT_DOUBLE_EQ(payload.at("lift_s").get<double>(), 3e-3);
  const auto height = curve(payload, "height"), slip = curve(payload, "slip"), rotation = curve(payload, "rotation");
  for (std::size_t row = 0; row < 8; ++row) {
    const double since = row < 3 ? 0.0 : static_cast<double>(row) - 3.0;
    // Half a step of 16 bits of each range, and the float of a pose of some 0.1 m.
    EXPECT_NEAR(height[0][row], 1e-3 * since, 0.5 * 10e-3 / 32767 + 1e-8) << row;
    EXPECT_NEAR(height[1][row], 2e-3 * since, 0.5 * 10e-3 / 32767 + 1e-8) << row;
    EXPECT_NEAR(slip[0][row], 1e-3 * since, 0.5 * 5e-3 / 32767 + 1e-8) << row;
    EXPECT_NEAR(rotation[0][row], 0.01 * since, 0.5 * 0.05 / 32767 + 1e-6) << row;
  }
}

// An arm that stands turned by 90 degrees sees the box go as far, along another of its axes.
TEST(GraspPayload, SlipDoesNotDependOnHowTheArmStands) {
  TrialRecord record = sample_grasp(0);
  const auto half = static_cast<float>(std::numbers::sqrt2 / 2.0);
  for (std::size_t row = 0; row < 8; ++row) {
    float* const turn = &record.bodies[1].pose[7 * row + 3];
    turn[0] = half, turn[1] = 0.0F, turn[2] = half, turn[3] = 0.0F;
  }
  EXPECT_NEAR(curve(grasp_payload(record, everything, "demo_0"), "slip")[0][7], 4e-3, 0.5 * 4e-3 / 32767 + 1e-8);
}

TEST(GraspPayload, NoSlipOnceDropped) {
  TrialRecord record = sample_grasp(0);
  record.outcome.grasp->dropped = true;
  record.outcome.grasp->drop_time = 5.5e-3;
  const Json payload = grasp_payload(record, everything, "demo_0");
  for (const char* key : {"slip", "rotation"}) {
    const auto column = curve(payload, key)[0];
    EXPECT_FALSE(std::isnan(column[5])) << key;
    EXPECT_TRUE(std::isnan(column[6])) << key;
    EXPECT_TRUE(std::isnan(column[7])) << key;
  }
  EXPECT_FALSE(std::isnan(curve(payload, "height")[0][7]));
}

TEST(GraspPayload, HoldsForceAndRegisters) {
  const Json payload = grasp_payload(sample_grasp(0), everything, "demo_0");
  const auto force = curve(payload, "grip_force")[0];
  for (std::size_t row = 0; row < 8; ++row) EXPECT_NEAR(force[row], 0.5 * static_cast<double>(row), 0.5 * 3.5 / 32767 + 1e-12);
  const auto position = curve(payload, "position");
  // Counts of up to 78: to half of 78/32767.
  EXPECT_NEAR(position[0][7], 78.0, 0.5 * 78.0 / 32767);
  EXPECT_NEAR(position[1][7], 77.0, 0.5 * 78.0 / 32767);
  EXPECT_EQ(payload.at("controller"), "step_on_slip");
  EXPECT_EQ(payload.at("detector"), "truth");
}

// Without a detector and a controller nothing reads the gripper.
TEST(GraspPayload, OpenLoopHasPosesAlone) {
  TrialRecord record = sample_grasp(0);
  record.control.reset();
  const Json payload = grasp_payload(record, everything, "demo_0");
  EXPECT_FALSE(payload.at("curves").contains("grip_force"));
  EXPECT_FALSE(payload.at("curves").contains("position"));
  EXPECT_TRUE(payload.at("curves").contains("slip"));
  EXPECT_EQ(payload.at("controller"), "");
}

// 1 kHz: one pose in 17 is 58.8 a second. 8 rows then leave row 0 alone.
TEST(GraspPayload, PosesAreAtMostSixtyASecond) {
  const Json poses = grasp_payload(sample_grasp(0), everything, "demo_0").at("poses");
  EXPECT_EQ(poses.at("stride"), 17);
  ASSERT_EQ(poses.at("bodies").size(), 3U);
  const Json& box = poses.at("bodies").at(2);
  EXPECT_EQ(box.at("name"), "box");
  EXPECT_EQ(box.at("size"), Json::parse("[0.0625, 0.05, 0.1]"));
  EXPECT_TRUE(poses.at("bodies").at(1).at("size").is_null());
  EXPECT_EQ(box.at("position").at("rows"), 1);
  EXPECT_EQ(box.at("turn").at("columns"), 4);

  TrialRecord slow = sample_grasp(0);
  for (double& time : slow.body_time) time *= 20.0;  // 50 Hz
  const Json all = grasp_payload(slow, everything, "demo_0").at("poses");
  EXPECT_EQ(all.at("stride"), 1);
  const auto position = unpack(all.at("bodies").at(2).at("position"));
  EXPECT_NEAR(position[2][7], -0.02 + 4e-3, 0.5 * 0.02 / 32767 + 1e-8);
}

// 8 rows of box and arm height, slip, rotation, force, commanded and measured position are 56 values.
TEST(GraspPayload, CurvesAreThinnedToTheirLimit) {
  EXPECT_EQ(grasp_payload(sample_grasp(0), 56, "demo_0").at("stride"), 1);
  const Json thin = grasp_payload(sample_grasp(0), 28, "demo_0");
  EXPECT_EQ(thin.at("stride"), 2);
  EXPECT_EQ(thin.at("curves").at("slip").at("data").at("rows"), 4);
  EXPECT_EQ(thin.at("time").at("rows"), 8);
}

TEST(GraspPayload, RefusesARecordWithoutItsBodies) {
  TrialRecord record = sample_grasp(0);
  record.bodies.pop_back();
  EXPECT_EQ(refusal_of([&] { static_cast<void>(grasp_payload(record, everything, "lift.h5: /data/demo_0")); }),
            "lift.h5: /data/demo_0: a grasp without truth/box");
}

TEST(GraspSummary, NullStandsForNever) {
  const Json summary =
      grasp_summary({.slip_translation = 1e-3, .max_grip_force = 6.0, .final_grip_force = 5.0, .ideal_grip_force = 4.0});
  EXPECT_FALSE(summary.at("dropped").get<bool>());
  EXPECT_TRUE(summary.at("drop_s").is_null());
  EXPECT_TRUE(summary.at("rotation_rad").is_null());
  EXPECT_TRUE(summary.at("reaction_s").is_null());
  EXPECT_EQ(summary.at("slip_m"), 1e-3);
  EXPECT_EQ(summary.at("max_force_N"), 6.0);
  EXPECT_EQ(summary.at("final_force_N"), 5.0);
  EXPECT_EQ(summary.at("ideal_force_N"), 4.0);
}

}  // namespace
}  // namespace slipbench::report

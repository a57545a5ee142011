// What a record says became of a box that was to be turned up.
#include "tools/studies/nib_reconfigurable/nib_tables.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "sim/core/error.h"

namespace slipbench::reproduce::turn_loss_test {
namespace {

constexpr double target = 0.1;  // m
constexpr double degree = 0.017453292519943295;

// One row of a trial: what the arm is told, how high it is, the grip force, the box's tilt against the vertical.
struct Row {
  float sideways, up, height, force;
  double tilt;  // degrees
};

// A turn about X by b lifts the axis Y by b: its tilt against the vertical is 90 degrees less b.
TrialRecord record_of(const std::vector<Row>& rows, bool standing = false) {
  TrialRecord record;
  GraspOutcome& grasp = record.outcome.grasp.emplace();
  TurnOutcome turn{.tilt = rows.back().tilt * degree, .least_tilt = 90.0 * degree, .standing = standing};
  GripRecord& grip = record.control.emplace().grip;
  record.bodies = {{"arm", {}, {}}, {"box", {}, {}}};
  for (const Row& row : rows) {
    turn.least_tilt = std::min(turn.least_tilt, row.tilt * degree);
    record.body_time.push_back(0.02 * static_cast<double>(record.body_time.size()));
    grip.arm.insert(grip.arm.end(), {row.sideways, row.up});
    grip.grip_force.push_back(row.force);
    const double half = 0.5 * (90.0 - row.tilt) * degree;
    record.bodies[0].pose.insert(record.bodies[0].pose.end(), {0.0F, 0.0F, row.height, 1.0F, 0.0F, 0.0F, 0.0F});
    record.bodies[1].pose.insert(record.bodies[1].pose.end(), {0.0F, 0.0F, 0.0F, static_cast<float>(std::cos(half)),
                                                               static_cast<float>(std::sin(half)), 0.0F, 0.0F});
  }
  grasp.turn = turn;
  return record;
}

const Row before_touch{0, 0, 0, 0, 90}, rises{0, 0.01F, 0.05F, 4, 50};

TEST(TurnLoss, SaysHowATrialEnded) {
  const auto end_of = [](const std::vector<Row>& rows, bool standing = false) {
    return turn_of(record_of(rows, standing), target).end;
  };
  const Row told{0.01F, 0, 0.06F, 4, 30}, at_target{0.01F, 0, 0.1F, 4, 30}, up{0.01F, 0, 0.1F, 1, 10};
  const Row stands{0, 0, 0.1F, 0, 0}, lies{0, 0, 0.1F, 0, 90}, slipped{0, 0.01F, 0.06F, 0, 85}, leans{0, 0, 0.1F, 0.2F, 1};
  EXPECT_EQ(end_of({before_touch, rises, told, stands}, true), TurnEnd::standing);
  EXPECT_EQ(end_of({before_touch, rises, slipped, lies}), TurnEnd::lost);
  EXPECT_EQ(end_of({before_touch, rises, slipped, at_target, lies}), TurnEnd::lost);  // though the arm goes on
  EXPECT_EQ(end_of({before_touch, rises, told, lies}), TurnEnd::told_early);
  EXPECT_EQ(end_of({before_touch, rises, at_target, lies}), TurnEnd::not_turned);
  EXPECT_EQ(end_of({before_touch, rises, told, up, lies}), TurnEnd::fell);
  EXPECT_EQ(end_of({before_touch, rises, at_target, up, leans}), TurnEnd::not_let_go);
  EXPECT_EQ(end_of({before_touch, rises, rises}), TurnEnd::not_released);
}

TEST(TurnLoss, ReadsTiltAndForceWhereTheReleaseBegins) {
  const Turn turn = turn_of(record_of({before_touch, rises, {0.01F, 0, 0.1F, 3, 25}, {0.01F, 0, 0.1F, 1, 5}}, true), target);
  EXPECT_NEAR(turn.tilt, 25.0 * degree, 1e-6);  // of a quaternion of floats
  EXPECT_EQ(turn.force, 3.0);
  EXPECT_TRUE(std::isnan(turn_of(record_of({before_touch, rises}), target).tilt));
}

TEST(TurnLoss, RefusesARecordWithoutItsRows) {
  TrialRecord record = record_of({before_touch, rises});
  record.control->grip.arm.pop_back();
  EXPECT_THROW(turn_of(record, target), std::logic_error);
  record = record_of({before_touch, {0.01F, 0, 0.1F, 3, 25}});
  record.bodies.pop_back();
  EXPECT_THROW(turn_of(record, target), InputError);
}

}  // namespace
}  // namespace slipbench::reproduce::turn_loss_test

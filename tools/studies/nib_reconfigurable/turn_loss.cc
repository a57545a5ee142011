#include "tools/studies/nib_reconfigurable/turn_loss.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace slipbench::reproduce {
namespace {

constexpr std::size_t pose_size = 7;
constexpr double upright = 0.0872664625997164788;  // rad, 5 degrees, as TurnOutcome has it

const float* pose_of(const TrialRecord& record, std::string_view body, std::size_t row) {
  const auto found = std::ranges::find(record.bodies, body, &BodyRecord::name);
  if (found == record.bodies.end()) throw std::logic_error("turn_of: a body is missing");
  return found->pose.data() + pose_size * row;
}

// Between the body's axis Y and the vertical: of a rotation by (w, x, y, z) the entry of Y upwards is 2 (y z + w x).
double tilt_of(const float* pose) {
  const double w = pose[3], x = pose[4], y = pose[5], z = pose[6];
  return std::acos(std::min(1.0, std::abs(2.0 * (y * z + w * x))));
}

}  // namespace

Turn turn_of(const TrialRecord& record, double target) {
  const double never = std::numeric_limits<double>::quiet_NaN();
  const std::size_t rows = record.num_samples();
  if (!record.outcome.grasp || !record.outcome.grasp->turn || !record.control || rows == 0 ||
      record.control->grip.arm.size() != 2 * rows || record.control->grip.grip_force.size() != rows) {
    throw std::logic_error("turn_of: no full record of a guided grasp");
  }
  const TurnOutcome& outcome = *record.outcome.grasp->turn;
  const GripRecord& grip = record.control->grip;

  std::size_t released = 0;
  bool rising = false, lost = false;
  for (; released < rows && grip.arm[2 * released] == 0.0F; ++released) {
    rising = rising || grip.arm[2 * released + 1] > 0.0F;
    lost = lost || (rising && grip.grip_force[released] == 0.0F);
  }
  Turn turn{TurnEnd::standing, never, never};
  if (released < rows) {
    turn.tilt = tilt_of(pose_of(record, "box", released));
    turn.force = grip.grip_force[released];
  }
  if (outcome.standing) return turn;
  if (lost) {
    turn.end = TurnEnd::lost;
  } else if (released == rows) {
    turn.end = TurnEnd::not_released;
  } else if (outcome.tilt < upright) {
    turn.end = TurnEnd::not_let_go;
  } else if (outcome.least_tilt < turned_up) {
    turn.end = TurnEnd::fell;
  } else {
    const double rise = pose_of(record, "arm", released)[2] - pose_of(record, "arm", 0)[2];
    constexpr double lag = 1e-3;  // m, of the arm behind what it has been told, at 10 mm/s
    turn.end = rise < target - lag ? TurnEnd::told_early : TurnEnd::not_turned;
  }
  return turn;
}

}  // namespace slipbench::reproduce

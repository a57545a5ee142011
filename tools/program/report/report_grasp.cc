#include "tools/program/report/report_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/core/pose.h"
#include "tools/base/page/pack.h"

namespace slipbench::report {
namespace {

constexpr double frames_per_second = 60.0;  // more the eye does not see
constexpr std::size_t pose_values = 7;

struct GraspCurve {
  const char* key;
  const char* unit;
  std::vector<std::string> components;
  std::vector<float> values;  // [T, components]
};

const BodyRecord& body_named(const TrialRecord& record, const char* name, const std::string& place) {
  const auto found = std::ranges::find(record.bodies, name, &BodyRecord::name);
  if (found == record.bodies.end()) throw InputError(place + ": a grasp without truth/" + name);
  return *found;
}

Pose pose_at(const BodyRecord& body, std::size_t row) {
  const float* const p = &body.pose[pose_values * row];
  const Eigen::Quaterniond turn(p[3], p[4], p[5], p[6]);
  return {turn.normalized().toRotationMatrix(), {p[0], p[1], p[2]}};
}

// The last row before the arm first moves; the last of all where it never does.
std::size_t lift_row(const BodyRecord& arm, std::size_t rows) {
  for (std::size_t row = 0; row < rows; ++row) {
    const std::span<const float> velocity(&arm.velocity[6 * row], 6);
    if (std::ranges::any_of(velocity, [](float v) { return std::abs(v) > at_rest; })) return row == 0 ? 0 : row - 1;
  }
  return rows - 1;
}

std::vector<GraspCurve> curves_of(const TrialRecord& record, const BodyRecord& arm, const BodyRecord& box, std::size_t lift) {
  constexpr float never = std::numeric_limits<float>::quiet_NaN();
  const std::size_t rows = record.num_samples();
  GraspCurve height{"height", "m", {"box", "arm"}, {}}, slip{"slip", "m", {"slip"}, {}},
      rotation{"rotation", "rad", {"rotation"}, {}};
  const Pose taken = pose_at(arm, lift).inverse() * pose_at(box, lift);
  for (std::size_t row = 0; row < rows; ++row) {
    const Pose held = pose_at(arm, row).inverse() * pose_at(box, row);
    const bool dropped = record.body_time[row] >= record.outcome.grasp->drop_time;  // false where that is NaN
    const double angle = Eigen::AngleAxisd(Eigen::Matrix3d(held.rotation * taken.rotation.transpose())).angle();
    for (const BodyRecord* body : {&box, &arm}) height.values.push_back(body->pose[pose_values * row + 2] - body->pose[2]);
    slip.values.push_back(dropped ? never : row < lift ? 0.0F : static_cast<float>((held.position - taken.position).norm()));
    rotation.values.push_back(dropped ? never : row < lift ? 0.0F : static_cast<float>(angle));
  }
  std::vector<GraspCurve> curves{std::move(height), std::move(slip), std::move(rotation)};
  if (record.control) {
    const GripRecord& grip = record.control->grip;
    GraspCurve position{"position", "counts", {"commanded", "measured"}, {}};
    for (std::size_t row = 0; row < grip.measured_position.size(); ++row) {
      position.values.push_back(grip.command[3 * row]);
      position.values.push_back(grip.measured_position[row]);
    }
    curves.push_back({"grip_force", "N", {"force"}, grip.grip_force});
    curves.push_back(std::move(position));
  }
  return curves;
}

Json poses_of(const TrialRecord& record) {
  const std::vector<double>& time = record.body_time;
  const std::size_t rows = time.size();
  const double rate = rows < 2 ? 1.0 : static_cast<double>(rows - 1) / (time.back() - time.front());
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil(rate / frames_per_second - 1e-6)));
  Json poses = {{"stride", stride}, {"bodies", Json::array()}};
  for (const BodyRecord& body : record.bodies) {
    std::vector<float> position, turn;
    for (std::size_t row = 0; row < rows; ++row) {
      const auto pose = body.pose.begin() + static_cast<std::ptrdiff_t>(pose_values * row);
      position.insert(position.end(), pose, pose + 3);
      turn.insert(turn.end(), pose + 3, pose + 7);
    }
    poses["bodies"].push_back({{"name", body.name},
                               {"size", body.size.empty() ? Json(nullptr) : Json(body.size)},
                               {"position", page::pack_curves(position, 3, stride)},
                               {"turn", page::pack_curves(turn, 4, stride)}});
  }
  return poses;
}

}  // namespace

Json grasp_summary(const GraspOutcome& outcome) {
  return {{"dropped", outcome.dropped},
          {"drop_s", or_null(outcome.drop_time)},
          {"slip_m", or_null(outcome.slip_translation)},
          {"rotation_rad", or_null(outcome.slip_rotation)},
          {"max_force_N", or_null(outcome.max_grip_force)},
          {"final_force_N", or_null(outcome.final_grip_force)},
          {"ideal_force_N", or_null(outcome.ideal_grip_force)},
          {"reaction_s", or_null(outcome.reaction_time)}};
}

double lift_time(const TrialRecord& record) {
  const auto arm = std::ranges::find(record.bodies, "arm", &BodyRecord::name);
  return arm == record.bodies.end() ? std::numeric_limits<double>::quiet_NaN()
                                    : record.body_time[lift_row(*arm, record.num_samples())];
}

Json grasp_payload(const TrialRecord& record, std::size_t curve_values, const std::string& place) {
  const BodyRecord& arm = body_named(record, "arm", place);
  const BodyRecord& box = body_named(record, "box", place);
  const std::size_t lift = lift_row(arm, record.num_samples());
  const std::vector<GraspCurve> curves = curves_of(record, arm, box, lift);
  std::size_t total = 0;
  for (const GraspCurve& curve : curves) total += curve.values.size();
  const std::size_t stride = total <= curve_values ? 1 : (total + curve_values - 1) / curve_values;
  Json payload = {{"lift_s", record.body_time[lift]},
                  {"detector", record.control ? record.control->detector : ""},
                  {"controller", record.control ? record.control->controller : ""},
                  {"time", page::pack_times(record.body_time)},
                  {"stride", stride},
                  {"curves", Json::object()},
                  {"poses", poses_of(record)}};
  for (const GraspCurve& curve : curves) {
    payload["curves"][curve.key] = {{"unit", curve.unit},
                                    {"components", curve.components},
                                    {"data", page::pack_curves(curve.values, curve.components.size(), stride)}};
  }
  return payload;
}

}  // namespace slipbench::report

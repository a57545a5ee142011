#include "sim/motion/motion_catalogue.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
#include "sim/motion/profile.h"
#include "sim/motion/straight_path.h"

namespace slipbench {
namespace {

constexpr const char* recorded =
    "motion capture of the published trials (repository JT2106): 43 mm/s on the plateau, reached in 0.1 s";

Entry lift_entry() {
  return {
      "lift",
      "The arm of a grasp waits and lifts; then it may move sideways, tilt and shake, one after the other.",
      "height, sideways motion and tilt: trapezoids from rest to rest\n"
      "shake: s(t) = shake/2 (1 - cos(2 pi shake_frequency t)) for shake_cycles whole cycles: it begins and ends at rest",
      "trapezoidal profiles; integrated exactly",
      {number_spec("settle", Quantity::time, "1.5 s", non_negative, "How long the arm waits while the gripper takes the box.",
                   "assumed"),
       number_spec("distance", Quantity::length, "100 mm", positive_up_to(2.0), "How far the arm lifts.", recorded),
       number_spec("speed", Quantity::speed, "43 mm/s", positive_up_to(10.0),
                   "Speed of the lift and of the sideways motion; with protocol as_printed: 5 mm/s.", recorded),
       number_spec("acceleration", Quantity::acceleration, "400 mm/s2", positive,
                   "Acceleration of the lift and of the sideways motion; with protocol as_printed: 50 mm/s2.", recorded),
       vector_spec(2, "sideways", Quantity::length, "[0 mm, 0 mm]", {-2.0, 2.0},
                   "Sideways motion after the lift: along the fingers' closing direction, across it.", "set for each scene"),
       vector_spec(2, "tilt", Quantity::angle, "[0 deg, 0 deg]", any_value,
                   "Rotation vector of the tilt after the sideways motion: about the closing direction, across it.",
                   "set for each scene"),
       number_spec("tilt_speed", Quantity::angular_speed, "30 deg/s", positive, "Angular speed of the tilt.", "assumed"),
       number_spec("tilt_acceleration", Quantity::angular_acceleration, "100 deg/s2", positive,
                   "Angular acceleration of the tilt.", "assumed"),
       vector_spec(3, "shake", Quantity::length, "[0 mm, 0 mm, 0 mm]", {-2.0, 2.0},
                   "Shaking after the tilt, from end to end: along the closing direction, across it, up.", "set for each scene"),
       number_spec("shake_frequency", Quantity::frequency, "5 Hz", positive, "Shaking frequency.", "assumed"),
       integer_spec("shake_cycles", "10", non_negative, "Number of shaking cycles.", "assumed")}};
}

Eigen::Vector3d flat(const std::vector<double>& v) { return {v[0], v[1], 0.0}; }

class Lift final : public Motion {
 public:
  explicit Lift(const Parameters& p)
      : sideways_(flat(p.vector("sideways"))),
        tilt_(flat(p.vector("tilt"))),
        shake_(Eigen::Vector3d::Map(p.vector("shake").data())),
        height_(0.0),
        way_(0.0),
        turn_(0.0),
        shake_rate_(2.0 * std::numbers::pi * p.number("shake_frequency")) {
    const LiftTimes lift = lift_times(p);
    height_.move(lift.start, p.number("distance"), p.number("speed"), p.number("acceleration"));
    way_.move(lift.end, sideways_.norm(), p.number("speed"), p.number("acceleration"));
    const double stopped = std::max(lift.end, way_.end());
    turn_.move(stopped, tilt_.norm(), p.number("tilt_speed"), p.number("tilt_acceleration"));
    shake_from_ = std::max(stopped, turn_.end());
    shake_until_ = shake_from_ + static_cast<double>(p.integer("shake_cycles")) / p.number("shake_frequency");
    sideways_.normalize();
    tilt_.normalize();
  }

  [[nodiscard]] BodyState pad_at(double t) const override {
    const ProfilePoint height = height_.at(t), way = way_.at(t), turn = turn_.at(t);
    BodyState arm;
    arm.pose.position = way.position * sideways_ + Eigen::Vector3d(0.0, 0.0, height.position);
    arm.velocity = way.velocity * sideways_ + Eigen::Vector3d(0.0, 0.0, height.velocity);
    if (turns()) {
      arm.pose.rotation = rotation_about(tilt_, turn.position);
      arm.angular_velocity = turn.velocity * tilt_;
    }
    if (t > shake_from_ && t < shake_until_) {
      const double phase = shake_rate_ * (t - shake_from_);
      arm.pose.position += 0.5 * (1.0 - math::cos(phase)) * shake_;
      arm.velocity += 0.5 * shake_rate_ * math::sin(phase) * shake_;
    }
    return arm;
  }

  [[nodiscard]] double top_speed(double reach) const override {
    return height_.top_speed() + way_.top_speed() + turn_.top_speed() * reach + 0.5 * shake_rate_ * shake_.norm();
  }

  [[nodiscard]] double longest_step() const override {
    const bool shakes = shake_.norm() > 0.0 && shake_until_ > shake_from_;
    return std::min(step_per_turn(turn_.top_speed()), step_per_period(shakes ? shake_rate_ / (2.0 * std::numbers::pi) : 0.0));
  }

  [[nodiscard]] bool turns() const override { return !turn_.at_rest_always(); }

 private:
  Eigen::Vector3d sideways_, tilt_;  // unit vectors, or zero
  Eigen::Vector3d shake_;            // m
  Profile height_, way_, turn_;      // m, m, rad
  double shake_rate_;                // rad/s
  double shake_from_ = 0.0, shake_until_ = 0.0;
};

}  // namespace

LiftTimes lift_times(const Parameters& parameters) {
  const double start = parameters.number("settle");
  Profile height(0.0);
  height.move(start, parameters.number("distance"), parameters.number("speed"), parameters.number("acceleration"));
  return {start, std::max(start, height.end())};
}

MotionKind lift_motion() { return motion_kind<Lift>(lift_entry(), true); }

}  // namespace slipbench

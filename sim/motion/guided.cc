#include "sim/motion/guided.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/parameters.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
Guided::Guided(const Parameters& parameters)
    : speed_(parameters.number("top_speed")),
      acceleration_(parameters.number("top_acceleration")),
      latency_(parameters.number("latency")),
      sideways_(0.0),
      up_(0.0) {}

void Guided::write(double time, const ArmCommand& command) {
  for (const double speed : {command.sideways, command.up}) {
    if (std::abs(speed) <= speed_) continue;
    throw SceneValueError(
        "motion.top_speed",
        fmt::format("at {1:.6g} s the controller commanded an arm speed of {0}; allowed: up to {2}",
                    readable_quantity(speed, Quantity::speed), time, readable_quantity(speed_, Quantity::speed)));
  }
  const double acts = time + latency_;
  // A repeated velocity is not a change: otherwise a profile would grow with every write.
  if (command.sideways != written_.sideways) sideways_.change_velocity(acts, command.sideways, acceleration_);
  if (command.up != written_.up) up_.change_velocity(acts, command.up, acceleration_);
  if (command.up > 0.0 && std::isinf(lift_start_)) lift_start_ = acts;
  written_ = command;
}

BodyState Guided::pad_at(double t) const {
  const ProfilePoint sideways = sideways_.at(t), up = up_.at(t);
  BodyState arm;
  arm.pose.position = {0.0, sideways.position, up.position};
  arm.velocity = {0.0, sideways.velocity, up.velocity};
  return arm;
}

double Guided::top_speed(double) const { return std::numbers::sqrt2 * speed_; }

MotionKind guided_motion() {
  return motion_kind<Guided>(
      {"guided",
       "The arm of a grasp moves at the speed that the controller commands, sideways and up.",
       "`latency` after a write, each velocity begins to change at `top_acceleration` to the commanded velocity and then stays constant\nbefore the first command the arm is at rest",
       "a robot's velocity interface; integrated exactly",
       {number_spec("top_speed", Quantity::speed, "100 mm/s", positive_up_to(10.0),
                    "Highest speed that a controller may command; a higher speed is an error.", "assumed"),
        number_spec("top_acceleration", Quantity::acceleration, "200 mm/s2", positive, "Acceleration of either axis.", "assumed"),
        number_spec("latency", Quantity::time, "8 ms", non_negative, "Time from a write of the loop until the arm responds.",
                    "assumed: one period of the 125 Hz at which a UR5-CB2 takes commands")}},
      true);
}

}  // namespace slipbench

// The arm of a grasp, moved by its controller's commands.
//
// Command. A command written at t takes effect at t + latency: from then on the arm's velocity,
// sideways and up, changes to the commanded one with the constant `top_acceleration`, independently
// on each axis, and stays. So the motion is a closed form of the commands and does not depend on
// the caller's step. Before the first command the arm rests; after the last it keeps its velocity.
// It does not rotate, and no force moves it. (A velocity interface, like `speedl` of a UR5, with a
// stiff arm.)
#pragma once

#include <limits>

#include "sim/api/controller.h"
#include "sim/api/motion.h"
#include "sim/motion/profile.h"

namespace slipbench {

// The arm starts at the origin, aligned with the world: X is the closing direction, Y sideways, Z
// up. See describe().
MotionKind guided_motion();

class Guided final : public Motion {
 public:
  // `parameters`: of guided_motion().
  explicit Guided(const Parameters& parameters);

  // Takes a command written at `time` [s], in order of time. Throws InputError if it exceeds the
  // parameter `top_speed`, or is not a number.
  void write(double time, const ArmCommand& command);
  // Returns when the first command that raises the arm takes effect [s]; infinite until then.
  [[nodiscard]] double lift_start() const { return lift_start_; }

  [[nodiscard]] BodyState pad_at(double t) const override;
  [[nodiscard]] double top_speed(double reach) const override;
  [[nodiscard]] double longest_step() const override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool turns() const override { return false; }

 private:
  double speed_, acceleration_, latency_;  // m/s, m/s2, s
  Profile sideways_, up_;                  // m
  ArmCommand written_;
  double lift_start_ = std::numeric_limits<double>::infinity();
};

}  // namespace slipbench

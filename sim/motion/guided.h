// The arm of a grasp that goes where its controller tells it to.
//
// Command. What is written at t begins to act at t + latency: from then on the arm's velocity, sideways and up, changes to the one commanded
// with the constant `top_acceleration`, each axis for itself, and stays. So its motion is a closed form of the commands and does not depend on
// the step of who asks for it. Before the first command it rests where it is; after the last it goes on as told.
// It does not turn, and no force moves it. (A velocity interface, as that of a UR5's `speedl`, with a stiff arm.)
#pragma once

#include <limits>

#include "sim/core/controller.h"
#include "sim/motion/motion.h"
#include "sim/motion/profile.h"

namespace slipbench {

// The arm begins at the origin, aligned with the world: X is the closing direction, Y sideways, Z up. See describe().
MotionKind guided_motion();

class Guided final : public Motion {
 public:
  // `parameters`: of guided_motion().
  explicit Guided(const Parameters& parameters);

  // Takes a command written at `time` [s], in order of time. Throws InputError when it asks for more than the parameter `top_speed`, or for no
  // number.
  void write(double time, const ArmCommand& command);
  // When the first command that raises the arm begins to act [s]; infinite until there is one.
  [[nodiscard]] double lift_start() const { return lift_start_; }

  [[nodiscard]] BodyState pad_at(double t) const override;
  [[nodiscard]] double top_speed(double reach) const override;
  [[nodiscard]] bool turns() const override { return false; }

 private:
  double speed_, acceleration_, latency_;  // m/s, m/s2, s
  Profile sideways_, up_;                  // m
  ArmCommand written_;
  double lift_start_ = std::numeric_limits<double>::infinity();
};

}  // namespace slipbench

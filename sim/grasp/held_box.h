// A simulation with a gripper and a box, as whoever plays the loop and whoever records it sees them.
#pragma once

#include <Eigen/Core>

#include "sim/grasp/gripper.h"
#include "sim/motion/guided.h"

namespace slipbench {

// The truth about a grasp at one tick, which no detector and no controller sees.
struct GraspTruth {
  double time = 0.0;                               // s
  double grip_force = 0.0;                         // N, mean of both pads' normal forces
  double pad_force[2] = {0.0, 0.0};                // N, of the sensor's pad and of the second one
  double box_height = 0.0;                         // m, of the box's middle over where it stood
  double table_force = 0.0;                        // N, with which the table carries the box
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();  // m, of the box's middle in the arm's frame since the lift began; 0 before
  double rotation = 0.0;                           // rad, of the box in the arm's frame since then
  double tilt = 0.0;     // rad, between the box's own axis Y and the vertical: 0 upright, pi/2 where Y is level
  bool dropped = false;  // see below; from the tick on at which it was
};

class HeldBox {
 public:
  virtual ~HeldBox() = default;

  [[nodiscard]] virtual Gripper& gripper() = 0;
  // At the tick last stepped to.
  [[nodiscard]] virtual const GraspTruth& truth() const = 0;
  // The least force of either pad that could hold the trial's box [N]: m g/(2 mu_s), mu_s the trial's, upwards, without what effects add to
  // it in time and place; infinite without friction.
  [[nodiscard]] virtual double ideal_force() const = 0;
  // The arm that a controller commands; null where it moves as the scene prescribes.
  [[nodiscard]] virtual Guided* arm() { return nullptr; }
  // When the lift begins [s]; infinite as long as a guided arm has not been told to rise.
  [[nodiscard]] virtual double lift_start() const = 0;

 protected:
  HeldBox() = default;
  HeldBox(const HeldBox&) = default;
  HeldBox& operator=(const HeldBox&) = default;
};

}  // namespace slipbench

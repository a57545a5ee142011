// An external force on the box of a grasp: a pull, a push, a knock.
#pragma once

#include <Eigen/Core>

#include "sim/core/parameters.h"

namespace slipbench {

// The force is linear between the rows of `box.push`, and zero before the first and after the last.
class Push {
 public:
  // `rows`: time [s], then force [N] along x, y and z of the world. Throws SceneValueError at
  // box.push if all rows have the same time, and if a time is earlier than that of the row before.
  explicit Push(NumberTable rows);

  [[nodiscard]] bool empty() const { return rows_.rows.empty(); }

  // Returns the mean force [N] between two instants [s], begin < end. Applied over a step, it gives
  // a body the whole impulse, however short a knock is compared with the step.
  [[nodiscard]] Eigen::Vector3d mean(double begin, double end) const;

 private:
  NumberTable rows_;
};

}  // namespace slipbench

// Checks during a run that the step stays short enough for the pads' springs.
#pragma once

#include <cstddef>

#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/modes/dynamic_world.h"
#include "sim/mujoco/modes/field_contacts.h"

namespace slipbench {

// Rounds down to three digits: a value that a message allows must be valid when it is typed in.
[[nodiscard]] double rounded_down(double value);

class SpringLimit {
 public:
  // `longest_step`: the longest accurate step [s] of the mode.
  explicit SpringLimit(double (*longest_step)(const Vibration&)) : longest_step_(longest_step) {}

  // True if more elements touch than at the last call: only then can the limit be shorter.
  [[nodiscard]] bool due(const FieldContacts& contacts);
  // Throws SceneValueError if the step is too long for the touching elements at `time` [s].
  void check(const DynamicWorld& world, const FieldContacts& contacts, double time) const;

 private:
  double (*longest_step_)(const Vibration&);
  std::size_t touching_before_ = 0;  // elements, at the last call
};

}  // namespace slipbench

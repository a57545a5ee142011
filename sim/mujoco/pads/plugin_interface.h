// What the plugin's library tells others of a model's pads beside what MuJoCo asks for: Python's slipbench.mujoco calls it.
#pragma once

#include <string>

struct mjModel_;
struct mjData_;

namespace slipbench {

// One line for each pad, values separated by tabs: its instance's number, name, site's number, number of units, 1 with truth; then one for each
// channel of the sensor: "", name, unit and shape, as in "9 3". Throws InputError where the model's attributes are wrong.
[[nodiscard]] std::string describe_pads(const mjModel_* model);

// The longest step [s] that the explicit pads of the model bear, with all elements of every pad touching at once: each pad on that of its bodies on
// which it vibrates fastest, in the positions of `data`. Infinite without explicit pads. `data` is one of this model.
[[nodiscard]] double longest_step(const mjModel_* model, mjData_* data);

}  // namespace slipbench

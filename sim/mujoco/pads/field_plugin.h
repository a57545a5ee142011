// Access to the pads of the engine plugin `slipbench.field` for programs that step the model
// themselves.
#pragma once

#include <mujoco/mujoco.h>

#include "sim/mujoco/pads/pad_group.h"
#include "sim/mujoco/pads/pad_instance.h"

namespace slipbench {

// Returns the pad of a plugin instance in `data`; null if the instance belongs to another plugin.
PadInstance* pad_of(const mjModel* model, const mjData* data, int instance);

// Returns the group of all pads of `data`; null if there are none.
PadGroup* pad_group_of(const mjModel* model, const mjData* data);

}  // namespace slipbench

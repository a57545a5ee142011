// Access to the pads of the engine plugin `slipbench.field` for programs that step the model
// themselves.
#pragma once

#include "sim/mujoco/pads/pad_group.h"
#include "sim/mujoco/pads/pad_instance.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// Returns the pad of a plugin instance in `data`; null if the instance belongs to another plugin.
PadInstance* pad_of(ModelView model, DataView data, int instance);

// Returns the group of all pads of `data`; null if there are none.
PadGroup* pad_group_of(ModelView model, DataView data);

}  // namespace slipbench

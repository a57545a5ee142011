// Makes the engine plugin `slipbench.field` known to MuJoCo.
#pragma once

#include "sim/mujoco/pad_catalogue.h"

namespace slipbench {

inline constexpr const char* field_plugin_name = "slipbench.field";

// Call once, before a model that uses the plugin is read. Says so by mju_warning and does nothing when the MuJoCo that is loaded
// is not the version this was compiled for: MuJoCo's structures are not the same in any two.
void register_field_plugin(PadCatalogue catalogue);

}  // namespace slipbench

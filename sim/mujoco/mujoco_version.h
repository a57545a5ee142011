// Which MuJoCo runs.
#pragma once

#include <string>

namespace slipbench {

// Version of the library that was loaded, e.g. "4.0.1".
std::string mujoco_library_version();

// Whether the loaded library is the one whose headers this program was built with. MuJoCo keeps no binary compatibility between
// versions, so a mismatch means that structs are read at wrong offsets.
bool mujoco_header_matches_library();

}  // namespace slipbench

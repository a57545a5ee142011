#include "sim/mujoco/mujoco_version.h"

#include <mujoco/mujoco.h>

namespace slipbench {

std::string mujoco_library_version() { return mj_versionString(); }

bool mujoco_header_matches_library() { return mjVERSION_HEADER == mj_version(); }

}  // namespace slipbench

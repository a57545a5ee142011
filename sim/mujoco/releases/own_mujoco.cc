#include <mujoco/mjplugin.h>
#include <mujoco/mujoco.h>

#include "sim/mujoco/releases/mujoco_library.h"

extern "C" {
extern const SlipbenchLayout slipbench_mujoco_layout;  // layout.c, compiled with the same headers
void* mj_arenaAllocByte(mjData* d, std::size_t bytes, std::size_t alignment);
void mj_effShift(const mjModel* m, mjData* d);
}

namespace slipbench {

const MujocoLibrary& own_mujoco() {
  static const MujocoLibrary own = [] {
    MujocoLibrary library;
    library.layout = slipbench_mujoco_layout;
#define SLIPBENCH_FUNCTION(result, name, parameters) library.name = &::name;
    SLIPBENCH_MUJOCO_FUNCTIONS(SLIPBENCH_FUNCTION)
#undef SLIPBENCH_FUNCTION
    library.mj_fullM = reinterpret_cast<void (*)()>(&::mj_fullM);
    library.mj_arenaAllocByte = &::mj_arenaAllocByte;
    library.mj_effShift = &::mj_effShift;
    return library;
  }();
  return own;
}

}  // namespace slipbench

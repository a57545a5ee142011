// The functions of MuJoCo that libslipbench_mujoco-others.so calls: those of the library that it serves. mujoco_calls.h, which MuJoCo's header then
// ends with, makes every call in the sources one of these.
#pragma once

#include "tools/program/plugin/any_model.h"

extern "C" {
void* mj_arenaAllocByte(mjData* d, size_t bytes, size_t alignment);
void mj_effShift(const mjModel* m, mjData* d);
}

namespace slipbench::any_mujoco {

#define SLIPBENCH_CALL(name) decltype(&::name) name##_;
struct Calls {
  SLIPBENCH_MUJOCO_CALLS(SLIPBENCH_CALL)
};
#undef SLIPBENCH_CALL

extern Calls calls;

// Finds the loaded MuJoCo that is one of mujoco_layouts.h, and fills the table and the calls for it. False, with a warning, where there is none.
bool choose();

}  // namespace slipbench::any_mujoco

// MuJoCo's warnings as exceptions.
#pragma once

#include <mujoco/mujoco.h>

namespace slipbench {

// Throws InputError if mjData has counted a warning, with MuJoCo's text, the time [s] and the body
// that it names, if any.
void refuse_warnings(const mjModel* model, const mjData* data, double time);

}  // namespace slipbench

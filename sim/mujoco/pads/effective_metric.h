// The effective metric of MuJoCo's integrator `discrete`, M + h^2 K (implicit.h). MuJoCo exports the
// functions needed here without declaring them in a header (mujoco_library.h); implicit_self_test()
// verifies their types on the actual model.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// True if the step in progress solves with the metric.
inline bool metric_is_on(DataView d) { return d.efm_active() != 0; }

// Adds the contribution of the rows at the current velocity to the force, as MuJoCo does after its
// PASSIVE callbacks.
inline void shift_by_metric(ModelView m, DataView d) { m.mujoco().mj_effShift(m.get(), d.get()); }

// Appends rows to the metric: indices [n, contact, columns...], values [scale, force, values...],
// packed. Returns false if the arena is full.
inline bool append_to_metric(DataView d, const std::vector<int>& more_indices, const std::vector<double>& more_values) {
  const auto before = static_cast<std::size_t>(d.nefmcon()), total = before + more_indices.size();
  auto* indices = static_cast<int*>(d.mujoco().mj_arenaAllocByte(d.get(), total * sizeof(int), alignof(int)));
  auto* values = static_cast<double*>(d.mujoco().mj_arenaAllocByte(d.get(), total * sizeof(double), alignof(double)));
  if (indices == nullptr || values == nullptr) return false;
  std::copy_n(&d.efm_con_ind()[0], before, indices);
  std::copy_n(&d.efm_con_val()[0], before, values);
  std::copy(more_indices.begin(), more_indices.end(), indices + before);
  std::copy(more_values.begin(), more_values.end(), values + before);
  d.efm_con_ind() = indices;
  d.efm_con_val() = values;
  d.nefmcon() = static_cast<int>(total);
  return true;
}

}  // namespace slipbench

// What the versions of MuJoCo that the plugin is built for do not have alike; all that depends on a version is here.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <mujoco/mujoco.h>

// Whether this MuJoCo has the integrator `discrete` and its effective metric, M + h^2 K (implicit.h). The library exports what that takes, and no
// header declares it. Types and layout are those of 3.17.0, 4.0.0 and 4.0.1, and implicit_self_test() proves them on the very model.
#define SLIPBENCH_MUJOCO_HAS_METRIC (mjVERSION_HEADER >= 3017000)

#if SLIPBENCH_MUJOCO_HAS_METRIC
extern "C" {
void* mj_arenaAllocByte(mjData* d, size_t bytes, size_t alignment);
void mj_effShift(const mjModel* m, mjData* d);
}
#endif

namespace slipbench {

// Whether the flag `sleep` is on, where there is one.
inline bool sleep_enabled([[maybe_unused]] const mjModel* m) {
#if mjVERSION_HEADER >= 340  // 3.4.0 as it was written then
  return (m->opt.enableflags & mjENBL_SLEEP) != 0;
#else
  return false;
#endif
}

// The joint-space inertia [nv, nv]; `d` must have been through mj_fwdPosition.
inline void full_inertia(const mjModel* m, const mjData* d, mjtNum* to) {
#if mjVERSION_HEADER >= 3017000
  mj_fullM(m, d, to);
#else
  mj_fullM(m, to, d->qM);
#endif
}

inline int actuator_count(const mjModel* m) {
#if mjVERSION_HEADER >= 3017000
  return static_cast<int>(m->nactuator);
#else
  return static_cast<int>(m->nu);
#endif
}

inline constexpr bool has_metric = SLIPBENCH_MUJOCO_HAS_METRIC;

// Whether the step in progress solves with the metric.
inline bool metric_is_on([[maybe_unused]] const mjData* d) {
#if SLIPBENCH_MUJOCO_HAS_METRIC
  return d->efm_active != 0;
#else
  return false;
#endif
}

inline bool is_discrete([[maybe_unused]] const mjModel* m) {
#if SLIPBENCH_MUJOCO_HAS_METRIC
  return m->opt.integrator == mjINT_DISCRETE;
#else
  return false;
#endif
}

// Adds the velocity's share of the rows to the force, as MuJoCo does after its PASSIVE callbacks.
inline void shift_by_metric([[maybe_unused]] const mjModel* m, [[maybe_unused]] mjData* d) {
#if SLIPBENCH_MUJOCO_HAS_METRIC
  mj_effShift(m, d);
#endif
}

// Appends rows to the metric: indices [n, contact, columns...], values [scale, force, values...], packed. False when the arena is full.
inline bool append_to_metric([[maybe_unused]] mjData* d, [[maybe_unused]] const std::vector<int>& more_indices,
                             [[maybe_unused]] const std::vector<mjtNum>& more_values) {
#if SLIPBENCH_MUJOCO_HAS_METRIC
  const auto before = static_cast<std::size_t>(d->nefmcon), total = before + more_indices.size();
  auto* indices = static_cast<int*>(mj_arenaAllocByte(d, total * sizeof(int), alignof(int)));
  auto* values = static_cast<mjtNum*>(mj_arenaAllocByte(d, total * sizeof(mjtNum), alignof(mjtNum)));
  if (indices == nullptr || values == nullptr) return false;
  std::copy_n(d->efm_con_ind, before, indices);
  std::copy_n(d->efm_con_val, before, values);
  std::copy(more_indices.begin(), more_indices.end(), indices + before);
  std::copy(more_values.begin(), more_values.end(), values + before);
  d->efm_con_ind = indices;
  d->efm_con_val = values;
  d->nefmcon = static_cast<int>(total);
  return true;
#else
  return false;
#endif
}

}  // namespace slipbench

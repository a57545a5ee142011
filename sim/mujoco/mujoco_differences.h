// What the versions of MuJoCo that the plugin works in do not have alike; all that depends on a version is here. Sources are compiled once with the
// headers of the bench's own MuJoCo, and once for all others: SLIPBENCH_ANY_MUJOCO (tools/program/plugin/any_model.h), where members have their places
// in the release that is loaded.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#ifndef SLIPBENCH_ANY_MUJOCO
extern "C" {
void* mj_arenaAllocByte(mjData* d, size_t bytes, size_t alignment);
void mj_effShift(const mjModel* m, mjData* d);
}
#endif

namespace slipbench {

// Whether the loaded MuJoCo is one that this code is compiled for; else it warns, with both versions.
inline bool meet_mujoco() {
#ifdef SLIPBENCH_ANY_MUJOCO
  return any_mujoco::choose();
#else
  if (mj_version() == mjVERSION_HEADER) return true;
  const auto part = [](int size) { return std::to_string(mjVERSION_HEADER / size % 1000); };
  // No mju_error: it may jump over the loader that is running a library's constructors, which would then stay locked.
  mju_warning("slipbench.field is for MuJoCo %s.%s.%s and not for %s, the one that is loaded: it stays unknown",
              part(1000000).c_str(), part(1000).c_str(), part(1).c_str(), mj_versionString());
  return false;
#endif
}

// Whether the flag `sleep` is on, where there is one.
inline bool sleep_enabled(const mjModel* m) { return (m->opt.enableflags & mjENBL_SLEEP) != 0; }

// The joint-space inertia [nv, nv]; `d` must have been through mj_fwdPosition.
inline void full_inertia(const mjModel* m, const mjData* d, mjtNum* to) {
#ifdef SLIPBENCH_ANY_MUJOCO
  if (mj_version() < 3010000) {
    using Older = void (*)(const mjModel*, mjtNum*, const mjtNum*);
    return reinterpret_cast<Older>(reinterpret_cast<void*>(&mj_fullM))(m, to, d->qM);
  }
#endif
  mj_fullM(m, d, to);
}

// Element k of a scene's geoms, whose size differs.
inline mjvGeom* geom_of(mjvScene* scene, int k) {
#ifdef SLIPBENCH_ANY_MUJOCO
  return reinterpret_cast<mjvGeom*>(reinterpret_cast<char*>(scene->geoms) +
                                    k * any_mujoco::number(any_mujoco::geom_bytes_number));
#else
  return scene->geoms + k;
#endif
}

// Whether this MuJoCo has the integrator `discrete` and its effective metric, M + h^2 K (implicit.h). The library exports what that takes, and no
// header declares it. Types are those of 3.17.0, 4.0.0 and 4.0.1, and implicit_self_test() proves them on the very model.
inline bool has_metric() { return mj_version() >= 3017000; }

// Whether the step in progress solves with the metric.
inline bool metric_is_on(const mjData* d) { return has_metric() && d->efm_active != 0; }

// Adds the velocity's share of the rows to the force, as MuJoCo does after its PASSIVE callbacks.
inline void shift_by_metric(const mjModel* m, mjData* d) { mj_effShift(m, d); }

// Appends rows to the metric: indices [n, contact, columns...], values [scale, force, values...], packed. False when the arena is full.
inline bool append_to_metric(mjData* d, const std::vector<int>& more_indices, const std::vector<mjtNum>& more_values) {
  const auto before = static_cast<std::size_t>(d->nefmcon), total = before + more_indices.size();
  auto* indices = static_cast<int*>(mj_arenaAllocByte(d, total * sizeof(int), alignof(int)));
  auto* values = static_cast<mjtNum*>(mj_arenaAllocByte(d, total * sizeof(mjtNum), alignof(mjtNum)));
  if (indices == nullptr || values == nullptr) return false;
  std::copy_n(&d->efm_con_ind[0], before, indices);
  std::copy_n(&d->efm_con_val[0], before, values);
  std::copy(more_indices.begin(), more_indices.end(), indices + before);
  std::copy(more_values.begin(), more_values.end(), values + before);
  d->efm_con_ind = indices;
  d->efm_con_val = values;
  d->nefmcon = static_cast<int>(total);
  return true;
}

}  // namespace slipbench

// Differences between the releases of MuJoCo for which the plugin is built; all code that depends
// on a release is here. The plugin's sources are compiled against the headers of each
// (tools/plugin).
#pragma once

#include <string>

#include <mujoco/mujoco.h>

namespace slipbench {

// True if the loaded MuJoCo is the release for which this code is compiled; otherwise warns, with
// both versions.
inline bool meet_mujoco() {
  if (mj_version() == mjVERSION_HEADER) return true;
  // 3.3.7 reports 337, and 4.0.1 reports 4000001
  constexpr int base = mjVERSION_HEADER < 1000 ? 10 : 1000;
  const auto part = [](int size) { return std::to_string(mjVERSION_HEADER / size % base); };
  // Not mju_error: it may jump over the loader that is running a library's constructors, which
  // would then stay locked.
  mju_warning("slipbench.field was built for MuJoCo %s.%s.%s, but %s is loaded: the plugin is not registered",
              part(base * base).c_str(), part(base).c_str(), part(1).c_str(), mj_versionString());
  return false;
}

// True if the flag `sleep` is on; 3.3.7 has no such flag.
inline bool sleep_enabled([[maybe_unused]] const mjModel* m) {
#if mjVERSION_HEADER >= 4000000
  return (m->opt.enableflags & mjENBL_SLEEP) != 0;
#else
  return false;
#endif
}

// Writes the joint-space inertia [nv, nv]; `d` must have been through mj_fwdPosition.
inline void full_inertia(const mjModel* m, const mjData* d, mjtNum* to) {
#if mjVERSION_HEADER >= 4000000
  mj_fullM(m, d, to);
#else
  mj_fullM(m, to, d->qM);
#endif
}

}  // namespace slipbench

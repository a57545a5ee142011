#include <string>
#include <utility>

#include <mujoco/mujoco.h>

#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/pads/register_plugin.h"

namespace slipbench {
namespace {

// True if the loaded MuJoCo is the release for which the program is compiled; otherwise warns, with
// both versions.
bool meet_mujoco() {
  if (mj_version() == mjVERSION_HEADER) return true;
  const auto part = [](int size) { return std::to_string(mjVERSION_HEADER / size % 1000); };
  mju_warning("slipbench was built for MuJoCo %s.%s.%s, but %s is loaded: the plugin is not registered", part(1'000'000).c_str(),
              part(1000).c_str(), part(1).c_str(), mj_versionString());
  return false;
}

}  // namespace

void register_field_plugin(PadCatalogue pads) {
  if (meet_mujoco()) register_plugin(own_mujoco(), field_plugin_name, std::move(pads), &carry_to_caller);
}

void register_bench_plugin(PadCatalogue pads) {
  if (!meet_mujoco()) return;
  register_plugin(own_mujoco(), field_plugin_name, pads, &carry_to_caller);
  register_plugin(own_mujoco(), bench_plugin_name, std::move(pads), &carry_to_caller);
}

}  // namespace slipbench

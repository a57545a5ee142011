#include "tools/program/doctor/environment.h"

#include <cstdlib>
#include <thread>

#include "tools/program/doctor/build_info.h"
#include "tools/program/doctor/machine.h"
#if SLIPBENCH_WITH_MUJOCO
#include "sim/mujoco/mujoco_version.h"
#endif

namespace slipbench {

nlohmann::ordered_json environment_json() {
  using Json = nlohmann::ordered_json;
  const BuildInfo& build = build_info();
  double load = 0.0;
  const bool known = getloadavg(&load, 1) == 1;
  Json json{{"cpu", cpu_name()},
            {"cores", std::thread::hardware_concurrency()},
            {"avx2", has_avx2()},
            {"os", operating_system()},
            {"compiler", build.compiler},
            {"flags", build.flags},
            {"build_type", build.build_type},
            {"version", build.version},
            {"commit", build.commit},
            {"mujoco", nullptr},
            {"load", known ? Json(load) : Json(nullptr)}};
#if SLIPBENCH_WITH_MUJOCO
  json["mujoco"] = mujoco_library_version();
#endif
  return json;
}

}  // namespace slipbench

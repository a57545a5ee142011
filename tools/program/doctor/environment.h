// What a measured time or count depends on, to stand beside every figure that is published.
#pragma once

#include <nlohmann/json.hpp>

namespace slipbench {

// {"cpu", "cores", "avx2", "os", "compiler", "flags", "build_type", "version", "commit", "mujoco", "load"}: cores are hardware threads, load
// is the mean number of running processes over the last minute (null where the system does not say), mujoco is null without MuJoCo.
nlohmann::ordered_json environment_json();

}  // namespace slipbench

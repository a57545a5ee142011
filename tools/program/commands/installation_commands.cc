#include "tools/program/commands/installation_commands.h"

#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/doctor/doctor.h"
#include "tools/program/plugin/plugin_builds.h"

namespace slipbench {

void DoctorCommand::declare(Arguments& arguments) {
  arguments.about("doctor", "Check the installation", R"(
Exit status 0 when everything required is there, 1 otherwise, with the command that installs it.)");
}

int DoctorCommand::run() { return doctor_main(json); }

void PluginPathCommand::declare(Arguments& arguments) {
  arguments.about("plugin-path", "Print where the MuJoCo plugin is", R"(
For `mj_loadPluginLibrary`: the library looks which MuJoCo loads it, and takes the build for that version. With --mujoco: the build for one version.
scenes/mujoco/README.md shows what the plugin is for.)");
  arguments.text("--mujoco VERSION", mujoco, "The build for this version of MuJoCo, such as 3.3.7");
}

int PluginPathCommand::run() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path front = own_path(SLIPBENCH_PLUGIN);
  if (!fs::exists(front, error)) {
    throw InputError(fmt::format(
        "there is no MuJoCo plugin {}: `./slipbench plugin-path` builds it where there is MuJoCo; `slipbench doctor` says how to get that",
        front.string()));
  }
  const std::string build = mujoco.empty() ? front.filename().string() : plugin_build(mujoco);
  if (build.empty()) {
    throw InputError(fmt::format("--mujoco {}: there is no build of the plugin for MuJoCo {}; allowed: {}", mujoco, mujoco,
                                 plugin_versions_text(mujoco)));
  }
  const fs::path path = fs::canonical(front.parent_path() / build);
  if (json) {
    fmt::print("{}\n", nlohmann::json{{"plugin", path.string()}}.dump());
  } else {
    fmt::print("{}\n", path.string());
  }
  return exit_good;
}

}  // namespace slipbench

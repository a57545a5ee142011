#include "tools/program/cli/installation_commands.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "sim/core/own_library.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/doctor/doctor.h"

namespace slipbench {

void DoctorCommand::declare(Arguments& arguments) {
  arguments.about("doctor", "Check the installation", R"(
Exit status 0 when everything required is there, 1 otherwise, with the command that installs it.)");
}

int DoctorCommand::run() { return doctor_main(json); }

namespace {

// Versions of MuJoCo for which there is a build, comma-separated.
std::string plugin_builds() {
  const std::filesystem::path front = own_path(SLIPBENCH_PLUGIN);
  const std::string prefix = front.stem().string() + "-", suffix = front.extension().string();
  std::vector<std::string> versions;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(front.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(suffix)) {
      versions.push_back(name.substr(prefix.size(), name.size() - prefix.size() - suffix.size()));
    }
  }
  std::ranges::sort(versions);
  return fmt::format("{}", fmt::join(versions, ", "));
}

}  // namespace

void PluginPathCommand::declare(Arguments& arguments) {
  arguments.about("plugin-path", "Print where the MuJoCo plugin is", R"(
For `mj_loadPluginLibrary`: the library looks which MuJoCo loads it, and takes the build for that version. With --mujoco: the build for one version;
`./slipbench` makes it first where there is none. scenes/mujoco/README.md shows what the plugin is for.)");
  arguments.text("--mujoco VERSION", mujoco, "The build for this version of MuJoCo, such as 3.3.7");
}

int PluginPathCommand::run() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path front = own_path(SLIPBENCH_PLUGIN);
  if (!fs::exists(front, error)) {
    throw InputError(fmt::format(
        "there is no MuJoCo plugin {}: this slipbench was built without MuJoCo; `slipbench doctor` says how to get it",
        front.string()));
  }
  const fs::path wanted =
      mujoco.empty() ? front
                     : front.parent_path() / fmt::format("{}-{}{}", front.stem().string(), mujoco, front.extension().string());
  const fs::path path = fs::canonical(wanted, error);
  if (error) {
    throw InputError(
        fmt::format("--mujoco {}: there is no build of the plugin for MuJoCo {}; allowed: {}", mujoco, mujoco, plugin_builds()));
  }
  if (json) {
    fmt::print("{}\n", nlohmann::json{{"plugin", path.string()}}.dump());
  } else {
    fmt::print("{}\n", path.string());
  }
  return exit_good;
}

}  // namespace slipbench

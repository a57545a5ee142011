#include "tools/program/cli/installation_commands.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>
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

void PluginPathCommand::declare(Arguments& arguments) {
  arguments.about("plugin-path", "Print where the MuJoCo plugin is", R"(
Any MuJoCo program of the right version can load the library; scenes/mujoco/README.md shows how.)");
}

int PluginPathCommand::run() {
  namespace fs = std::filesystem;
  std::error_code error;
  const std::string wanted = own_path(SLIPBENCH_PLUGIN);
  const fs::path path = fs::canonical(wanted, error);
  if (error) {
    throw InputError(fmt::format(
        "there is no MuJoCo plugin {}: this slipbench was built without MuJoCo; `slipbench doctor` says how to get it", wanted));
  }
  if (json) {
    fmt::print("{}\n", nlohmann::json{{"plugin", path.string()}}.dump());
  } else {
    fmt::print("{}\n", path.string());
  }
  return exit_good;
}

}  // namespace slipbench

#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/program/cli/commands.h"

namespace slipbench {

int plugin_path_command(const Options& options) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path wanted = fs::read_symlink("/proc/self/exe").parent_path() / SLIPBENCH_PLUGIN;
  const fs::path path = fs::canonical(wanted, error);
  if (error) {
    throw InputError(fmt::format(
        "there is no MuJoCo plugin {}: this slipbench was built without MuJoCo; `slipbench doctor` says how to get it",
        wanted.lexically_normal().string()));
  }
  if (options.json) {
    fmt::print("{}\n", nlohmann::json{{"plugin", path.string()}}.dump());
  } else {
    fmt::print("{}\n", path.string());
  }
  return exit_good;
}

}  // namespace slipbench

// What this program was built from and with. The values are filled in by CMake.
#pragma once

#include <span>
#include <string_view>

namespace slipbench {

struct BuildInfo {
  std::string_view version;     // "0.2.0"
  std::string_view commit;      // git commit, "-dirty" where files were changed, "unknown" outside a checkout
  std::string_view compiler;    // "GNU 12.2.0"
  std::string_view build_type;  // "Release"
  std::string_view flags;       // compiler flags of every library
  std::string_view yaml_cpp;    // version of yaml-cpp, which has no version of its own in its headers
};

const BuildInfo& build_info();

// A Debian package of tools/setup/packages.txt.
struct SetupPackage {
  std::string_view set;  // "build", "test", "all", "all"
  std::string_view name;
};

std::span<const SetupPackage> setup_packages();

}  // namespace slipbench

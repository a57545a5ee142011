// `slipbench doctor`: what is installed, in which versions, what is missing and how to get it.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/json.h"

namespace slipbench {

// Whether something is in order.
enum class CheckStatus {
  ok,
  missing,  // not there
  wrong,    // there, but not as it has to be
};

// The outcome of one look.
struct Check {
  std::string group;  // "program", "machine", "libraries", "set-up"
  std::string name;
  CheckStatus status = CheckStatus::ok;
  bool required = true;     // false: only a part of the bench needs it
  std::string found = {};   // version or description, "" where missing
  std::string remedy = {};  // command or sentence that mends it, "" where in order
};

// Looks at everything. Never throws for what it finds.
std::vector<Check> run_checks();

// Runs the checks and prints them on stdout, as text or as one JSON object. Returns 0 when all that is required is in order, else 1.
int doctor_main(bool json);

// Name of the processor as the kernel gives it, or "unknown".
std::string cpu_name();

// Name of the operating system from /etc/os-release, or "unknown".
std::string operating_system();

// Path of a program on PATH, or "".
std::string find_program(std::string_view name);

// Versions of those of the named Debian packages that are installed. Empty where dpkg is not there.
std::map<std::string, std::string, std::less<>> installed_packages(std::span<const std::string> names);

// What a measured time or count depends on, to stand beside every figure that is published.
// {"cpu", "cores", "avx2", "os", "compiler", "flags", "build_type", "version", "commit", "mujoco", "load"}: cores are hardware threads, load
// is the mean number of running processes over the last minute (null where the system does not say), mujoco is null without MuJoCo.
Json environment_json();

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

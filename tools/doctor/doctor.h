// `slipbench doctor`: lists what is installed, in which versions, what is missing and how to
// install it.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/dataset/record/json.h"

namespace slipbench {

// Result of a check.
enum class CheckStatus {
  ok,
  missing,  // not there
  wrong,    // present, but unusable
};

// One check with its result.
struct Check {
  std::string group;  // "program", "machine", "libraries", "set-up"
  std::string name;
  CheckStatus status = CheckStatus::ok;
  bool required = true;     // false: only part of the bench needs it
  std::string found = {};   // version or description, "" if missing
  std::string remedy = {};  // command or sentence that repairs it, "" if ok
};

// Runs all checks. Does not throw for their results.
std::vector<Check> run_checks();

// Runs the checks and prints them on stdout, as text or as one JSON object. Returns 0 if all
// required checks pass, else 1.
int doctor_main(bool json);

// Processor name as the kernel gives it, or "unknown".
std::string cpu_name();

// Name of the operating system from /etc/os-release, or "unknown".
std::string operating_system();

// Path of a program on PATH, or "".
std::string find_program(std::string_view name);

// Versions of the installed ones of the named Debian packages. Empty without dpkg.
std::map<std::string, std::string, std::less<>> installed_packages(std::span<const std::string> names);

// Conditions of a measurement, to be published with every figure. {"cpu", "cores", "avx2", "os",
// "compiler", "flags", "build_type", "version", "commit", "mujoco", "load"}: cores are hardware
// threads, load is the mean number of running processes over the last minute (null if the system
// does not report it), mujoco is null without MuJoCo.
Json environment_json();

struct BuildInfo {
  std::string_view version;     // "0.2.0"
  std::string_view commit;      // git commit, "-dirty" with local changes, "unknown" outside a checkout
  std::string_view compiler;    // "GNU 12.2.0"
  std::string_view build_type;  // "Release"
  std::string_view flags;       // compiler flags of every library
  std::string_view yaml_cpp;    // yaml-cpp's headers do not state its version
};

const BuildInfo& build_info();

// A Debian package of tools/setup/packages.txt.
struct SetupPackage {
  std::string_view set;  // "build", "test", "all", "all"
  std::string_view name;
};

std::span<const SetupPackage> setup_packages();

}  // namespace slipbench

#include "tools/doctor/doctor.h"

#include <libdeflate.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include <H5public.h>
#include <fmt/core.h>
#include <openssl/crypto.h>
#include <Eigen/Core>

#include "sim/core/counted.h"
#include "sim/mujoco/mjcf.h"

namespace slipbench {
namespace {

constexpr const char* apt_command = "apt-get install --yes --no-install-recommends";

void add_program(std::vector<Check>& checks) {
  const BuildInfo& info = build_info();
  const auto add = [&](const char* name, std::string_view found) {
    checks.push_back({.group = "program", .name = name, .found = std::string(found)});
  };
  add("version", info.version);
  add("commit", info.commit);
  add("compiler", info.compiler);
  add("build type", info.build_type);
  add("flags", info.flags);
}

// True if the processor runs AVX2 and FMA code (x86-64-v3), the faster path of the dispatched
// kernels.
bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

void add_machine(std::vector<Check>& checks) {
  const auto add = [&](const char* name, std::string found) {
    checks.push_back({.group = "machine", .name = name, .found = std::move(found)});
  };
  add("system", operating_system());
  add("processor", fmt::format("{}, {}", cpu_name(), counted(std::thread::hardware_concurrency(), "thread")));
#if defined(__x86_64__)
  add("SIMD path", has_avx2() ? "avx2" : "baseline (no AVX2 here: same results, slower)");
#else
  add("SIMD path", "AdvSIMD");
#endif
}

Check check_hdf5() {
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  Check check{.group = "libraries", .name = "HDF5"};
  H5get_libversion(&major, &minor, &release);
  check.found = fmt::format("{}.{}.{}", major, minor, release);
  if (major != H5_VERS_MAJOR || minor != H5_VERS_MINOR || release != H5_VERS_RELEASE) {
    check.status = CheckStatus::wrong;
    check.remedy = fmt::format("the program was built with the headers of {}.{}.{}; build it again", H5_VERS_MAJOR, H5_VERS_MINOR,
                               H5_VERS_RELEASE);
  }
  return check;
}

Check check_mujoco() {
  Check check{.group = "libraries", .name = "MuJoCo"};
#if SLIPBENCH_WITH_MUJOCO
  check.found = mujoco_library_version();
  if (!mujoco_header_matches_library() || check.found != SLIPBENCH_MUJOCO_VERSION) {
    check.status = CheckStatus::wrong;
    check.remedy =
        "the program was built with the headers of " SLIPBENCH_MUJOCO_VERSION ": tools/setup/setup.sh python, then build again";
  }
#else
  check.status = CheckStatus::missing;
  check.remedy =
      "tools/setup/setup.sh python (installs mujoco-core " SLIPBENCH_MUJOCO_VERSION " into build/venv), then build again";
#endif
  return check;
}

void add_libraries(std::vector<Check>& checks) {
  const auto add = [&](const char* name, std::string found) {
    checks.push_back({.group = "libraries", .name = name, .found = std::move(found)});
  };
  add("Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION));
  add("yaml-cpp", std::string(build_info().yaml_cpp));
  checks.push_back(check_hdf5());
  add("libdeflate", LIBDEFLATE_VERSION_STRING);
  add("OpenSSL", OpenSSL_version(OPENSSL_VERSION_STRING));
  add("fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100));
  checks.push_back(check_mujoco());
}

// Adds one check per set of Debian packages, which passes if all of its packages are installed.
void add_packages(std::vector<Check>& checks) {
  std::vector<std::string> names;
  for (const SetupPackage& package : setup_packages()) names.emplace_back(package.name);
  const auto versions = installed_packages(names);
  for (const std::string_view set : {"build", "test", "all"}) {
    std::string missing;
    std::size_t wanted = 0;
    std::size_t installed = 0;
    for (const SetupPackage& package : setup_packages()) {
      if (package.set != set) continue;
      ++wanted;
      if (versions.contains(package.name)) {
        ++installed;
      } else {
        missing += fmt::format(" {}", package.name);
      }
    }
    Check check{
        .group = "set-up", .name = fmt::format("Debian packages to {}", set == "all" ? "test --all" : set), .required = false};
    check.found = fmt::format("{} of {}", installed, wanted);
    if (installed != wanted) {
      check.status = CheckStatus::missing;
      check.remedy = apt_command + missing;
    }
    checks.push_back(std::move(check));
  }
}

void add_browser(std::vector<Check>& checks) {
  Check check{.group = "set-up", .name = "browser for reports", .required = false};
  for (const char* name : {"chromium", "google-chrome", "firefox", "firefox-esr"}) {
    check.found = find_program(name);
    if (!check.found.empty()) break;
  }
  if (check.found.empty()) {
    check.status = CheckStatus::missing;
    check.remedy = fmt::format("open reports in any browser on any machine, or install one here: {} chromium", apt_command);
  }
  checks.push_back(std::move(check));
}

const char* status_text(CheckStatus status) {
  switch (status) {
    case CheckStatus::ok: return "ok";
    case CheckStatus::missing: return "missing";
    case CheckStatus::wrong: return "wrong";
  }
  return "";
}

void print_text(const std::vector<Check>& checks, bool good) {
  std::string_view group;
  for (const Check& check : checks) {
    if (check.group != group) {
      fmt::print("{}{}\n", group.empty() ? "" : "\n", check.group);
      group = check.group;
    }
    const bool ok = check.status == CheckStatus::ok;
    const std::string note =
        ok ? "" : fmt::format("{} ({})", status_text(check.status), check.required ? "required" : "optional");
    fmt::print("  {:<26} {}{}{}\n", check.name, check.found, ok || check.found.empty() ? "" : ", ", note);
    if (!ok) fmt::print("  {:<26} -> {}\n", "", check.remedy);
  }
  fmt::print("\n{}\n", good ? "Everything required is installed."
                            : "Something required is missing or wrong; see the lines marked (required).");
}

void print_json(const std::vector<Check>& checks, bool good) {
  Json list = Json::array();
  for (const Check& check : checks) {
    list.push_back({{"group", check.group},
                    {"name", check.name},
                    {"status", status_text(check.status)},
                    {"required", check.required},
                    {"found", check.found},
                    {"remedy", check.remedy}});
  }
  fmt::print("{}\n", Json{{"ok", good}, {"checks", std::move(list)}}.dump(2));
}

// Text after `separator` in the first line of a file that begins with `key`, without
// quotes; "unknown" if there is no such line.
std::string value_in_file(const char* path, std::string_view key, char separator) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    std::string value = line.substr(line.find(separator) + 1);
    value.erase(0, value.find_first_not_of(" \t\""));
    while (value.ends_with('"')) value.pop_back();
    return value;
  }
  return "unknown";
}

struct ClosePipe {
  void operator()(std::FILE* pipe) const { pclose(pipe); }
};

}  // namespace

std::vector<Check> run_checks() {
  std::vector<Check> checks;
  add_program(checks);
  add_machine(checks);
  add_libraries(checks);
  add_packages(checks);
  add_browser(checks);
  return checks;
}

int doctor_main(bool json) {
  const std::vector<Check> checks = run_checks();
  const bool good = std::ranges::all_of(checks, [](const Check& c) { return !c.required || c.status == CheckStatus::ok; });
  json ? print_json(checks, good) : print_text(checks, good);
  return good ? 0 : 1;
}

std::string cpu_name() {
  std::string name = value_in_file("/proc/cpuinfo", "model name", ':');
  if (name == "unknown") {  // as on arm64, where the firmware names the board
    std::ifstream board("/proc/device-tree/model");
    std::getline(board, name, '\0');
  }
  return name;
}

std::string operating_system() { return value_in_file("/etc/os-release", "PRETTY_NAME", '='); }

std::string find_program(std::string_view name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string candidate = (std::filesystem::path(folder) / name).string();
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return {};
}

std::map<std::string, std::string, std::less<>> installed_packages(std::span<const std::string> names) {
  std::string command = "dpkg-query -W -f '${Package} ${Version} ${db:Status-Status}\\n'";
  for (const std::string& name : names) command += " '" + name + "'";
  command += " 2>/dev/null";
  std::map<std::string, std::string, std::less<>> versions;
  const std::unique_ptr<std::FILE, ClosePipe> pipe(popen(command.c_str(), "r"));
  if (!pipe) return versions;
  std::string text;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) text += static_cast<char>(c);
  std::istringstream lines(text);
  for (std::string name, version, status; lines >> name >> version >> status;) {
    if (status == "installed") versions[name] = version;
  }
  return versions;
}

Json environment_json() {
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

#include "tools/program/doctor/machine.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include "sim/mujoco/mujoco_version.h"

namespace slipbench {
namespace {

// The text after `separator` in the first line of a file that begins with `key`, without quotes; "unknown" where there is none.
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

std::string cpu_name() { return value_in_file("/proc/cpuinfo", "model name", ':'); }

std::string operating_system() { return value_in_file("/etc/os-release", "PRETTY_NAME", '='); }

bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

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

#include "tools/workers/python_package/python_package.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/core/process/own_library.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

// "slipbench._export" is slipbench/_export/__main__.py or slipbench/_export.py.
bool has_module(const std::string& folder, std::string name) {
  std::ranges::replace(name, '.', '/');
  std::error_code error;
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  return std::filesystem::exists(path / "__main__.py", error) || std::filesystem::exists(path.string() + ".py", error);
}

bool has_extension(const std::string& folder) {
  std::error_code error;
  std::filesystem::directory_iterator libraries(std::filesystem::path(folder) / "slipbench/bin", error);
  return !error && std::any_of(begin(libraries), end(libraries), [](const auto& entry) {
    return entry.path().filename().string().starts_with("_core.") && entry.path().extension() == ".so";
  });
}

// Null-terminated argument list for exec.
std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

// `owner`: key of an array `value`, whose items have no names.
void check_utf8(const Json& value, const std::string& owner = "") {
  for (const auto& [name, inner] : value.items()) {
    const std::string& key = value.is_array() ? owner : name;
    if (inner.is_structured()) check_utf8(inner, key);
    if (!inner.is_string()) continue;
    const auto& text = inner.get_ref<const std::string&>();
    try {
      static_cast<void>(inner.dump());
    } catch (const Json::type_error&) {
      reject("{}: the name is not UTF-8 ({}), which Python's part of the command needs; rename the file or folder",
             printable(text), key);
    }
  }
}

// Returns the descriptor of a file in memory with this content, which the process that replaces this
// one inherits. An argument of a process could not exceed 128 kB.
int file_of(std::string_view text) {
  const int file = ::memfd_create("slipbench-request", 0);
  while (!text.empty()) {
    const ::ssize_t count = ::write(file, text.data(), text.size());
    if (count < 0 && errno != EINTR) reject("cannot pass the request to Python: {}", std::strerror(errno));
    if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
  }
  return file;
}

}  // namespace

PythonModule::PythonModule(std::string name, std::string purpose, const std::string& extra)
    : name_(std::move(name)), purpose_(std::move(purpose)) {
  const std::string package = extra.empty() ? "slipbench" : fmt::format("'slipbench[{}]'", extra);
  const char* const own = std::getenv("SLIPBENCH_PYTHON");
  program_ = own != nullptr ? own : own_path("../../venv/bin/python3");
  folder_ = own_path(own != nullptr ? "../.." : "../python");
  install_ = own != nullptr ? "pip install " + package : "tools/setup/setup.sh build python test-python";
  const bool is_built = has_extension(folder_);
  if (is_built && has_module(folder_, name_)) return;
  if (is_built)
    reject("{} needs the Python module {}, which is not in {}; use a build of slipbench's source tree, which contains it",
           purpose_, name_, folder_);
  std::error_code error;
  if (std::filesystem::exists(own_path("../CMakeCache.txt"), error))
    reject(
        "{} needs the Python package slipbench, which is not in {}; build it: {}, then cmake --build --preset release --target slipbench_python",
        purpose_, folder_, install_);
  reject(
      "{} needs the Python package slipbench, which is not in {}; use the program slipbench of the package (pip install {}), or of a build of the source tree",
      purpose_, folder_, package);
}

void PythonModule::start(const Json& request) const {
  check_utf8(request);
  std::string path = fmt::format("/proc/self/fd/{}", file_of(request.dump()));
  const char* const others = std::getenv("PYTHONPATH");
  ::setenv("PYTHONPATH", others == nullptr ? folder_.c_str() : (folder_ + ":" + others).c_str(), 1);
  // -P: no package of the user's current folder. -B: no byte code is written into the package.
  std::vector<std::string> all{program_, "-P", "-B", "-m", name_, std::move(path)};
  const std::vector<char*> arguments = pointers_to(all);
  std::fflush(nullptr);
  sigset_t signals, before;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, &before);
  ::execv(program_.c_str(), arguments.data());
  const int reason = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  reject("{}: cannot start {}: {}; install it: {}", purpose_, program_, std::strerror(reason), install_);
}

}  // namespace slipbench

#include "sim/core/process/own_library.h"

#include <dlfcn.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <filesystem>

#include "sim/core/error.h"

namespace slipbench {
namespace {

// The file that this code was loaded from.
std::filesystem::path own_file() {
  static const char here = 0;
  Dl_info info{};
  const std::filesystem::path file = ::dladdr(&here, &info) != 0 ? info.dli_fname : "";
  // Of the program itself the loader knows how it was called, which need not be where it lies.
  return file.extension() == ".so" ? file : std::filesystem::read_symlink("/proc/self/exe");
}

// Restores the handlers of the signals that end the program. Libraries set their own when they are loaded: UCX, which Debian 13's libtorch brings,
// takes SIGHUP for its debugging output, so that a closed terminal would not end a training.
class KeptSignals {
 public:
  KeptSignals() {
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], nullptr, &handlers_[i]);
  }
  ~KeptSignals() {
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &handlers_[i], nullptr);
  }
  KeptSignals(const KeptSignals&) = delete;
  KeptSignals& operator=(const KeptSignals&) = delete;

 private:
  static constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, signals.size()> handlers_{};
};

}  // namespace

std::string own_path(const std::string& path) { return (own_file().parent_path() / path).lexically_normal().string(); }

void* own_symbol(const std::string& path, const std::string& symbol, const std::string& remedy) {
  const std::string file = own_path(path);
  const KeptSignals kept;
  void* const handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw InputError(std::string("cannot load a library: ") + ::dlerror() + "; " + remedy);
  void* const address = ::dlsym(handle, symbol.c_str());
  if (address == nullptr) throw InputError(file + " has no symbol " + symbol + "; " + remedy);
  return address;
}

}  // namespace slipbench

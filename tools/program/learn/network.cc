#include "tools/program/learn/network.h"

#include <filesystem>
#include <mutex>

#include <dlfcn.h>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/program/learn/torch_library.h"

namespace slipbench::learn {
namespace {

// Beside the program, in the build as in a prefix.
std::filesystem::path library_path() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / SLIPBENCH_TORCH).lexically_normal();
}

// Loaded once and never unloaded: libtorch does not survive that.
MakeNetwork* load() {
  const std::filesystem::path path = library_path();
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    throw InputError(fmt::format(
        "there is no library of networks {}: this slipbench was built without libtorch, or cannot load it; allowed: build it with the package libtorch-dev, which tools/setup/setup.sh test installs",
        path.string()));
  }
  void* const symbol = ::dlsym(handle, make_symbol);
  if (symbol == nullptr) throw InputError(fmt::format("{} has no symbol {}", path.string(), make_symbol));
  return reinterpret_cast<MakeNetwork*>(symbol);  // as POSIX has it
}

}  // namespace

std::size_t parameter_count(const NetworkShape& shape) {
  const std::size_t d = shape.dim;
  const auto layer = [&](std::size_t inputs) {
    switch (shape.architecture) {
      case Architecture::mlp: return d * (inputs + 1);
      case Architecture::tcn: return d * (shape.kernel * inputs + 1);
      case Architecture::gru: return 3 * d * (inputs + d + 2);
    }
    return std::size_t{0};
  };
  return layer(shape.inputs) + (shape.layers - 1) * layer(d) + 2 * d + 2;
}

std::unique_ptr<Network> make_network(const NetworkShape& shape, std::uint64_t seed) {
  static std::mutex mutex;
  static MakeNetwork* make = nullptr;
  {
    const std::lock_guard lock(mutex);
    if (make == nullptr) make = load();
  }
  return std::unique_ptr<Network>(make(shape, seed));
}

bool networks_available() { return std::filesystem::exists(library_path()); }

}  // namespace slipbench::learn

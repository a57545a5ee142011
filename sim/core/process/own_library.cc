#include "sim/core/process/own_library.h"

#include <dlfcn.h>

#include <filesystem>

#include "sim/core/error.h"

namespace slipbench {
namespace {

// The file that this code was loaded from.
std::filesystem::path own_file() {
  static const char here = 0;
  Dl_info info{};
  const std::filesystem::path file = ::dladdr(&here, &info) != 0 ? info.dli_fname : "";
  // For the program itself the loader knows only how it was called, which may differ from its
  // location.
  return file.extension() == ".so" ? file : std::filesystem::read_symlink("/proc/self/exe");
}

}  // namespace

std::string own_path(const std::string& path) { return (own_file().parent_path() / path).lexically_normal().string(); }

void* own_symbol(const std::string& path, const std::string& symbol, const std::string& remedy) {
  const std::string file = own_path(path);
  void* const handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw InputError(std::string("cannot load a library: ") + ::dlerror() + "; " + remedy);
  void* const address = ::dlsym(handle, symbol.c_str());
  if (address == nullptr) throw InputError(file + " has no symbol " + symbol + "; " + remedy);
  return address;
}

}  // namespace slipbench

#include "tools/python/module.h"

#include <dlfcn.h>
#include <link.h>
#include <math.h>
#include <sys/mman.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <exception>
#include <map>
#include <span>
#include <string_view>
#include <system_error>

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "tools/program/plugin/plugin_builds.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

using Functions = std::map<std::string_view, void*>;

template <class Function>
void* address(Function* function) {
  return reinterpret_cast<void*>(function);
}

// What the three call and IEEE 754 does not round.
Functions own_functions() {
  using Of1 = double(double);
  using Of2 = double(double, double);
  return {{"acos", address<Of1>(acos)}, {"asin", address<Of1>(asin)}, {"atan2", address<Of2>(atan2)}, {"atan2f", address(atan2f)},
          {"cbrt", address<Of1>(cbrt)}, {"cos", address<Of1>(cos)},   {"cosf", address(cosf)},        {"exp", address<Of1>(exp)},
          {"log", address<Of1>(log)},   {"log10f", address(log10f)},  {"pow", address<Of2>(pow)},     {"powf", address(powf)},
          {"sin", address<Of1>(sin)},   {"sincos", address(sincos)},  {"sinf", address(sinf)},        {"tan", address<Of1>(tan)}};
}

void give(const link_map& library, const Functions& functions) {
  std::map<ElfW(Sxword), ElfW(Addr)> dynamic;
  for (const ElfW(Dyn)* entry = library.l_ld; entry->d_tag != DT_NULL; ++entry) dynamic[entry->d_tag] = entry->d_un.d_ptr;
  if (!dynamic.contains(DT_JMPREL)) return;  // calls nothing by a table
  const auto* const names = std::bit_cast<const char*>(dynamic.at(DT_STRTAB));
  const auto* const symbols = std::bit_cast<const ElfW(Sym)*>(dynamic.at(DT_SYMTAB));
  const std::span calls(std::bit_cast<const ElfW(Rela)*>(dynamic.at(DT_JMPREL)), dynamic.at(DT_PLTRELSZ) / sizeof(ElfW(Rela)));
  const auto page = static_cast<ElfW(Addr)>(::sysconf(_SC_PAGESIZE));
  for (const auto& call : calls) {
    const auto function = functions.find(names + symbols[ELF64_R_SYM(call.r_info)].st_name);
    if (function == functions.end()) continue;
    const ElfW(Addr) place = library.l_addr + call.r_offset;
    // The page stays writable, since other data may lie on it.
    if (::mprotect(std::bit_cast<void*>(place / page * page), page, PROT_READ | PROT_WRITE) != 0)
      throw std::system_error(errno, std::generic_category(), library.l_name);
    *std::bit_cast<void**>(place) = function->second;
  }
}

// Makes the loaded MuJoCo, FFTW and NLopt call the functions of libm that this code is linked with (sim/core/CMakeLists.txt). In a program they do
// so by themselves, since its own precede libm's; in a library that another program has loaded, as Python's module is, libm's come first.
// Throws std::system_error where the tables of calls cannot be written.
void give_own_libm() {
  const Functions functions = own_functions();
  link_map* library = nullptr;
  if (::dlinfo(::dlopen(nullptr, RTLD_LAZY), RTLD_DI_LINKMAP, &library) != 0)
    throw std::system_error(errno, std::generic_category(), ::dlerror());
  for (; library != nullptr; library = library->l_next) {
    const std::string_view path = library->l_name;
    const std::string_view name = path.substr(path.rfind('/') + 1);
    if (name.starts_with("libmujoco") || name.starts_with("libfftw3") || name.starts_with("libnlopt")) give(*library, functions);
  }
}

}  // namespace
}  // namespace slipbench::python

std::vector<slipbench::Override> slipbench::python::overrides_of(const Pairs& pairs) {
  std::vector<Override> overrides;
  for (const auto& [path, value] : pairs) overrides.push_back({path, value});
  return overrides;
}

// The extension `_core`: what the package `slipbench` is made of, which documents it.
NB_MODULE(_core, module) {
  slipbench::python::give_own_libm();
  nb::set_leak_warnings(false);  // detectors that a user registers live as long as the process
  nb::exception<slipbench::InputError>(module, "InputError", PyExc_ValueError).attr("__doc__") =
      "Bad input, a ValueError, with the program's own message: file:line, what was found, what is allowed.";
  nb::register_exception_translator([](const std::exception_ptr& error, void*) {
    try {
      std::rethrow_exception(error);
    } catch (const slipbench::Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
  module.attr("version") = SLIPBENCH_VERSION;
  module.def("plugin_versions", &slipbench::plugin_versions);
  module.def("plugin_build", [](const std::string& version) {
    std::string build = slipbench::plugin_build(version);
    if (!build.empty()) return build;
    throw slipbench::InputError("MuJoCo " + version +
                                " has no build of the plugin; allowed: " + slipbench::plugin_versions_text(version));
  });
  slipbench::python::bind_trial(module);
  slipbench::python::bind_own_parts(module);
  slipbench::python::bind_scene(module);
  slipbench::python::bind_environments(module);
}

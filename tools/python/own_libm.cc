#include "tools/python/own_libm.h"

#include <dlfcn.h>
#include <link.h>
#include <math.h>
#include <sys/mman.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <map>
#include <span>
#include <string_view>
#include <system_error>

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

}  // namespace

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

}  // namespace slipbench::python

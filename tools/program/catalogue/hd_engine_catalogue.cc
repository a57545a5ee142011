#include "tools/program/catalogue/hd_engine_catalogue.h"

#include "rtl/verilated/rtl_engine.h"
#include "sim/core/error.h"

namespace slipbench {
namespace {

struct EngineKind {
  const char* name;
  std::unique_ptr<hd::Engine> (*create)(const hd::Model& model, const hd::Memories& memories);
};

// The core that is fastest to simulate; all unrollings decide alike.
std::unique_ptr<hd::Engine> make_rtl(const hd::Model& model, const hd::Memories& memories) {
  return hd::make_rtl_engine(model, memories, {.unrolling = hd::Unrolling::smallest});
}

// All engines, one line each.
constexpr EngineKind engine_catalogue[] = {
    {"kernel", hd::make_kernel},
    {"reference", hd::make_reference},
    {"rtl", make_rtl},
};

}  // namespace

std::vector<std::string> hd_engine_names() {
  std::vector<std::string> names;
  for (const EngineKind& kind : engine_catalogue) names.emplace_back(kind.name);
  return names;
}

std::unique_ptr<hd::Engine> make_hd_engine(std::string_view name, const hd::Model& model, const hd::Memories& memories) {
  for (const EngineKind& kind : engine_catalogue) {
    if (kind.name == name) return kind.create(model, memories);
  }
  throw InputError("unknown engine " + quote(name) + allowed_names(name, hd_engine_names()));
}

}  // namespace slipbench

#include "rtl/verilated/core.h"

#include <stdexcept>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"

namespace slipbench::hd {
namespace {

struct Timing {
  unsigned slices;
  unsigned groups;  // of pillars
};

Timing timing(Unrolling unrolling) {
  switch (unrolling) {
    case Unrolling::fastest: return {1, 1};
    case Unrolling::middle: return {4, 3};
    case Unrolling::smallest: return {20, 9};
  }
  throw std::logic_error("rtl core: no such unrolling");
}

}  // namespace

unsigned core_latency(Unrolling unrolling) {
  const Timing t = timing(unrolling);
  return t.groups + t.slices + 8;
}

unsigned core_interval(Unrolling unrolling) {
  const Timing t = timing(unrolling);
  return t.groups > t.slices ? t.groups : t.slices;
}

std::unique_ptr<Core> make_core(Unrolling unrolling, const Model& model, const Memories& memories) {
  if (model.dimension != core_dimension || model.window != core_window) {
    throw InputError("rtl core: dimension " + std::to_string(model.dimension) + " and window " + std::to_string(model.window) +
                     "; the core is built for " + std::to_string(core_dimension) + " and " + std::to_string(core_window));
  }
  if (model.encoding != Encoding::graph_spatial_temporal || model.compat != Compat::paper) {
    throw InputError("rtl core: it is built for encoding graph_spatial_temporal and compat paper only");
  }
  check(model, memories, true);
  Memories loaded = memories;
  if (!model.context_driven) {
    Hypervector ones(core_dimension);
    for (std::size_t i = 0; i < core_dimension; ++i) ones.set(i, true);
    loaded.context.assign(context_count, ones);
  }
  static MakeVerilatedCore* const make =
      reinterpret_cast<MakeVerilatedCore*>(own_symbol(SLIPBENCH_CORES, make_core_symbol, "build the target slipbench_cores"));
  return std::unique_ptr<Core>(make(unrolling, model, loaded));
}

}  // namespace slipbench::hd

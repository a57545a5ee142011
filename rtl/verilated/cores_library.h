// What the library of the translated cores exports. It is loaded when a core is made: Verilator's models take a sixth of the time to build the
// program, and most scenes need none.
#pragma once

#include "rtl/verilated/core.h"

namespace slipbench::hd {

inline constexpr const char* make_core_symbol = "slipbench_make_verilated_core";

// A core after its reset. `model` and `memories` as make_core has checked them, contexts given. The caller owns it.
using MakeVerilatedCore = Core*(Unrolling unrolling, const Model& model, const Memories& memories);

}  // namespace slipbench::hd

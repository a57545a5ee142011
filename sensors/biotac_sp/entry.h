// What the catalogue says of the BioTac SP.
#pragma once

#include <vector>

#include "sim/core/parameters.h"

namespace slipbench::biotac_sp {

Entry about();
// The parts of its electronics. `gain` and `offset` are those of the electrodes' sensitivity and of their impedance at rest.
std::vector<Entry> electronics_parts();

}  // namespace slipbench::biotac_sp

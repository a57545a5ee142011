// The Python of rerun.cc, inside the program.
#pragma once

#include <vector>

#include "tools/base/page/asset.h"

namespace slipbench::view {

const std::vector<page::Asset>& assets();

}  // namespace slipbench::view

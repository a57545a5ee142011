// The files of web/, as bytes inside the program. Written by slipbench_embed().
#pragma once

#include <vector>

#include "tools/base/page/asset.h"

namespace slipbench::report {

// In the order in which the page loads them.
const std::vector<page::Asset>& assets();

}  // namespace slipbench::report

// The files of web/, as bytes inside the program. Written by tools/program/report/embed.cmake.
#pragma once

#include <vector>

#include "tools/program/report/assets.h"

namespace slipbench::cost {

// All embedded files, in the order in which the page loads them.
const std::vector<report::Asset>& assets();

}  // namespace slipbench::cost

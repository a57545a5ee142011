// The files of web/ and the JavaScript libraries, as bytes inside the program. Written by embed.cmake.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace slipbench::report {

struct Asset {
  std::string_view name;  // file name without its folder: "charts.js"
  std::string_view text;
};

// All embedded files, in the order in which the page loads them.
const std::vector<Asset>& assets();

}  // namespace slipbench::report

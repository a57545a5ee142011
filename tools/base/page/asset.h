// Files as bytes inside the program, which so needs none beside it. slipbench_embed() of embed.cmake makes them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slipbench::page {

struct Asset {
  std::string_view name;  // file name without its folder: "charts.js"
  std::string_view text;
};

// The files of tools/base/page/web and d3, in the order in which a page loads them.
const std::vector<Asset>& assets();

// The text of the file `name`, of a library without its pointer to a source map, which a browser would fetch. Throws std::logic_error where
// `files` has none of that name.
std::string_view embedded(const std::vector<Asset>& files, std::string_view name);

// The texts of all files whose names end in `extension`, in order, a line end after each. A script that is no library's (.min.js) has a scope of
// its own, in which `sb` is what all of them share: `slipbench` of the page.
std::string joined(const std::vector<Asset>& files, std::string_view extension);

}  // namespace slipbench::page

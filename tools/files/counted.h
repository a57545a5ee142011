// Formats counts in messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace slipbench {

// "1 file", "2 files". `what`: singular of a word whose plural ends in s.
inline std::string counted(std::size_t count, std::string_view what) {
  return std::to_string(count) + ' ' + std::string(what) + (count == 1 ? "" : "s");
}

}  // namespace slipbench

// Formats counts in messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace slipbench {

// "1 file", "2 files". `what`: singular of a word whose plural ends in s, also "entry" and "key".
inline std::string counted(std::size_t count, std::string_view what) {
  std::string text = std::to_string(count) + ' ';
  if (count == 1) return text.append(what);
  if (what.ends_with('y') && !what.ends_with("ey")) return text.append(what.substr(0, what.size() - 1)).append("ies");
  return text.append(what) + 's';
}

}  // namespace slipbench

#include "sim/core/error.h"

#include <array>
#include <cstdio>
#include <numeric>
#include <vector>

namespace slipbench {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // One row of the dynamic programme: row[j] is the distance between a's first i and b's first j
  // characters.
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row[b.size()];
}

std::string printable(std::string_view text, bool lines) {
  std::string result;
  const auto escape = [&result](unsigned char byte) {
    std::array<char, 5> digits{};
    std::snprintf(digits.data(), digits.size(), "\\x%02x", byte);
    result += digits.data();
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    // U+0080 to U+009F: some terminals obey them
    if (byte == 0xc2 && next >= 0x80 && next <= 0x9f) {
      escape(byte);
      escape(next);
      ++i;
    } else if ((byte < 0x20 && !(lines && byte == '\n')) || byte == 0x7f) {
      escape(byte);
    } else {
      result += text[i];
    }
  }
  return result;
}

std::string quote(std::string_view text) {
  constexpr std::size_t longest = 60;
  return "'" + printable(text.substr(0, longest)) + (text.size() > longest ? "...'" : "'");
}

}  // namespace slipbench

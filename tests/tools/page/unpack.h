// An independent copy of the decoding in the report's web/data.js.
#pragma once

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <zlib.h>

#include "tools/dataset/record/json.h"

namespace slipbench::page {

inline std::vector<std::uint8_t> decode_base64(const std::string& text) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = (bits << 6U) | static_cast<std::uint32_t>(alphabet.find(c));
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<std::uint8_t>((bits >> static_cast<unsigned>(count -= 8)) & 0xFFU));
  }
  return bytes;
}

// A packed array as columns of numbers; NaN where it holds none.
inline std::vector<std::vector<double>> unpack(const Json& packed) {
  const auto rows = packed.at("rows").get<std::size_t>();
  const auto columns = packed.at("columns").get<std::size_t>();
  const auto codec = packed.at("codec").get<std::string>();
  const std::size_t width = codec == "bytes" ? 1 : codec == "delta16" ? 2 : 4;
  const std::size_t count = rows * columns;
  const std::vector<std::uint8_t> deflated = decode_base64(packed.at("data").get<std::string>());
  std::vector<std::uint8_t> bytes(width * count);
  uLongf size = bytes.size();
  if (uncompress(bytes.data(), &size, deflated.data(), deflated.size()) != Z_OK || size != bytes.size()) {
    throw std::runtime_error("the packed array does not inflate to its extents");
  }
  std::vector<std::vector<double>> result(columns, std::vector<double>(rows));
  for (std::size_t column = 0; column < columns; ++column) {
    std::uint32_t code = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint32_t value = 0;
      for (std::size_t k = 0; k < width; ++k)
        value |= static_cast<std::uint32_t>(bytes[k * count + column * rows + row]) << (8U * k);
      code = width == 1 ? value : code + value;
      double& out = result[column][row];
      if (codec == "bytes") {
        out = code;
      } else if (codec == "delta16") {
        const auto number = static_cast<std::int16_t>(code & 0xFFFFU);
        out = number == -32768 ? std::numeric_limits<double>::quiet_NaN() : number * packed.at("step").get<double>();
      } else {
        out = static_cast<std::int32_t>(code) * packed.at("step").get<double>();
      }
    }
  }
  return result;
}

}  // namespace slipbench::page

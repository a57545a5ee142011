#include "tools/base/page/pack.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <zlib.h>

namespace slipbench::page {
namespace {

constexpr std::uint16_t not_finite = 0x8000;  // -32768, the one code that no value uses
constexpr double finest_time = 1e-6;          // s
constexpr double largest_code = 2147483647.0;

std::string deflate_base64(const std::vector<std::uint8_t>& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 6) != Z_OK) {
    throw std::runtime_error("zlib could not compress an array of the report");
  }
  packed.resize(size);
  return base64(packed);
}

Json packed(const char* codec, std::size_t rows, std::size_t columns, const std::vector<std::uint8_t>& bytes) {
  return {{"codec", codec}, {"rows", rows}, {"columns", columns}, {"data", deflate_base64(bytes)}};
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = (group << 8U) | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? alphabet[(group >> (18U - 6U * k)) & 63U] : '=';
  }
  return text;
}

Json pack_curves(std::span<const float> values, std::size_t columns, std::size_t stride) {
  const std::size_t all_rows = values.size() / columns;
  const std::size_t rows = (all_rows + stride - 1) / stride;
  double largest = 0.0;
  for (const float value : values) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(static_cast<double>(value)));
  }
  const double step = largest > 0.0 ? largest / 32767.0 : 1.0;
  std::vector<std::uint8_t> bytes(2 * rows * columns);
  std::uint8_t* const low = bytes.data();
  std::uint8_t* const high = low + rows * columns;
  for (std::size_t column = 0; column < columns; ++column) {
    std::uint16_t previous = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      const float value = values[row * stride * columns + column];
      const std::uint16_t code =
          std::isfinite(value) ? static_cast<std::uint16_t>(static_cast<std::int32_t>(std::lround(value / step))) : not_finite;
      const auto difference = static_cast<std::uint16_t>(code - previous);
      low[column * rows + row] = static_cast<std::uint8_t>(difference & 0xFFU);
      high[column * rows + row] = static_cast<std::uint8_t>(difference >> 8U);
      previous = code;
    }
  }
  Json result = packed("delta16", rows, columns, bytes);
  result["step"] = step;
  return result;
}

Json pack_bytes(std::span<const std::uint8_t> values, std::size_t columns) {
  const std::size_t rows = values.size() / columns;
  std::vector<std::uint8_t> bytes(values.size());
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) bytes[column * rows + row] = values[row * columns + column];
  }
  return packed("bytes", rows, columns, bytes);
}

Json pack_times(std::span<const double> times) {
  std::vector<std::uint8_t> bytes(4 * times.size());
  double latest = 0.0;
  for (const double time : times) latest = std::max(latest, std::abs(time));
  const double step = std::max(finest_time, latest / largest_code);
  std::uint32_t previous = 0;
  for (std::size_t row = 0; row < times.size(); ++row) {
    const auto code = static_cast<std::uint32_t>(std::lround(times[row] / step));
    const std::uint32_t difference = code - previous;
    for (std::size_t k = 0; k < 4; ++k) {
      bytes[k * times.size() + row] = static_cast<std::uint8_t>((difference >> (8U * k)) & 0xFFU);
    }
    previous = code;
  }
  Json result = packed("delta32", times.size(), 1, bytes);
  result["step"] = step;
  return result;
}

}  // namespace slipbench::page

// Arrays made small enough to sit inside a page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "tools/base/record/json.h"

namespace slipbench::page {

// Standard base64 (RFC 4648) with padding.
std::string base64(std::span<const std::uint8_t> bytes);

// Packs `values` [rows, columns] (C order) for tools/program/report/web/data.js: column-major; each value as a 16 bit multiple of a step that is
// 1/32767 of the largest magnitude; differences along a column; low bytes, then high bytes; zlib; base64. A value that is not
// finite becomes NaN. Only every `stride`-th row is kept, from row 0.
// Returns {"codec": "delta16", "rows", "columns", "step", "data"}.
Json pack_curves(std::span<const float> values, std::size_t columns, std::size_t stride);

// Packs bytes [rows, columns] without loss, column-major. Returns {"codec": "bytes", "rows", "columns", "data"}.
Json pack_bytes(std::span<const std::uint8_t> values, std::size_t columns);

// Packs finite times [s] as signed 32 bit multiples of a step: 1 us up to 2147 s, for longer times the finest that reaches them.
// Returns {"codec": "delta32", "rows", "columns": 1, "step", "data"}.
Json pack_times(std::span<const double> times);

}  // namespace slipbench::page

// The arrays of a trial under the names that they have in a dataset.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/encoder.h"
#include "tools/base/record/layout.h"

namespace slipbench {

// A column of a record and where it goes. It looks into the record.
struct ArrayView {
  std::string path;        // inside the demo: "labels/pad/state"
  std::string unit;        // SI symbol, "1" for a pure number
  std::string_view codes;  // of JSON, what its numbers stand for; empty: they are quantities
  ElementType type = ElementType::f32;
  Extents shape;                        // a row a sample first
  const std::uint8_t* bytes = nullptr;  // little-endian values in C order

  [[nodiscard]] std::size_t row_bytes() const {
    std::size_t size = size_of(type);
    for (std::size_t axis = 1; axis < shape.size(); ++axis) size *= shape[axis];
    return size;
  }
  [[nodiscard]] std::size_t size_bytes() const { return shape[0] * row_bytes(); }
};

// All arrays of a trial in ascending order of path. Throws std::logic_error when a column's length does not fit the number of
// samples.
std::vector<ArrayView> arrays_of(const TrialRecord& record);

}  // namespace slipbench

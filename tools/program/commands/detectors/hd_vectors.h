// Quantised input for the hyperdimensional classifier, as a CSV file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "detectors/hd/features.h"

namespace slipbench {

struct HdVector {
  std::uint64_t step;
  hd::Frame frame;
};

// Reads the columns n (step), L0 to L8 (levels) and ctx (context), wherever they stand; other columns are left alone. Throws InputError
// with file and line: a column that is missing or there twice, a row with too few or too many cells, a level beyond 20 or a context
// beyond 3, a step that does not follow the one before.
std::vector<HdVector> read_hd_vectors(const std::string& file);

}  // namespace slipbench

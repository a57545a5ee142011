// Numbers from 0 to 1 that say how likely something is: what a threshold on them does, and whether they are true.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slipbench {

// What a threshold does: the shares of negatives and of positives whose value is at least that.
struct RocPoint {
  double threshold = 0.0;
  double false_share = 0.0, true_share = 0.0;
};

// The receiver operating curve from (0, 0), whose threshold is inf, to (1, 1): a point at each value that occurs, falling. Of more than
// `most` points those at equal distances are kept, the first and the last among them. Throws std::invalid_argument where a class is
// empty, a value is no number, or `most` is less than two.
std::vector<RocPoint> roc_curve(std::span<const double> positives, std::span<const double> negatives, std::size_t most);

// Values of one of equal parts of [0, 1].
struct CalibrationBin {
  double low = 0.0, high = 0.0;  // the last one holds its end too
  std::size_t count = 0;         // values in it
  double mean = 0.0;             // of these values: what was said
  double share = 0.0;            // of positives among them: what was true
};

// The parts that hold values, ascending. Throws std::invalid_argument for a value outside [0, 1] and for no parts.
std::vector<CalibrationBin> calibration(std::span<const double> positives, std::span<const double> negatives, std::size_t parts);

}  // namespace slipbench

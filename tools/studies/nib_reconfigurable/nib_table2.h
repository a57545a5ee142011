// What Algorithm 1 makes of the slow releases of Table II of the nib pad's paper.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "tools/base/statistics/descriptive.h"

namespace slipbench::reproduce {

// What one run came to with one reading. NaN: nothing was detected before the slip was over.
struct ReleaseRun {
  std::string material;
  double required = 0.0;                                    // N, pull/mu_s
  double force = std::numeric_limits<double>::quiet_NaN();  // N, true, at the detection
  double way = std::numeric_limits<double>::quiet_NaN();    // m, slip at the detection

  [[nodiscard]] bool safe() const { return way < 6e-3; }  // a success in the paper
  [[nodiscard]] bool gross() const { return safe() && force < required; }
};

struct ReleaseSummary {
  std::size_t runs = 0, safe = 0, early = 0;
  MeanSd error, gross_error, slip;  // N, N, mm; of the safe ones
};
// Of the runs on a material; of all where it is empty.
ReleaseSummary summary_of(const std::vector<ReleaseRun>& runs, const std::string& material);

}  // namespace slipbench::reproduce

// What Table II of the nib pad's paper simulates, slow releases of the grasp, and what Algorithm 1 makes of them.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/core/parameters.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/studies/grid.h"
#include "tools/studies/nib_reconfigurable/nib_signature.h"

namespace slipbench::reproduce {

inline constexpr const char* release_scene = "scenes/nib_pad/release.yaml";
inline constexpr std::size_t few_draws = 2;  // trials a cell at most, of every law but the scene's own

// A change of the detector, on the very same trials.
struct DetectorReading {
  const char* name;
  const char* text;
  std::vector<std::pair<const char*, Parameters::Value>> changes;
};
// The scene's own first.
const std::vector<DetectorReading>& detector_readings();

// What one run came to with one reading. NaN: nothing was detected before the slip was over.
struct ReleaseRun {
  std::string material;
  double required = 0.0;                                    // N, pull/mu_s
  double force = std::numeric_limits<double>::quiet_NaN();  // N, true, at the detection
  double way = std::numeric_limits<double>::quiet_NaN();    // m, slip at the detection

  [[nodiscard]] bool safe() const { return way < 6e-3; }  // a success in the paper
  [[nodiscard]] bool gross() const { return safe() && force < required; }
};

// All trials under one law.
struct LawRuns {
  std::vector<std::vector<ReleaseRun>> by_reading;   // in the order of detector_readings()
  std::vector<std::optional<Signature>> signatures;  // of each trial
};

// `draws` trials of each cell of the scene's sweep: of each of friction_laws(). Throws InputError and Interrupted as run_grid
// does.
std::vector<LawRuns> run_releases(std::size_t draws, const ReproduceOptions& options);

struct ReleaseSummary {
  std::size_t runs = 0, safe = 0, early = 0;
  MeanSd error, gross_error, slip;  // N, N, mm; of the safe ones
};
// Of the runs on a material; of all where it is empty.
ReleaseSummary summary_of(const std::vector<ReleaseRun>& runs, const std::string& material);

}  // namespace slipbench::reproduce

// What is to be fitted: a key of the scene and where its value may lie.
#pragma once

#include <string>
#include <vector>

#include "sim/core/quantity.h"
#include "sim/scene/parser.h"
#include "tools/base/record/json.h"

namespace slipbench::calibrate {

// The recordings' clock against the scene's: the one key that is none of the scene.
inline constexpr const char* lag_key = "lag";

struct FitKey {
  std::string path;                    // "motion.tilt.0"
  double min = 0.0, max = 1.0;         // SI, min < max
  bool logarithmic = false;            // draw: log_uniform, so min is above 0
  bool each = false;                   // every recording has a value of its own
  Quantity quantity = Quantity::none;  // as the units of the bounds tell

  // The value at `place`, 0 at min and 1 at max; and the place of a value, which may lie outside.
  [[nodiscard]] double value(double place) const;
  [[nodiscard]] double place(double value) const;
  // A value of this key with its unit.
  [[nodiscard]] std::string text(double value, int digits = 4) const;
};

// Reads "KEY: {min: .., max: .., draw: uniform or log_uniform, each: true or false}", a YAML map of one key or several; draw and each may be left
// out. Throws InputError: what was found, what is allowed.
std::vector<FitKey> parse_fit_keys(const std::string& text);

// The scene file with what was fitted in it.

// YAML: at its head what was fitted and how well it is known, then `file` with the values of `result` (calibrate.h) in it. A key of every
// recording is drawn by the sweep, with the centre and scatter that were found.
std::string fitted_scene(const SceneFile& file, const std::vector<FitKey>& keys, const Json& result);

}  // namespace slipbench::calibrate

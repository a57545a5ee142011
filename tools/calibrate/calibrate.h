// A scene fitted to recordings: `slipbench calibrate`.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/calibrate/groups.h"
#include "tools/calibrate/model.h"
#include "tools/dataset/record/json.h"

namespace slipbench {
struct ImportFormat;
}

namespace slipbench::calibrate {

struct Options {
  std::string scene_path;
  std::vector<Override> overrides;
  std::vector<FitKey> keys;             // at least one
  std::vector<std::string> recordings;  // datasets, or sources of `format`
  const ImportFormat* format = nullptr;
  std::optional<Groups> groups;  // compares groups of recordings with unknown motion; empty: compares curves in time
  bool synthetic_truth = false;  // recordings are simulated from parameters drawn between the bounds, in place of `recordings`
  std::optional<std::uint64_t> seed;  // empty: the scene's
  std::size_t starts = 4;
  std::size_t jobs = 1;  // threads; results are bit-identical
  std::string command;   // as written into the result
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(std::size_t done, std::size_t total)> progress;  // recordings simulated; may be empty
};

// The first key of a result.
inline constexpr const char* result_key = "slipbench_calibration";

struct Result {
  Json json;           // parameters, intervals, residuals, curves: README.md
  std::string fitted;  // the scene with the fitted values, YAML
};

// Throws InputError for a scene, a key or recordings that cannot be used, and Interrupted.
Result calibrate(const Options& options, const Catalogues& catalogues);

// For a synthetic truth: true if every parameter that is called determined is within twice its 95 %
// interval of the drawn value.
bool recovers(const Json& result);

}  // namespace slipbench::calibrate

// A dataset as robomimic reads it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/dataset/reader.h"
#include "tools/program/export/export.h"

namespace slipbench {

struct RobomimicOptions {
  std::vector<std::string> sensors;  // to observe; empty: all
  std::optional<double> rate;        // Hz, of the demos; empty: that of the slowest sensor
  std::optional<SlipRule> rule;      // of the states beside the observations; empty: all three
  bool compress = false;             // every array by shuffle and deflate
  std::function<void(std::size_t done, std::uintmax_t bytes)> progress = {};  // told of the demos written, and of the file's size
};

// Writes the trials as one HDF5 file in robomimic's layout (README.md) under a temporary name, syncs and renames it. The same dataset gives
// the same bytes. Throws InputError when a trial does not fit: no such sensor, a rate beyond the fastest sensor's, fewer than two rows, a
// grasp without a loop, nothing that moves; or when the file cannot be written, of which nothing is left then, or another run is writing it,
// which is left to that run. Every trial has a recording.
void write_robomimic(const DatasetReader& reader, const std::vector<std::size_t>& trials, const std::string& path,
                     const RobomimicOptions& options);

// Throws InputError when something stands at `path`, or at its temporary name, that is neither empty nor such a file.
void check_robomimic_target(const std::string& path, const std::vector<std::string>& inputs);

}  // namespace slipbench

// What a dataset says of itself, and the names of its files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "tools/base/dataset/mask.h"

namespace slipbench {

inline constexpr std::int64_t dataset_schema = 1;

// A file lists no more demos, so that the list stays one block of HDF5, which can be rewritten at one go (shard.h).
inline constexpr std::size_t most_trials_per_file = 2000;

// Attributes of the root group.
struct DatasetHeader {
  std::string version;           // of the program
  std::string scene;             // text of the scene file
  std::string overrides = "{}";  // JSON object: path -> YAML text given with --set
  std::uint64_t seed = 0;
  std::string command;                  // canonical: without --jobs and -o, which do not change what is written
  std::optional<SplitRule> split = {};  // of the scene, which says it; not read back
};

// Whether two files that say so are files of the same dataset.
inline bool same_dataset(const DatasetHeader& a, const DatasetHeader& b) {
  return a.seed == b.seed && a.command == b.command && a.scene == b.scene;
}

// Name of the k-th file of a dataset: OUT.h5, OUT-0001.h5, OUT-0002.h5, ...
std::string shard_path(const std::string& path, std::size_t shard);
// Where an interrupted run leaves the trials it finished: OUT.partial.h5.
std::string kept_path(const std::string& path);
// Where a running one writes: OUT.h5.partial.
std::string temporary_path(const std::string& path);

}  // namespace slipbench

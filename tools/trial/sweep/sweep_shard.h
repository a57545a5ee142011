// Selects the trials of a shard of a sweep.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Numbers of the trials of shard `number` (from 1) of `count`, ascending. Every machine computes
// the same from the scene and the seed: the first `trials` of the plan are ordered by cost, the
// most expensive first and equal ones in an order drawn from the seed, and dealt to the shards in
// turn. Cost: ticks times elements of the first draw of the trial's cell; equal for all if the
// sweep sets neither the duration, the step, the fidelity nor the sensors, and in a sweep of more
// than 10,000 cells. Throws InputError if there are fewer trials than shards.
std::vector<std::size_t> trials_of_shard(const TrialPlan& plan, std::size_t trials, std::uint64_t seed, std::size_t number,
                                         std::size_t count);

// Adds the paths that the scene names: its model, and parameters of type path that are not at their
// default. A model's own includes and meshes are not included.
void add_named_files(const Scene& scene, const Catalogues& catalogues, std::set<std::string>& paths);

// Files that several trials read and that must not change between trials.
class HeldFiles {
 public:
  // A folder means its files. Throws InputError for an unreadable file.
  explicit HeldFiles(const std::set<std::string>& paths);

  // SHA-256 as 64 hexadecimal digits, by path.
  [[nodiscard]] const std::map<std::string, std::string>& digests() const { return digests_; }
  // Throws InputError if a file has changed. Reads only files that were written or replaced.
  // Thread-safe.
  void check() const;

 private:
  using Stamp = std::array<std::int64_t, 5>;  // device, inode, size, modification time and change time in ns
  static Stamp stamp_of(const std::string& path);

  std::map<std::string, std::string> digests_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, Stamp> stamps_;  // guarded by mutex_; updated if a file is rewritten with the same content
};

}  // namespace slipbench

// Which trials of a sweep a shard has.
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

// Numbers of the trials of shard `number` (from 1 on) of `count`, ascending. Every machine computes the same from the scene and the seed:
// the first `trials` of the plan are ordered by what they cost, the costliest first, equal ones in an order drawn from the seed, and dealt out in
// turn. Cost: ticks times elements of the first draw of the trial's cell; equal for all where the sweep sets neither the duration, the step, the
// fidelity nor the sensors, and in a sweep of more than 10,000 cells. Throws InputError where there are fewer trials than shards.
std::vector<std::size_t> trials_of_shard(const TrialPlan& plan, std::size_t trials, std::uint64_t seed, std::size_t number,
                                         std::size_t count);

// Adds the paths that the scene names: its model, and parameters of type path that are not at their default. A model's own
// includes and meshes are not among them.
void add_named_files(const Scene& scene, const Catalogues& catalogues, std::set<std::string>& paths);

// Files that are read by trial after trial, and must be for all what they were for the first.
class HeldFiles {
 public:
  // A folder stands for the files in it. Throws InputError for what cannot be read.
  explicit HeldFiles(const std::set<std::string>& paths);

  // SHA-256 as 64 hexadecimal digits, by path.
  [[nodiscard]] const std::map<std::string, std::string>& digests() const { return digests_; }
  // Throws InputError where a file holds something else by now. Looks into those alone that have been written or replaced. For any thread.
  void check() const;

 private:
  using Stamp = std::array<std::int64_t, 5>;  // device, inode, size, time of its content and of itself in ns
  static Stamp stamp_of(const std::string& path);

  std::map<std::string, std::string> digests_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, Stamp>
      stamps_;  // under mutex_; that of a file written anew with the same content takes the place of the old one
};

}  // namespace slipbench

// A folder from which other machines run a sweep: scripts for Slurm and Snakemake that a person can read.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

struct ClusterOptions {
  SweepOptions sweep;        // what decides the trials' bytes, and `jobs` of each shard (0: 1)
  std::string folder;        // new, or empty
  std::size_t shards = 0;    // n
  std::size_t throttle = 0;  // most Slurm tasks at a time; 0: all of them
};

// Writes the folder and returns its files' names. The scripts start this program, in this working directory, under the names that both have now.
// Throws InputError for a scene that cannot be swept, for more shards than it has trials, and where the folder holds something.
std::vector<std::string> write_cluster_folder(const ClusterOptions& options, const Catalogues& catalogues);

}  // namespace slipbench

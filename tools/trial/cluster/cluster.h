// Writes a folder from which other machines run a sweep: readable scripts for Slurm and Snakemake.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

struct ClusterOptions {
  SweepOptions sweep;        // the sweep, with `jobs` per shard (0: 1)
  std::string folder;        // new, or empty
  std::size_t shards = 0;    // n of --shard k/n
  std::size_t throttle = 0;  // maximum number of Slurm tasks at a time; 0: no limit
};

// Writes the folder and returns its files' names. The scripts start this program in this working
// directory, by their current paths. Throws InputError for an invalid sweep, for more shards than
// trials, and if the folder is not empty.
std::vector<std::string> write_cluster_folder(const ClusterOptions& options, const Catalogues& catalogues);

}  // namespace slipbench

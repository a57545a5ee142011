// Which files a run may replace or remove: those of a dataset under the names that it was given, and no others.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace slipbench {

// Throws InputError when the k-th file of the dataset `path` may not be put there. What it may replace: an empty file, a dataset's k-th
// file, and as the first, which the user has named, HDF5 that cannot be read.
void check_dataset_target(const std::string& path, std::size_t k = 0);

// Names of the files of the finished dataset at `path` from the `first`-th on, as far as they are there and belong to it.
std::vector<std::string> later_files(const std::string& path, std::size_t first);

}  // namespace slipbench

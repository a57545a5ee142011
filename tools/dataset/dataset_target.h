// Decides which files a run may replace or remove: only files of a dataset under the names that the
// run was given.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace slipbench {

// Throws InputError if the k-th file of the dataset `path` may not be written there. It may replace
// an empty file or the k-th file of a dataset; the first file, which the user named, may also
// replace unreadable HDF5.
void check_dataset_target(const std::string& path, std::size_t k = 0);

// Names of the existing files of the finished dataset at `path` from the `first`-th on that belong
// to it.
std::vector<std::string> later_files(const std::string& path, std::size_t first);

}  // namespace slipbench

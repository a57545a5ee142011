// Finds a dataset whose run finished.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/dataset/header.h"

namespace slipbench {

struct FinishedDataset {
  std::size_t trials = 0;
  std::vector<FailedTrial> failed;
  std::vector<std::string> files;
};

// Returns the dataset at `path` if its header equals `header`. Empty if there is no dataset, its
// run did not finish, or it is damaged. Throws NotChecked (check_readable.h).
std::optional<FinishedDataset> finished_dataset(const std::string& path, const DatasetHeader& header);

}  // namespace slipbench

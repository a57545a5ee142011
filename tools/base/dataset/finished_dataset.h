// A dataset whose run came to its end.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/dataset/header.h"

namespace slipbench {

struct FinishedDataset {
  std::size_t trials = 0;
  std::vector<FailedTrial> failed;
  std::vector<std::string> files;
};

// The dataset at `path`, where it says `header` of itself. Empty where there is none, where its run did not come to its end, and
// where it is damaged. Throws NotChecked (check_readable.h).
std::optional<FinishedDataset> finished_dataset(const std::string& path, const DatasetHeader& header);

}  // namespace slipbench

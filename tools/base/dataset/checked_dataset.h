// Datasets of others, read after slipbench-reader has read them through (sim/core/process/check_readable.h).
#pragma once

#include <functional>
#include <string>

#include "tools/base/dataset/reader.h"

namespace slipbench {

// A dataset whose roots and list of trials can be read; its trials may be damaged. Throws InputError as check_readable() and DatasetReader do.
DatasetReader dataset_header_at(const std::string& path);

// A dataset that can be read as a whole and holds what was written. Throws InputError likewise.
DatasetReader checked_dataset(const std::string& path);

// Likewise one that holds a trial, and whose run came to its end. Throws InputError for another.
DatasetReader whole_dataset(const std::string& path);

// Hands each trial to `use`. Throws InputError where a trial has its outcome alone.
void for_each_trial(const DatasetReader& reader, const std::function<void(const TrialRecord& record)>& use);

}  // namespace slipbench

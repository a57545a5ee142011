// Opens untrusted datasets, after slipbench-reader has read them in a separate process
// (sim/core/process/check_readable.h).
#pragma once

#include <functional>
#include <string>

#include "tools/dataset/reader.h"

namespace slipbench {

// Opens a dataset whose root attributes and list of trials are readable; its trials may be damaged.
// Throws InputError as check_readable() and DatasetReader do.
DatasetReader dataset_header_at(const std::string& path);

// Opens a dataset that is readable as a whole and matches its digests. Throws InputError likewise.
DatasetReader checked_dataset(const std::string& path);

// As checked_dataset(), and throws InputError if its run did not finish or it holds no trial.
DatasetReader whole_dataset(const std::string& path);

// Passes each trial to `use`, in ascending order. Throws InputError for a trial whose outcome alone
// was recorded.
void for_each_trial(const DatasetReader& reader, const std::function<void(const TrialRecord& record)>& use);

}  // namespace slipbench

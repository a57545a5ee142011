// A trial as numpy reads it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/trial_record.h"

namespace slipbench {

// The bytes of an .npz archive with every array of `record` under the path that it has in a dataset, the attributes of its units as arrays
// beside their labels, and first `about`, a JSON object (README.md). The same record gives the same bytes. Throws std::runtime_error when
// libarchive fails.
std::string npz(const TrialRecord& record, const std::string& about);

// Whether a file that begins so is one: a zip archive whose first member is `about`.
bool begins_as_npz(std::string_view text);

// `shape` as Python writes a tuple, `descr` as numpy names a type: the header of an .npy file of version 1.0, 64-byte aligned.
std::string npy_header(std::string_view descr, const std::vector<std::size_t>& shape);

}  // namespace slipbench

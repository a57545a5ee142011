// What is settled before any format is written.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/dataset/reader.h"
#include "tools/program/export/export.h"

namespace slipbench {

// The word for --format: "npz".
std::string export_format_name(ExportFormat format);

// Throws InputError when the options contradict each other.
void check_export_options(const ExportOptions& options);

// The trials that the options ask for, ascending, once their files are what was written and each has a recording, and the truth where the format
// needs it. Throws InputError otherwise, and when there are none.
std::vector<std::size_t> trials_to_export(const DatasetReader& reader, const ExportOptions& options);

}  // namespace slipbench

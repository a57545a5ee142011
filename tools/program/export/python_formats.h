// The formats that Python's package writes, for want of Arrow in Debian.
#pragma once

#include <string>

#include "tools/program/export/export.h"

namespace slipbench {

// Whether tools/python/slipbench/_export writes this format.
bool is_python_format(ExportFormat format);

// Becomes the Python that writes the trials of a dataset to `out_dir`. `json`: one JSON object on stdout. The dataset and
// the options are checked before, in a child process. Throws InputError as export_dataset does, and where there is no such Python: build/venv's
// of a build, or the one whose package `slipbench` runs the program, which names itself in SLIPBENCH_PYTHON.
[[noreturn]] void start_python_export(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                                      bool json);

}  // namespace slipbench

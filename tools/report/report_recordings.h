// The page of imported recordings.
#pragma once

#include <string>

#include "tools/report/report.h"

namespace slipbench {
class DatasetReader;
}

namespace slipbench::report {

// The page of a dataset without truth, which holds imported recordings: their source, a table of
// all with duration, rate, longest step, missing values and recorded labels, and the signals of
// some over time. `file`: its name on the page. `options.trial`: the recording whose channels are
// all drawn; empty: the first channels of at most `options.max_trials` recordings (default: 12),
// evenly spaced. Throws InputError if a trial is unreadable.
std::string recordings_body(const DatasetReader& dataset, const std::string& file, const ReportOptions& options);

}  // namespace slipbench::report

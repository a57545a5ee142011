// `slipbench detect`: the alarms of any detector in recordings, with or without labels.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/page.h"
#include "tools/base/record/json.h"
#include "tools/program/eval/evaluate.h"

namespace slipbench::eval {

struct DetectOptions {
  DetectorScene detector;
  std::vector<std::string> recordings;  // datasets, by their first files
  std::string sensor;                   // the scene's name; empty: the only one
};

inline constexpr const char* detect_key = "slipbench_detect";

// Runs the detector on each trial by the code of evaluate(), so that samples and alarms are the same.
// The object that --json prints; its first key is detect_key: 1.
//   detector  {type, parameters}
//   sensor    {name, type, rate_hz} of the first trial
//   trials    [{recording, trial, object, duration_s, alarms: [{begin_s, end_s, probability}], alarms_per_minute,
//             labels, wrong_share, samples: {time_s, state, probability, label}}]
//             An alarm lasts from the estimate that first sees slip to the first sample that does not; `probability` is the
//             highest meanwhile. `labels`: the rule of the labels, null where there are none, as `wrong_share` and `label`.
//             `state` and `label`: no_contact, non_slip, incipient or gross. `probability`: null where the detector makes no
//             new estimate, and for a detector without a probability. `alarms_per_minute`: null for a trial of one sample.
//   worst     places in `trials`, the worst first: by the share of wrong samples where all trials have labels, else by
//             alarms per minute
// Throws InputError, which names file and trial: no whole dataset, outcomes alone, no such sensor, what replay() refuses.
Json detect(const DetectOptions& options);

// The alarms, a row each, and the samples, a row each, as CSV (RFC 4180).
std::string alarms_csv(const Json& result);
std::string samples_csv(const Json& result);

// A row a trial, the worst first. `most`: rows at most.
page::TextTable detections_table(const Json& result, std::size_t most);

// One HTML page without scripts: the signals, the probability and the alarms of the worst trials, then a table of all trials.
// Reads the signals from the recordings that `result` names.
std::string detect_page(const Json& result);

// Writes the file that -o names: FILE.csv (the alarms; the samples go to FILE_samples.csv), FILE.json or FILE.html (with FILE.json beside it).
// FILE.parquet is written by Python (slipbench/_detect.py).
// Throws InputError for another ending, and where a file cannot be put there or holds something else.
void check_detect_output(const std::string& path);
// Writes the files and returns their names. Throws InputError as check_detect_output().
std::vector<std::string> write_detection(const std::string& path, const Json& result);

inline constexpr page::PageKind detect_page_kind{
    "a detection", "slipbench detect", "page of slipbench detect", "result of slipbench detect", {detect_key}};

}  // namespace slipbench::eval

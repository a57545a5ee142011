// `slipbench detect`: alarms of any detector in recordings, with or without labels.
#pragma once

#include <string>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/eval/evaluate.h"
#include "tools/page/page.h"

namespace slipbench::eval {

struct DetectOptions {
  DetectorScene detector;
  std::vector<std::string> recordings;  // datasets, by their first files
  std::string sensor;                   // name in the scene; empty: the only one
  bool resample = false;                // as in eval::Options
};

inline constexpr const char* detect_key = "slipbench_detect";

// Runs the detector on each trial by the code of evaluate(), so that samples and alarms are the
// same. Returns the object that --json prints; its first key is detect_key: 1.
// - detector: {type, parameters}
// - sensor: {name, type, rate_hz} of the first trial
// - notice, reads_hz: as of evaluate()
// - trials: [{recording, trial, object, duration_s, alarms: [{begin_s, end_s, probability}],
//   alarms_per_minute, labels, wrong_share, samples: {time_s, state, probability, label}}]. An
//   alarm lasts from the first estimate of slip to the first sample without; its `probability` is
//   the maximum in between. `labels`: rule of the labels; null without labels, as are `wrong_share`
//   and `label`. `state` and `label`: no_contact, non_slip, incipient or gross; a label may also be
//   null, of a sample whose state is unknown. `probability` of a sample: null without a new estimate,
//   and for a detector without a probability.
//   `alarms_per_minute`: null for a trial of one sample.
// - worst: indices into `trials`, the worst first: by the share of wrong samples if all trials have
//   labels, else by alarms per minute
// Throws InputError, naming file and trial, for an incomplete dataset, for trials with their
// outcome alone, for an unknown sensor, and as replay() does.
Json detect(const DetectOptions& options);

// CSV (RFC 4180) of the alarms, one row each, and of the samples, one row each.
std::string alarms_csv(const Json& result);
std::string samples_csv(const Json& result);

// Checks the file of -o: FILE.csv (the alarms; the samples go to FILE_samples.csv), FILE.json or
// FILE.html (with FILE.json). Python writes FILE.parquet (slipbench/_detect). Throws InputError for
// another extension, and if a file cannot be written or exists with other content.
void check_detect_output(const std::string& path);
// Writes the files and returns their names. Throws InputError as check_detect_output() does.
std::vector<std::string> write_detection(const std::string& path, const Json& result);

inline constexpr page::PageKind detect_page_kind{
    "a detection", "slipbench detect", "page of slipbench detect", "result of slipbench detect", {detect_key}};

}  // namespace slipbench::eval

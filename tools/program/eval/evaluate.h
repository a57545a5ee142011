// `slipbench eval`: any detector on any dataset of its sensor.
#pragma once

#include <optional>
#include <set>

#include "tools/base/page/page.h"
#include "tools/program/eval/metrics.h"

namespace slipbench::eval {

struct Options {
  DetectorScene detector;
  std::string dataset;
  std::optional<TruthRule> labels = {};  // empty: `recorded` for recordings; else that of the detector's training, or strict
  std::string sensor;                    // the scene's name; empty: the only one
  std::string split;                     // "train", "valid" or "test" of the dataset's masks; empty: every trial
  // What the detector says of its training, JSON (training_of()): trials whose digests stand in
  // `sha256_seen` are left out, unless `all`.
  std::string trained = "{}";
  bool all = false;
};

// What a detector says of its training, JSON: the metadata `trained` of a network; of memories
// {"trained", "sha256_seen"}, where their folder records the trials; "{}" for a detector that is
// not trained. Throws InputError as network_of(), and for a damaged record.
std::string training_of(const DetectorScene& detector);

// The rule of a detector's training, as its metadata `trained` states it; `masked` for `tightened`; `strict` without a rule.
// Throws InputError for an unknown rule.
TruthRule learnt_labels(const std::string& trained);
// Digests of the trials that it has learnt from or chosen its state by, whatever file they are in. Throws InputError for what is no list of them.
std::set<std::string> seen_trials(const DetectorScene& detector, const std::string& trained);

inline constexpr const char* result_key = "slipbench_eval";

// The result, which --json prints and the page shows; its first key is result_key: 1.
//   detector {type, parameters}, dataset, sensor {name, type, rate_hz}, labels, split
//   truth          empty; of imported recordings "none: imported from bts3v2": what is judged by, then, is the set's own label
//   left_out       trials that the detector was trained on, which are not judged
//   warnings       texts: a detector that is trained and does not record on which trials; trials judged on
//                  which it was trained (`all`)
//   all            summary_json() of the trials judged
//   by             [{by, groups: [{name, ...summary_json()}]}]: material, object, speed (octaves), and mask, where no trial is left out; of those
//                  that have 2 to 24 groups
//   failed         trials that failed, which the dataset does not hold
//   roc            [[threshold, false share, true share]] and
//   calibration    [{low, high, count, mean, share}], where the detector has a probability and both classes occur
//   alarms         [{threshold, false_alarms_per_minute, recall_of_slip, balanced_slip_accuracy, delay_median_s, missed}] with other thresholds
//                  and the network's own frames in a row, where the detector has a probability
//   classes        {balanced_accuracy, called: {class: {class: samples}}} of a network of more than two, most probable class against the class
//                  that the recordings' own set gives a trial, where it gives one
//   loop           what the dataset's own loop did with this detector: {detector, same}; `same`: it gave the same classes in every sample; in
//                  grasps where it is true: trials, dropped, slip_translation_m, slip_rotation_rad, force_ratio (medians; greatest force over the
//                  least that holds), reaction_time_s. Absent where the dataset has no detector on that sensor
//   trials         [{trial, detection, slip_time_s, alarm_time_s, delay_s, false_alarms, frames, wrong, material, object, speed_m_s, friction,
//                  mask}]
//   worst          numbers of the trials to look at first, with why: [{trial, why}]
// Times in s. Throws InputError, naming file and trial: no whole dataset, outcomes alone, no such sensor or split, what replay() and truth_of()
// refuse.
Json evaluate(const Options& options);

// A detector as results name it: its type, and the file or folder of a network or of memories. `detector`: {type, parameters}.
std::string detector_name(const Json& detector);

// The trials and the channels of each that a page draws over time, at most.
inline constexpr std::size_t drawn_trials = 12, drawn_channels = 4;

// What a reader of a result must know where `truth` is not empty; empty where it is.
std::string truth_note(const Json& result);

// The result as a terminal and the page show it.
struct Tables {
  page::TextTable figures, called;  // called: the true states, and what their samples were called
  std::vector<page::TextTable> by;  // of each breakdown
};
Tables tables_of(const Json& result);

// One HTML page without scripts, which needs no other file, of a result (evaluate.h) with its `command`. `html_path`: where it will stand; trials
// link from there to the page that `slipbench report` makes of the dataset beside it. Text of `result` is shown as text, never as markup.
// `detector`: the one of the result. It runs again on the worst trials, whose signals, states, probability and alarms are drawn from the dataset.
// Throws InputError where the dataset is no longer as it was judged.
std::string eval_page(const Json& result, const std::string& html_path, const DetectorScene& detector);

// The page and the result as they are written.
inline constexpr page::PageKind page_kind{
    "an evaluation", "slipbench eval", "page of slipbench eval", "result of slipbench eval", {result_key}};

}  // namespace slipbench::eval

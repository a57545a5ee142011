// `slipbench eval`: evaluates any detector on any dataset of its sensor.
#pragma once

#include <optional>
#include <set>

#include "tools/eval/metrics.h"
#include "tools/page/page.h"

namespace slipbench::eval {

struct Options {
  DetectorScene detector;
  std::string dataset;
  std::optional<LabelRule> labels = {};  // empty: `recorded` for recordings, else the rule of the detector's training, or strict
  std::string sensor;                    // name in the scene; empty: the only one
  std::string split;                     // "train", "valid" or "test" of the dataset's masks; empty: every trial
  // Training record of the detector, JSON (training_of()). Trials whose digests are in
  // `sha256_seen` are left out, unless `all`.
  std::string trained = "{}";
  bool all = false;
  bool resample = false;  // interpolate recordings that are slower than the detector reads, or have long gaps
};

// Training record of a detector, JSON: the metadata `trained` of a network; {"trained",
// "sha256_seen"} of memories whose folder records the trials; "{}" for a detector that is not
// trained. Throws InputError as network_of(), and for a damaged record.
std::string training_of(const DetectorScene& detector);

// Label rule of a detector's training, from its metadata `trained`; `masked` for
// `tightened` and `moved`; `strict` without a rule. Throws InputError for an unknown rule.
LabelRule learnt_labels(const std::string& trained);
// Digests of the trials used for training or for selecting the detector, whatever file they are in.
// Throws InputError for an invalid list.
std::set<std::string> seen_trials(const DetectorScene& detector, const std::string& trained);

inline constexpr const char* result_key = "slipbench_eval";

// The result that --json prints and the page shows. Its first key is result_key: 1. Times in s.
// - detector: {type, parameters}; dataset; sensor: {name, type, rate_hz}; labels; split
// - truth: empty; for imported recordings "none: imported from bts3v2", where the set's own labels
//   are the reference
// - left_out: trials that the detector was trained on, which are not judged
// - notice: how samples were resampled for the detector, of all trials; empty: they were not
// - reads_hz: of a network: {frames, least}, network::rate_read() and network::least_rate()
// - resample: as in Options
// - warnings: texts about a trained detector that does not record its trials, and about judged
//   trials on which it was trained (`all`)
// - all: summary_json() of the judged trials
// - yardstick: {type, thresholds, by_halves, areas: {type: {value, low, high}}, left_out: {type: why},
//   all: summary_json()}: the yardstick (detectors/yardstick) with the greatest area under the ROC
//   curve on the same trials. Its thresholds have the unit of its parameter. Absent without a
//   yardstick that reads the sensor and if all samples have one class
// - by: [{by, groups: [{name, ...summary_json()}]}] for material, object, speed (octaves) and, if
//   no trial is left out, mask; only breakdowns of 2 to 24 groups
// - failed: trials that failed, which the dataset does not contain
// - roc: [[threshold, false share, true share]] and calibration: [{low, high, count, mean, share}],
//   if the detector has a probability and both classes occur
// - alarms: [{threshold, false_alarms_per_minute, recall_of_slip, balanced_slip_accuracy,
//   delay_median_s, missed}] for other thresholds with the network's own number of consecutive
//   frames, if the detector has a probability
// - classes: {balanced_accuracy, called: {class: {class: samples}}} of a network with more than two
//   classes: its most probable class against the trial's class in the recordings' own set, if the
//   set gives one
// - loop: {detector, same}: whether the dataset's own loop gave the same classes with this detector
//   in every sample; if so, in grasps also trials, dropped, slip_translation_m, slip_rotation_rad,
//   force_ratio (medians; greatest force over the least that holds), reaction_time_s. Absent if the
//   dataset has no detector on that sensor
// - trials: [{trial, detection, slip_time_s, alarm_time_s, delay_s, false_alarms, frames, wrong,
//   material, object, speed_m_s, friction, mask}]; detection: null for a trial without a known label
// - worst: [{trial, why}], the trials to inspect first
// Throws InputError, naming file and trial, for an incomplete dataset, for trials with their
// outcome alone, for an unknown sensor or split, if all labels are unknown, and as replay() and
// truth_of() do.
Json evaluate(const Options& options);

// Name of a detector in results: its type, and the file or folder of a network or of memories.
// `detector`: {type, parameters}.
std::string detector_name(const Json& detector);

// Maximum number of trials, and of channels of each, that a page draws over time.
inline constexpr std::size_t drawn_trials = 12, drawn_channels = 4;

// reads_hz of a result.
Json reads_json(const network::Input& input);
// Notes on the frames that the detector read, from a result of evaluate() or detect(): the rate of a
// network, and how samples were resampled.
std::vector<std::string> frame_notes(const Json& result);

// Note on the labels if `truth` is not empty; else empty.
std::string truth_note(const Json& result);

// How the thresholds of the best yardstick were chosen; empty without one.
std::string yardstick_note(const Json& result);

// Page kind with its result.
inline constexpr page::PageKind page_kind{
    "an evaluation", "slipbench eval", "page of slipbench eval", "result of slipbench eval", {result_key}};

}  // namespace slipbench::eval

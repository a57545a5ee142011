// `slipbench benchmark`: judges slip detectors on held-out recordings and grasps.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/benchmark/protocol.h"
#include "tools/dataset/record/json.h"
#include "tools/page/page.h"

namespace slipbench::benchmark {

// The options that decide the content of a board.
struct BoardRequest {
  std::vector<std::string> detectors;  // added to those that ship: names, FILE.onnx, folders of memories
  std::vector<Override> parameters;    // for each of `detectors`
  std::vector<std::string> real;       // datasets of real recordings, for the track transfer
  std::string sensor;                  // judge this type only; empty: all
  // For a quick look instead of a board of the protocol: this number of trials of each scene,
  // spread evenly over it; 0: all.
  std::size_t trials = 0;
};

struct Options {
  BoardRequest request;
  std::string protocol = default_protocol;
  std::size_t jobs = 0;  // worker threads; 0: one per hardware thread
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> say = {};  // reports progress; may be empty
};

inline constexpr const char* result_key = "slipbench_benchmark";

// Returns the board as one object, which --submit writes; its first key is result_key: 1.
//   asked       as request_json()
//   protocol    {name, sha256, real (by sensor: what is known from real recordings), half_delay_s, force_ratio,
//               half_slip_distance_m, least_slip_distance_m, whole}; whole: false if only a part was judged
//   machine     environment_json() without its load
//   sets        [{track, sensor, scene or file, trials, data_sha256, labels, rows, left_out: [{detector, why,
//               reads_another}], by}] in the protocol's order,
//               transfer last; with `domain` and `disturbance` where the protocol has them
//     rows      the best first: {rank (null for measures and under a disturbance),
//               detector, kind, sensor, parameters, sha256, score: {value, low, high}, credit,
//               false_alarms_per_minute, reported_share, figures (eval::summary_json())},
//               yardsticks that choose their threshold: with thresholds, one for each half of the
//               trials, chosen on the other half; only one if it was chosen on all trials,
//               open: with false_share,
//               real recordings: with windows: {length_s, slipping, sticking, recall, specificity},
//               disturbed: with specificity and judged, loops: with needless and grasps: {trials,
//               dropped, not_lifted, low, high (interval of both together), force_ratio, slip_m}
//     by        [{by, groups: [{name, trials, scores: [of each row]}]}] for each parameter that the scene's grid varies
//   transfer    the reason if the track transfer is empty
// Times are in s. The result does not depend on clock time or on the number of threads. Throws
// InputError for an unknown protocol or sensor, a detector or file that cannot be read, a scene
// that cannot be simulated; Interrupted.
Json benchmark(const Options& options);

// How files of this kind are recognised.
inline constexpr page::PageKind page_kind{
    "a board", "slipbench benchmark", "page of slipbench benchmark", "board of slipbench benchmark", {result_key}};

}  // namespace slipbench::benchmark

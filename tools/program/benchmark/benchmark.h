// `slipbench benchmark`: every slip detector on recordings and in grasps that none of them has seen.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/base/page/page.h"
#include "tools/base/record/json.h"
#include "tools/program/benchmark/protocol.h"

namespace slipbench::benchmark {

// What decides a board's bytes on one machine.
struct Asked {
  std::vector<std::string> detectors;  // beside those that ship: names, FILE.onnx, folders of memories
  std::vector<Override> parameters;    // of each of them
  std::vector<std::string> real;       // datasets of real recordings, for the track transfer
  std::string sensor;                  // its type alone; empty: all
  // To try things, which makes no board of the protocol: so many trials of each scene, spread over it (0: all), and nobody learns.
  std::size_t trials = 0;
  bool untaught = false;
};

struct Options {
  Asked asked;
  std::string protocol = default_protocol;
  std::size_t jobs = 0;  // worker threads; 0: one a hardware thread
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> say = {};  // what is being done; may be empty
};

inline constexpr const char* result_key = "slipbench_benchmark";

// The board as one object, which --submit writes; its first key is result_key: 1.
//   asked       as asked_json()
//   protocol    {name, sha256, half_delay_s, alarms_per_minute, force_ratio,
//               half_slip_distance_m, least_slip_distance_m, whole}; whole: false of a part of it, to try things
//   machine     environment_json() without its load
//   learnt_from [{scene, trials, sha256}]
//   sets        [{track, sensor, scene or file, trials, data_sha256, labels, rows, left_out: [{detector, why,
//               reads_another}], by}] in the protocol's order,
//               transfer last; with `domain` where the protocol tells domains apart
//     rows      the best first: {rank (null of measures, and of controls under a disturbance), detector, kind, sensor, parameters, sha256, score: {value, low, high}, credit,
//               false_alarms_per_minute, said, figures (eval::summary_json()), and of a closed loop
//               grasps: {trials, dropped, not_lifted, low, high (the interval of both together), force_ratio, slip_m} and, where the protocol counts it, needless}
//     by        [{by, groups: [{name, trials, scores: [of each row]}]}] of what the scene's grid varies
//   transfer    why the track transfer is empty, where it is
// Times in s. No clock time: the same on one machine whatever the threads. Throws InputError: no such protocol or sensor, a detector or file that cannot be
// read, a scene that cannot be simulated; Interrupted.
Json benchmark(const Options& options);

Json asked_json(const Asked& asked);
// The inverse. Throws InputError, which names `file` and the key.
Asked parse_asked(const Json& json, const std::string& file);

// The bytes of a submission.
std::string submission_text(const Json& result);
// Throws InputError for a text that is no submission of a protocol of this program, by its name and its digest: nothing has to be computed to see
// that.
Json parse_submission(const std::string& text, const std::string& name);

// How a recomputed board, with the submission's own `machine` in the place of this one, differs from the submission:
// "/sets/0/rows/2/credit: 0.41 in the file, 0.43 here". Empty: in nothing. MuJoCo, FFTW and networks compute in every board, so numbers that are
// not whole are equal within 1e-9; all else must be the same byte for byte.
std::string difference(const std::string& text, const Json& submitted, Json recomputed);

// One HTML page without scripts of a board (benchmark.h).
std::string board_page(const Json& result);

// The page and the board as they are written.
inline constexpr page::PageKind page_kind{
    "a board", "slipbench benchmark", "page of slipbench benchmark", "board of slipbench benchmark", {result_key}};

// The columns of one set's table, "score" among them, and its rows in order.
struct BoardTable {
  std::string title;  // "open recordings, papillarray: 96 trials"
  page::TextTable cells;
  std::vector<std::string> left_out;  // "gst_hd: why"; those that read another sensor in one line
};
BoardTable board_table(const Json& set);

}  // namespace slipbench::benchmark

// The commands that teach and judge detectors, and that fit a scene to recordings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "detectors/hd/features.h"
#include "detectors/hd/model.h"
#include "sim/scene/parser.h"
#include "tools/benchmark/benchmark.h"
#include "tools/calibrate/calibrate.h"
#include "tools/cli/command.h"
#include "tools/dataset/record/json.h"
#include "tools/eval/detect.h"
#include "tools/eval/evaluate.h"
#include "tools/train/network/split.h"
#include "tools/train/train_hd.h"

namespace slipbench {

// `train`: slip detectors taught on datasets.
struct TrainCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  // The request, once the words have been read.
  HdTraining options;  // of gst_hd
  Json request;        // of any other recipe: what slipbench/_train.py takes; null: gst_hd

 private:
  void read_hd();
  void read_network();
  int train_hd();

  // As given; empty: was not.
  std::string recipe_;
  std::optional<hd::Encoding> encoding_;
  std::optional<hd::Compat> compat_;
  std::optional<hd::Ties> ties_;
  std::optional<hd::Quantiser> quantiser_;
  std::optional<std::size_t> dimension_, window_, epochs_, jobs_;
  bool context_ = false, no_context_ = false;  // neither: the encoding's own default
  std::string labels_;
  std::optional<train::Split> split_;
  std::optional<std::size_t> steps_, held_out_, turned_;
  std::string alarms_;
  bool score_ = false;
  std::vector<std::string> with_;
  bool all_ = false, resume_ = false;
};

// `eval`: slip detectors judged on datasets.
struct EvalCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string detector;              // a name, FILE.onnx or a folder
  std::vector<Override> parameters;  // of it, by name
  std::string output;                // HTML file; empty: none
  eval::Options options;             // but for the detector
};

// `detect`: the alarms of a slip detector in recordings.
struct DetectCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string detector;              // a name, FILE.onnx or a folder
  std::vector<Override> parameters;  // of it, by name
  std::string output;                // empty: none
  eval::DetectOptions options;       // but for the detector

 private:
  [[noreturn]] void detect_in_python();
};

// The result of a detection on stdout. `files`: which were written. `json`: one JSON object, in which they are `files`.
void print_detection(Json result, const std::vector<std::string>& files, bool json);

// `benchmark`: a board of slip detectors, and submissions to it.
struct BenchmarkCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  benchmark::Asked asked;
  std::size_t jobs = 0;
  std::string protocol;                      // empty: the default
  std::string output, submission, verified;  // files; empty: none

 private:
  // The board, while an interrupt ends it.
  [[nodiscard]] Json made(benchmark::Asked asked_for, const std::string& protocol_name) const;
  [[nodiscard]] int verify() const;
  [[nodiscard]] std::string text(const Json& result) const;
};

// `calibrate`: a scene fitted to recordings.
struct CalibrateCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  // The request, once the words have been read.
  calibrate::Options options;
  std::string output;  // YAML file; empty: nothing is written

 private:
  int fit_snapshots() const;

  std::vector<std::string> words_;  // SCENE REAL..., with --snapshots REAL... alone
  std::vector<std::string> fits_;
  std::optional<std::size_t> jobs_;
  std::optional<std::size_t> starts_;
  bool snapshots_ = false;
  std::string sensor_;          // of the snapshots; empty: the only one
  std::optional<double> idle_;  // m
};

// `hd replay`: quantised input, step by step.
struct HdReplayCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string vectors;               // CSV file
  std::string memories;              // folder, or the shipped classifier's name
  std::optional<hd::Compat> compat;  // these two replace what the folder says
  std::optional<hd::Ties> ties;
  std::string engine = "kernel";
};

// `hd` by itself says what is below it.
struct HdCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  HdReplayCommand replay;
};

struct HdVector {
  std::uint64_t step;
  hd::Frame frame;
};

// Reads the columns n (step), L0 to L8 (levels) and ctx (context), wherever they stand; other columns are left alone. Throws InputError
// with file and line: a column that is missing or there twice, a row with too few or too many cells, a level beyond 20 or a context
// beyond 3, a step that does not follow the one before.
std::vector<HdVector> read_hd_vectors(const std::string& file);

}  // namespace slipbench

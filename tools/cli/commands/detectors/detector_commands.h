// The commands that train and evaluate detectors, and that fit a scene to recordings.
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
#include "tools/cli/commands/detectors/training_options.h"
#include "tools/dataset/record/json.h"
#include "tools/eval/detect.h"
#include "tools/eval/evaluate.h"
#include "tools/train/network/split.h"
#include "tools/train/train_hd.h"

namespace slipbench {

// `train` trains networks on datasets.
struct TrainCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  Json request;  // to slipbench/_train.py, once the words have been read

 private:
  void read();

  // Options as given; empty: not given.
  std::string dataset_, output_, recipe_, labels_, sensor_, rates_;
  std::vector<std::string> with_;
  std::uint64_t seed_ = 1;
  std::optional<train::Split> split_;
  std::optional<std::size_t> steps_, held_out_, turned_;
  PointOptions point_;
  bool all_ = false, resume_ = false;
};

// `train-hd` trains the memories of the hyperdimensional detector.
struct TrainHdCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  HdTraining options;

 private:
  void read();

  std::string labels_;                         // as given; empty: not given
  bool context_ = false, no_context_ = false;  // neither is set: the default of the encoding
  PointOptions point_;
};

// Help of the option --resample of `eval` and `detect`.
inline constexpr const char* resample_help =
    "Interpolate recordings that are slower than the detector reads, and across gaps of more than 0.1 s";

// `eval` evaluates slip detectors on datasets.
struct EvalCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string detector;              // a name, FILE.onnx or a folder
  std::vector<Override> parameters;  // of it, by name
  std::string output;                // HTML file; empty: none
  eval::Options options;             // but for the detector
};

// `detect` writes the alarms of a slip detector in recordings.
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

// Prints the result of a detection on stdout. `files`: the written files. `json`: prints one JSON
// object, which names the files as `files`.
void print_detection(Json result, const std::vector<std::string>& files, bool json);

// `benchmark` ranks slip detectors on a board and checks submissions.
struct BenchmarkCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  benchmark::BoardRequest request;
  std::size_t jobs = 0;
  std::string protocol;                      // empty: the default
  std::string output, submission, verified;  // files; empty: none

 private:
  // Computes the board; an interrupt ends the computation.
  [[nodiscard]] Json made(benchmark::BoardRequest request, const std::string& protocol_name) const;
  [[nodiscard]] int verify() const;
  [[nodiscard]] std::string text(const Json& result) const;
};

// `calibrate` fits a scene to recordings.
struct CalibrateCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  // The request, once the words have been read.
  calibrate::Options options;
  std::string output;  // YAML file; empty: nothing is written

 private:
  int fit_snapshots() const;

  std::vector<std::string> words_;  // SCENE REAL...; with --snapshots only REAL...
  std::vector<std::string> fits_;
  std::optional<std::size_t> jobs_;
  std::optional<std::size_t> starts_;
  bool snapshots_ = false;
  std::string sensor_;          // sensor of the snapshots; empty: the only one
  std::optional<double> idle_;  // m
};

// `hd replay` runs a classifier on quantised input, step by step.
struct HdReplayCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string vectors;               // CSV file
  std::string memories;              // folder, or the shipped classifier's name
  std::optional<hd::Compat> compat;  // these two override the settings of the folder
  std::optional<hd::Ties> ties;
  std::string engine = "kernel";
};

// `hd` without a subcommand prints its subcommands.
struct HdCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  HdReplayCommand replay;
};

struct HdVector {
  std::uint64_t step;
  hd::Frame frame;
};

// Reads the columns n (step), L0 to L8 (levels) and ctx (context), in any order; ignores other
// columns. Throws InputError with file and line for a missing or repeated column, a row with too
// few or too many cells, a level above 20, a context above 3, and a step that does not follow the
// previous one.
std::vector<HdVector> read_hd_vectors(const std::string& file);

}  // namespace slipbench

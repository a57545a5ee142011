// Trains a hyperdimensional slip detector on a dataset, and evaluates it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "detectors/hd/features.h"
#include "detectors/hd/memories.h"
#include "detectors/hd/memory_files.h"
#include "detectors/hd/model.h"
#include "sim/core/choice.h"
#include "tools/dataset/record/json.h"
#include "tools/statistics/confusion.h"
#include "tools/statistics/descriptive.h"
#include "tools/train/network/operating_point.h"
#include "tools/train/sequences.h"

namespace slipbench {

// An encoded frame for training or test.
struct Sample {
  std::size_t sequence = 0;  // index, not the trial's number
  std::size_t row = 0;       // in the sequence
  PadState label{};          // not no_contact
  std::uint8_t moving = 0;
  std::uint8_t context = 0;
  hd::Hypervector query;
};

// The query vectors of all sequences, in order. The encoder gets every frame of a sequence. A
// sample is a frame in contact with a whole window of frames before it, whatever the encoding, so
// that all encodings are evaluated on the same frames. `jobs`: threads, 0: one per hardware thread.
// Throws InputError for displacements beyond the detector's fixed-point range.
std::vector<Sample> encode(const hd::Model& model, const hd::Memories& memories, hd::Quantiser quantiser,
                           std::span<const Sequence> sequences, std::size_t jobs);

// The prototypes of samples, sample i counted `times[i]` times. Without `epochs` they are the
// majorities of a single pass, as in the paper; a class without samples gets ties throughout. With
// epochs the sums begin at 0. In each epoch all samples are judged in turn, in an order drawn by
// RandomStream(seed, epoch, "hd epochs"). A sample that is not nearer to its own class than to any
// other by more than a sixteenth of the bits is added to its own class and subtracted from the
// nearest other, as often as it counts, and the prototypes are set to the signs of the sums again
// (after QuantHD [imani2020]). So the sums of all classes add up to 0, and the prototypes stay
// separated. The result is the signs of the mean of the sums over all judged samples (an averaged
// perceptron).
std::vector<hd::Hypervector> fit(const hd::Model& model, const hd::Memories& memories, std::span<const Sample> samples,
                                 std::span<const std::uint32_t> times, std::size_t epochs, std::uint64_t seed);

// Assigns a sample to the nearest of the prototypes, or to the higher class if two are equally near
// (eq. 5).
class Classifier {
 public:
  // `memories`: trained. Throws InputError if they do not fit the model.
  Classifier(const hd::Model& model, const hd::Memories& memories);

  [[nodiscard]] PadState classify(const Sample& sample) const;

 private:
  std::array<std::vector<hd::Hypervector>, hd::context_count> prototypes_;  // DP_k, by context
};

// Result of one test.
struct Evaluation {
  std::size_t training = 0;             // training items with repeats: sequences, or frames for a split by frame
  std::size_t distinct = 0;             // number of distinct training items
  std::size_t tested = 0;               // number of test items
  Confusion all{};                      // every sample
  Confusion moving{};                   // samples while the pad moves
  Delays delays;                        // empty for a split by frame, as is `said`
  std::vector<train::SlipSeries> said;  // answers to each sequence; masked: without slip, after a slip
};

enum class Split { by_sequence, by_frame };

// draw_count tests of a classifier, each trained on a draw of bootstrap() and judged on the
// remaining items. The conditions are condition_of() of the sequence, even for draws of frames.
// Throws InputError if a draw leaves nothing for training or test.
std::vector<Evaluation> cross_validate(const hd::Model& model, const hd::Memories& memories, std::span<const Sequence> sequences,
                                       std::span<const Sample> samples, Split split, std::size_t epochs, std::uint64_t seed,
                                       std::size_t jobs);

struct HdTraining {
  std::string dataset;
  std::vector<std::string> with;  // further datasets, such as grasps
  bool all = false;               // train on every trial, ignoring the datasets' own splits
  SequenceOptions sequences;
  hd::Model model;
  hd::Quantiser quantiser = hd::Quantiser::fixed_point;
  std::size_t epochs = 0;        // 0: single pass, as in the paper
  bool point = false;            // draw 0 chooses the number of consecutive frames for an alarm
  std::optional<double> alarms;  // maximum number of false alarms per minute; empty: choose by score
  double specificity = 0.95;     // with a choice by score: as train::best_scoring_point()
  std::uint64_t seed = 1;        // for item memories and draws
  std::size_t jobs = 0;          // threads; 0: one per hardware thread
  std::string output;            // folder of the memories
};

struct HdSummary {
  std::size_t trials = 0;     // in all datasets
  std::size_t sequences = 0;  // for training: of a dataset with its own split, those of its part train, unless HdTraining::all
  bool own_split = false;     // a dataset has its own split
  std::string test;           // the first dataset whose part test was left out; empty: none
  std::size_t samples = 0;
  std::vector<Evaluation> by_sequence;  // one per draw
  std::vector<Evaluation> by_frame;
  network::Alarm alarm;
  std::string sensor;   // of the first trial
  std::string trained;  // training record in model.txt
};

// `slipbench train-hd`: runs the draws, then trains a classifier on every training sequence and saves
// it with the digests of their trials. Throws InputError; if the output cannot be written, before
// anything is read.
HdSummary train_hd(const HdTraining& options);

// Mean and standard deviation of `figure` over the draws that give the figures: all except number
// 0.
template <class Figure>
MeanSd over_draws(std::span<const Evaluation> draws, Figure&& figure) {
  std::vector<double> values;
  for (const Evaluation& draw : draws.subspan(1)) values.push_back(figure(draw));
  return mean_sd(values);
}

// Pools the same draws: their frames and sequences; sequences tested in several draws count each
// time.
Evaluation pooled(std::span<const Evaluation> draws);

// All draws: number 0, and mean and standard deviation of the others.
Json draws_json(std::span<const Evaluation> draws);

Json train_json(const HdSummary& summary, const HdTraining& options);

// Encoders on the command line, abbreviated as in the paper.
inline constexpr std::array encoder_words{Choice<hd::Encoding>{"shdc", hd::Encoding::spatial},
                                          Choice<hd::Encoding>{"sthdc", hd::Encoding::spatial_temporal},
                                          Choice<hd::Encoding>{"gsthdc", hd::Encoding::graph_spatial_temporal}};

// "CL-gstHDC".
std::string model_name(const hd::Model& model);

}  // namespace slipbench

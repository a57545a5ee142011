// Teaching a hyperdimensional slip detector from a dataset, and judging it.
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
#include "detectors/hd/words.h"
#include "tools/base/record/json.h"
#include "tools/base/statistics/confusion.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/train/network/operating_point.h"
#include "tools/program/train/sequences.h"

namespace slipbench {

// A frame to learn from or to be judged, after the encoder.
struct Sample {
  std::size_t sequence = 0;  // index, not the number of the trial
  std::size_t row = 0;       // of the sequence
  PadState label{};          // any but no_contact
  std::uint8_t moving = 0;
  std::uint8_t context = 0;
  hd::Hypervector query;
};

// The query vectors of all sequences, in order. The encoder sees every frame of a sequence; a sample is a frame that touches and has
// a whole window of frames behind it, whatever the encoding, so that all encodings are judged on the same frames.
// `jobs`: threads, 0: as many as the machine has. Throws InputError for displacements that do not fit the detector's fixed point.
std::vector<Sample> encode(const hd::Model& model, const hd::Memories& memories, hd::Quantiser quantiser,
                           std::span<const Sequence> sequences, std::size_t jobs);

// The prototypes of samples, each taken `times` times. Without `epochs` they are the majorities of a single pass, the paper's; a class
// without a sample gets ties throughout. With them the sums begin at 0. In an epoch all samples are judged one after the other, in an order
// drawn by RandomStream(seed, epoch, "hd epochs"). One that is not nearer to its own class than to any other by more than a sixteenth of
// the bits is added to its own and taken from the nearest other, as often as it is learnt, and the prototypes are cut to signs anew (after
// Imani et al., QuantHD, IEEE TCAD 2019). So the classes' sums are 0 together, and prototypes stay apart. What comes out are the signs of the
// mean of the sums over all that was judged (an averaged perceptron).
std::vector<hd::Hypervector> fit(const hd::Model& model, const hd::Memories& memories, std::span<const Sample> samples,
                                 std::span<const std::uint32_t> times, std::size_t epochs, std::uint64_t seed);

// What a sample is called: the nearest of the prototypes, the higher class where two are equally near (eq. 5).
class Classifier {
 public:
  // `memories`: trained. Throws InputError when they do not fit the model.
  Classifier(const hd::Model& model, const hd::Memories& memories);

  [[nodiscard]] PadState classify(const Sample& sample) const;

 private:
  std::array<std::vector<hd::Hypervector>, hd::context_count> prototypes_;  // DP_k, by context
};

// One test.
struct Evaluation {
  std::size_t training = 0;             // items trained on, repeats counted: sequences, or frames where the split is by frame
  std::size_t distinct = 0;             // how many of them differ
  std::size_t tested = 0;               // items tested
  Confusion all{};                      // every sample
  Confusion moving{};                   // those while the pad moves
  Delays delays;                        // empty where the split is by frame, as are
  std::vector<train::SlipSeries> said;  // of each sequence what was said; masked: no slip, after one
};

enum class Split { by_sequence, by_frame };

// draw_count tests of a classifier, each trained on what bootstrap() drew and judged on the rest. Conditions are condition_of() of the
// sequence, also where frames are drawn. Throws InputError when a draw leaves nothing to train on or to test.
std::vector<Evaluation> cross_validate(const hd::Model& model, const hd::Memories& memories, std::span<const Sequence> sequences,
                                       std::span<const Sample> samples, Split split, std::size_t epochs, std::uint64_t seed,
                                       std::size_t jobs);

struct HdTraining {
  std::string dataset;
  std::vector<std::string> with;  // more datasets, such as of grasps
  bool all = false;               // learn from every trial, whatever a dataset's own split says
  SequenceOptions sequences;
  hd::Model model;
  hd::Quantiser quantiser = hd::Quantiser::fixed_point;
  std::size_t epochs = 0;        // 0: the paper's single pass
  bool point = false;            // whether draw 0 chooses how many frames in a row make an alarm, with
  std::optional<double> alarms;  // at most so many false ones a minute; else with the greatest score
  std::uint64_t seed = 1;        // of item memories and draws
  std::size_t jobs = 0;          // threads; 0: as many as the machine has
  std::string output;            // folder of the memories
};

struct HdSummary {
  std::size_t trials = 0;     // of all datasets
  std::size_t sequences = 0;  // learnt from: of a dataset with a split of its own those of its part train, unless HdTraining::all
  bool own_split = false;     // whether there is such a dataset
  std::string test;           // the first dataset whose part test was left out; empty: there is none
  std::size_t samples = 0;
  std::vector<Evaluation> by_sequence;  // one a draw
  std::vector<Evaluation> by_frame;
  network::Alarm alarm;
  std::string sensor;   // of the first trial
  std::string trained;  // what model.txt says of the training
};

// `slipbench train`: the draws, then a classifier trained on every sequence learnt from, which is
// saved with the digests of their trials. Throws InputError; for an output that
// cannot be written before anything is read.
HdSummary train_hd(const HdTraining& options);

// Mean and standard deviation of `figure` over the draws that make the figures: all but number 0.
template <class Figure>
MeanSd over_draws(std::span<const Evaluation> draws, Figure&& figure) {
  std::vector<double> values;
  for (const Evaluation& draw : draws.subspan(1)) values.push_back(figure(draw));
  return mean_sd(values);
}

// The same draws put together: their frames and their sequences, those tested in several draws each time.
Evaluation pooled(std::span<const Evaluation> draws);

// All draws: the one for choosing, and mean and standard deviation of the others beside them.
Json draws_json(std::span<const Evaluation> draws);

Json train_json(const HdSummary& summary, const HdTraining& options);

// Encoders on the command line, as the paper abbreviates them.
inline constexpr std::array encoder_words{hd::Word<hd::Encoding>{"shdc", hd::Encoding::spatial},
                                          hd::Word<hd::Encoding>{"sthdc", hd::Encoding::spatial_temporal},
                                          hd::Word<hd::Encoding>{"gsthdc", hd::Encoding::graph_spatial_temporal}};

// "CL-gstHDC".
std::string model_name(const hd::Model& model);

}  // namespace slipbench

// Tests as numbers for programs.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "detectors/hd/model.h"
#include "detectors/hd/words.h"
#include "tools/base/record/json.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/train/train_hd.h"

namespace slipbench {

// Mean and standard deviation of `figure` over the draws that make the figures: all but number 0.
template <class Figure>
MeanSd over_draws(std::span<const Evaluation> draws, Figure&& figure) {
  std::vector<double> values;
  for (const Evaluation& draw : draws.subspan(1)) values.push_back(figure(draw));
  return mean_sd(values);
}

// The same draws put together: their frames and their sequences, those tested in several draws each time.
Evaluation pooled(std::span<const Evaluation> draws);

// An evaluation: sizes, recall of slip, balanced accuracy, accuracy, the last two beside those of constant answers, recalls and
// counts, all frames and moving ones, and the delays where there are any. What does not exist is null.
Json evaluation_json(const Evaluation& evaluation);

// All draws: the one for choosing, and mean and standard deviation of the others beside them.
Json draws_json(std::span<const Evaluation> draws);

Json train_json(const HdSummary& summary, const HdTraining& options);

// The names of the paper for what makes a classifier.

// Encoders on the command line, as the paper abbreviates them.
inline constexpr std::array encoder_words{hd::Word<hd::Encoding>{"shdc", hd::Encoding::spatial},
                                          hd::Word<hd::Encoding>{"sthdc", hd::Encoding::spatial_temporal},
                                          hd::Word<hd::Encoding>{"gsthdc", hd::Encoding::graph_spatial_temporal}};

// "CL-gstHDC".
std::string model_name(const hd::Model& model);

}  // namespace slipbench

// Tests as numbers for programs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

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
nlohmann::ordered_json evaluation_json(const Evaluation& evaluation);

// All draws: the one for choosing, and mean and standard deviation of the others beside them.
nlohmann::ordered_json draws_json(std::span<const Evaluation> draws);

nlohmann::ordered_json train_json(const HdSummary& summary, const HdTraining& options);

}  // namespace slipbench

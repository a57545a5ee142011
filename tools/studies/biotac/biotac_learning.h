// The paper's networks taught and judged: who learns from what, and what their answers come to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/base/statistics/descriptive.h"
#include "tools/studies/biotac/biotac_recordings.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce::biotac {

// What one network said of an example that it had not learnt from.
struct Answer {
  std::size_t example = 0;             // its number among those that are judged
  std::uint8_t label = 0, called = 0;  // class
  double slip = 0.0;                   // probability of all classes but the first
};

// Answers to the judged frames of examples, whose label is not masked; examples without logits have none. `history`: train::history_of.
std::vector<Answer> answers_of(std::span<const train::FoldExample> examples, const train::Logits& logits, std::size_t history);

// What answers come to; NaN where it does not apply.
struct Figures {
  double accuracy = 0.0, balanced = 0.0;           // share right; mean of the shares right of the classes that occur
  double precision = 0.0, recall = 0.0, f1 = 0.0;  // of slip: all classes but the first
  double auc = 0.0;                                // of slip
};
Figures figures_of(std::span<const Answer> answers);

// Mean and standard deviation of the folds, shares of 1; folds in which a figure does not apply are left out of it.
struct Scores {
  MeanSd accuracy, balanced, precision, recall, f1, auc;
};
// `fold_of`: of each example; `counts`: which examples count at all.
Scores scores_of(
    std::span<const Answer> answers, std::span<const std::size_t> fold_of,
    const std::function<bool(std::size_t example)>& counts = [](std::size_t) { return true; });

// "76.5 +- 1.2" of shares of 1, "-" of none, the mean alone of one; and as JSON.
std::string cell(const MeanSd& share);
Json json_of(const Scores& scores);

// Of a figure that is real where a network has learnt from recordings, ours where it has learnt from the scene.
inline constexpr const char* judged_here = "not published: real recordings judged here";

// What learns and what judges.
struct Set {
  std::vector<train::FoldExample> examples;
  std::vector<std::size_t> fold_of;  // of each
  std::size_t folds = 0;
};
enum class Learns { own, other, both };

// A network that a table needs.
struct Network {
  std::string name, text;
  train::NetworkShape shape;
  std::size_t steps = 0;
  train::Scaling scaling = train::Scaling::range;
};

// Networks that the tables need: queued first, then taught together, each in a process of its own.
class Lessons {
 public:
  // `options` must outlive it. A network's steps are those of its row, four times as many with --full. Throws InputError without libtorch.
  explicit Lessons(const ReproduceOptions& options);

  // Judged on `set`, fold by fold: each network learns from the other folds of `set` (own), from all of `other` (one network judges all folds), or
  // from both. `other` may be null with own. Returns a number to ask with.
  std::size_t queue(const Set& set, const Set* other, Learns learns, const Network& network);
  // Throws InputError and Interrupted.
  void run();
  // After run(), in the order of the examples.
  [[nodiscard]] const std::vector<Answer>& answers(std::size_t lesson) const { return answers_[lesson]; }

 private:
  const ReproduceOptions& options_;
  std::vector<FoldTask> tasks_;  // of a lesson each
  std::vector<std::vector<Answer>> answers_;
};

inline constexpr const char* paper = "\"Tactile-Driven Grasp Stability and Slip Prediction\" (Robotics 2019)";

// How to get what --real takes, for a study that was given none.
std::string without_real(const char* format, const char* source);

// The adjacency in which a node is the mean of itself and its k nearest, by the electrodes' places on the core; 0: drawn_graph(). Directed, as the
// paper's. [electrodes, electrodes]
std::vector<double> nearest_graph(std::size_t k);

}  // namespace slipbench::reproduce::biotac

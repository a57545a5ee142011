// `slipbench train --recipe`: a recipe taught from a dataset, written as an ONNX file that a scene can name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/program/train/network/examples.h"
#include "tools/program/train/network/network.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::train {

struct NetworkTraining {
  std::vector<std::string> datasets;  // one or more
  Recipe recipe;                      // as it is to be: options of the command line are already in it
  std::string sensor;                 // empty: every one that fits
  bool all = false;                   // divide every trial by recipe.split and held_out, whatever a dataset's own split says
  bool divided = false;               // recipe.split or held_out was asked for: refused where a dataset's own split counts
  double held_out = 0.2;              // share of the split's groups that judge, 0 to 0.5
  std::uint64_t seed = 1;
  bool by_score = false;         // the operating point of best_point(); else:
  std::optional<double> alarms;  // false ones a minute of hold that are borne (best_point); empty: most_accurate_point
  std::string output;            // detector.onnx
  bool resume = false;
  ReadingProgress read = {};  // of each dataset
};

struct NetworkSummary {
  std::size_t trials = 0, learnt = 0, validated = 0, judged = 0;  // trials: all, and by part
  bool own_split = false;                                         // whether a dataset's own split says so
  std::string judged_from;                                        // the first dataset with trials that judge; empty: none do
  std::string judged_part;                                        // of its own split: "test"; empty: it has none
  std::vector<std::string> sensors;                               // learnt from, by the scene's names, as they come
  std::size_t frames = 0;                                         // learnt from
  std::size_t parameters = 0;                                     // of one member
  std::size_t steps = 0;                                          // of the best state, of the last member
  OperatingPoint point;                                           // chosen on validation
  double validation = 0.0;                                        // balanced accuracy over all classes there; of the ensemble
  AlarmCounts held_out;            // slip or not, of the trials that judge; nothing where held_out is 0
  double held_out_accuracy = 0.0;  // balanced, over all classes
  double held_out_alarms = 0.0;    // false ones a minute of hold; NaN: there is none
  std::string description;         // JSON, as it stands in the file
};

// A member of a training in progress.
struct MemberProgress {
  std::size_t member = 0, members = 1;
  TrainingProgress training;
};

// A dataset's own split (/mask) says which trials learn, validate and judge; a dataset without one
// is divided by the recipe (split_examples).
// The operating point is chosen on validation. The description's `trained` says: recipe, labels,
// command and data_sha256 of the datasets, split (of what has no split of its own), dataset_split
// (true where there is one), seed, held_out, trials_learnt, trials_validated, trials_judged
// (numbers of trials),
// sha256_seen (digests of the trials learnt and validated, by which `eval` knows them in any file), steps,
// parameters, figures (validation, held_out), libraries; no clock time: the same data and seed give the same bytes. The file is written to a
// temporary name, read again by the engine that runs it in a loop, compared with libtorch's own answers on real frames (1e-5), then renamed.
// OUTPUT.checkpoint holds what a killed training needs to go on, and is removed at the end. Throws InputError: data that do not fit the recipe,
// one class only, an output that exists and is no detector. `report` may throw, which ends it.
NetworkSummary train_network(const NetworkTraining& training, const std::function<void(const MemberProgress&)>& report = {});

}  // namespace slipbench::train

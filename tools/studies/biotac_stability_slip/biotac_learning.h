// Grasps and touches of BioTac SP, real and synthetic, and the paper's networks: who learns from what, and what their answers come to.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/recipes/biotac.h"
#include "tools/studies/grid.h"
#include "tools/studies/study_catalogue.h"

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

using train::biotac::electrodes;

inline constexpr std::size_t fingers = 3;  // ff, mf, th

// The hand's poses as the paper counts them.
struct Palm {
  const char* text;      // "0": degrees
  const char* imported;  // "down": the real sets' word
  const char* model;     // "hand_down.xml": the scene's
};
inline constexpr std::array<Palm, 3> palms{
    {{"0", "down", "hand_down.xml"}, {"90", "side", "hand_side.xml"}, {"45", "45", "hand_45.xml"}}};

// A grasp at the moment of the paper's snapshot, before the lift, and how it ended.
struct Grasp {
  std::vector<float> counts;  // [fingers, electrodes]
  std::string object;
  std::size_t palm = 0;  // of palms
  bool slipped = false;
};

// Of a trial with sensors ff, mf and th: one that was imported from bts3v2, or one of scenes/biotac_sp/grasp.yaml, whose snapshot is the last row
// before hold.from. Throws InputError where it is neither.
Grasp grasp_of(const TrialRecord& record);

// Throws InputError where the recordings of --data are imported: they would stand in the tables as synthetic.
void check_simulated(const std::string& path);

// Those of a dataset, read in a child process. `options`: whom it tells. Throws InputError, naming the file.
std::vector<Grasp> read_grasps(const std::string& path, const ReproduceOptions& options);
// Those of grasp.yaml: `draws` of each of its nine cells, 0: as many as it says. Throws as run_grid.
std::vector<Grasp> run_grasps(std::size_t draws, const ReproduceOptions& options);

// Each count less its mean over the grasps with that palm, over its standard deviation there (1 count at least): what does not depend on the fingers
// that a set was recorded with.
std::vector<Grasp> levelled(std::vector<Grasp> grasps);

// What a network is shown of a grasp, as an example of one frame: the counts as they are; as images [fingers, rows, columns]; by node [electrodes,
// fingers]. Label 1: slipped.
train::FoldExample as_list(const Grasp& grasp);
train::FoldExample as_image(const Grasp& grasp, const train::biotac::ImageLayout& layout);
train::FoldExample as_graph(const Grasp& grasp);

// A recording of one finger that is touched, slides or turns.
struct Touch {
  std::vector<float> counts;        // [T, electrodes], at 100 Hz
  std::vector<std::uint8_t> label;  // [T] t, n, e, s, w, cw, aw; masked where nothing touches
  std::string object;
};

inline constexpr const char* slip_scene = "scenes/biotac_sp/slip.yaml";
inline constexpr const char* random_site_scene = "scenes/biotac_sp/slip_random_site.yaml";
inline constexpr std::size_t devices = 3;  // fingers that a synthetic set is made with

// Those of a dataset, imported from BioTacSP-DoS or of one of the scenes above. `options`: whom it tells. Throws InputError, naming
// the file.
std::vector<Touch> read_touches(const std::string& path, const ReproduceOptions& options);
// Those of a scene: `draws` of each of its cells with each of `devices` fingers. Throws as run_grid.
std::vector<Touch> run_touches(const char* scene, std::size_t draws, const ReproduceOptions& options);

// What is cut out of a recording.
struct Window {
  std::size_t rows = 5, stride = 5;
  bool site = true;                                    // else each electrode's mean over the window is taken off
  const train::biotac::ImageLayout* layout = nullptr;  // frames are images
  enum class Figures { none, by_electrode, sorted } figures = Figures::none;  // one frame of figures instead of the rows
};
// The windows of one recording in which something touches throughout, as examples in which the last frame alone has a label. Figures by electrode:
// 24 standard deviations and 24 slopes of the straight line through the rows [counts a row]; sorted: the standard deviations, the smallest first.
std::vector<train::FoldExample> windows_of(const Touch& touch, const Window& window);

// The number of its fold for each of `objects`, all of one object in the same: the different ones are dealt out by train::folds. Throws InputError
// where there are fewer than `count`.
std::vector<std::size_t> folds_by_object(std::span<const std::string> objects, std::size_t count, std::uint64_t seed);

}  // namespace slipbench::reproduce::biotac

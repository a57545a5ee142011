// Networks that learn from windows of the Myrmex bench, and how well they tell others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tools/program/train/network/network.h"
#include "tools/studies/myrmex_tactile_cnn/myrmex_windows.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

// What a network is told of a window.
enum class MyrmexInput {
  spectra,       // 32 bins of each taxel, 0 to 484 Hz
  high_pass,     // those from 62.5 Hz on
  static_image,  // bin 0 alone: the sum of each taxel's counts
  load,          // the mean of that over the taxels
  clock,         // time
  placement,     // how the object was placed, and which it is
  clock_placement,
};

// Values of an input.
std::size_t inputs_of(MyrmexInput input);
// Of one window.
std::vector<float> told(const MyrmexTrial& trial, const MyrmexWindow& window, MyrmexInput input);

struct MyrmexRow {
  std::string name, text;
  std::string layers;  // recipe whose network it is; empty: 32 units, tanh
  MyrmexInput input = MyrmexInput::spectra;
  SlipWord word = SlipWord::truth;
  bool late = false;       // stable windows that it learns and is judged on are of the last half second before the onset
  std::size_t longer = 1;  // times the usual steps
  double published = std::numeric_limits<double>::quiet_NaN();  // accuracy, %
};
const char* slip_word(SlipWord word);  // "true", "bench", "motion"

// myrmex_net1 to 3, as `recipe` with what the paper prints of it.
MyrmexRow network_row(std::size_t net, MyrmexInput input, SlipWord word);

// The network of a row, from inputs to three logits.
train::NetworkShape shape_of(const MyrmexRow& row);

// Windows by class [true][called].
struct KindCounts {
  std::array<std::array<std::uint64_t, kinds>, kinds> windows{};

  void add(std::uint8_t label, std::uint8_t called) { ++windows[label][called]; }
  void add(const KindCounts& other);
  [[nodiscard]] double share(std::size_t label, std::size_t called) const;  // of those with that label; NaN of none
  // Mean share of the classes that occur which are called so; NaN where none does.
  [[nodiscard]] double accuracy() const;
};

// Stable windows that are called slip.
struct WrongCount {
  std::uint64_t wrong = 0, all = 0;
  void add(bool is_wrong) {
    ++all;
    wrong += is_wrong ? 1 : 0;
  }
  void add(const WrongCount& other) {
    wrong += other.wrong;
    all += other.all;
  }
  [[nodiscard]] double share() const;  // NaN of none
};

// Of one network.
struct MyrmexFold {
  KindCounts counts;
  // Stable windows: of the last half second before the onset, all of them; of those drawn: earlier, and of trials that hold.
  WrongCount late, earlier, holds;
};

struct MyrmexFigures {
  std::vector<KindCounts> folds;
  WrongCount late, earlier, holds;  // of all folds

  [[nodiscard]] KindCounts all() const;
};

// The classes that a network calls the windows of `judged` [judged.size() x inputs] after it has learnt `learnt`: standardised by what is learnt,
// the last state, of equals the earlier class. Throws InputError as make_network, std::invalid_argument as Network::train.
std::vector<std::uint8_t> called_kinds(const train::NetworkShape& shape, train::FrameSequence learnt, train::FrameSequence judged,
                                       const train::TrainingOptions& training);

struct MyrmexSize {
  std::size_t draws = 0;   // trials of each of the scene's eight cells
  std::size_t steps = 0;   // of a row's usual training
  std::size_t turned = 0;  // WindowOptions::turned
};
// Throws InputError: no libtorch, too few trials for the folds.
MyrmexSize myrmex_size(const ReproduceOptions& options);
inline constexpr std::size_t trial_folds = 5;

// The trials of scenes/myrmex/dataset.yaml. Throws InputError and Interrupted, and InputError where a class has no window.
std::vector<MyrmexTrial> myrmex_trials(const ReproduceOptions& options, const MyrmexSize& size);

// Rows judged by splits: queued first, then run together, each network in a process of its own.
class MyrmexValidations {
 public:
  // All three must outlive it.
  MyrmexValidations(const ReproduceOptions& options, const MyrmexSize& size, const std::vector<MyrmexTrial>& trials)
      : options_(options), size_(size), trials_(trials) {}

  // Folds `first` to `last` - 1 of `count` (of objects of as many as there are) judge, one network each. Returns a number to ask with.
  std::size_t queue(const MyrmexRow& row, MyrmexSplit split, std::size_t count, std::size_t last);
  // Throws InputError and Interrupted.
  void run();
  [[nodiscard]] const MyrmexFigures& figures(std::size_t validation) const { return results_[validation]; }

 private:
  struct Plan {
    MyrmexRow row;
    MyrmexSplit split{};
    std::vector<WindowPlace> places;
    std::vector<std::size_t> fold_of;
  };
  [[nodiscard]] MyrmexFold judged(const Plan& plan, std::size_t fold) const;

  const ReproduceOptions& options_;
  const MyrmexSize& size_;
  const std::vector<MyrmexTrial>& trials_;
  std::vector<Plan> plans_;
  std::vector<std::pair<std::size_t, std::size_t>> tasks_;  // validation and fold
  std::vector<MyrmexFigures> results_;
};

// Seconds of one window through a row's network, one thread: the median of many.
double forward_seconds(const MyrmexRow& row);

std::string percent_text(double share);  // "96.4"; "-" of NaN

// How it was measured, of both tables.
std::vector<std::string> myrmex_setup(const ReproduceOptions& options, const MyrmexSize& size,
                                      const std::vector<MyrmexTrial>& trials);
inline constexpr const char* myrmex_source = "\"Tactile Convolutional Networks for Online Slip and Rotation Detection\"";

}  // namespace slipbench::reproduce

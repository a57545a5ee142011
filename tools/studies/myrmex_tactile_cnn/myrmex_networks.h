// Networks that learn from windows of the Myrmex bench, and how well they tell others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/train/network/network.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

// Windows of the Myrmex bench as networks learn from them: spectra, and classes by the paper's rule and by the truth.

inline constexpr std::size_t kinds = 3;  // classes of train::ClassRule::kind: stable, translation, rotation

// Whose word it is that the object slips, and how.
enum class SlipWord {
  truth,   // from the true onset (true_slip) to the end of contact; class by how the object was placed
  bench,   // the paper's: from the onset by the third sensor to the end of contact by the arrays; class likewise
  motion,  // as truth, but the class is that of the slipping taxels' motion, ClassRule::kind
};
inline constexpr std::size_t slip_words = 3;

inline constexpr double last_seconds = 0.5;  // before the true onset: the windows that are hard to tell

// One window of one array; class and time are those of its last sample.
struct MyrmexWindow {
  double time = 0.0;                                           // s
  double to_onset = std::numeric_limits<double>::quiet_NaN();  // s, from here to the true onset; NaN: the trial holds
  std::array<std::uint8_t, slip_words> label{};                // by SlipWord; train::masked: after the end
  std::array<bool, slip_words> drawn{};                        // is one of those that are learnt from and judged, by SlipWord
  std::uint8_t turn = 0;       // its images are turned by so many times 30 degrees; such a copy only learns
  std::vector<float> spectra;  // [12 x 12 taxels, 32 bins] amplitudes

  [[nodiscard]] bool late() const { return to_onset > 0.0 && to_onset <= last_seconds; }
};

struct MyrmexTrial {
  std::string object;       // "cylinder", "remote", "glass"
  bool rotational = false;  // its centre of mass lies to the side of the grip
  bool slips = false;       // by the truth
  std::vector<MyrmexWindow> windows;
};

// How an object falls out of the grip, in s of the trial.
struct SlipSpan {
  std::optional<double> onset;  // empty: it holds
  double end = 0.0;             // of contact
};

// The class at time t of a trial that slips by `span` with class `kind`; train::masked after the end.
std::uint8_t kind_at(double t, const SlipSpan& span, std::uint8_t kind);

struct WindowOptions {
  std::size_t at_most = 60;  // drawn of each class, array and word
  std::size_t turned = 0;    // copies of each window with its image turned, 0 to 11; the angles are drawn by trial
  std::uint64_t seed = 1;    // of RandomStream(seed, trial, "windows")
};

// Where a window is.
struct WindowPlace {
  std::size_t trial = 0, window = 0;
};

// As many of each class, of those that are not turned: of the drawn windows by `word`, all of the rarest class; the others are drawn by
// RandomStream(seed, 0, "balance"). `late`: the stable ones are late(). Ordered by trial and window.
std::vector<WindowPlace> balanced_windows(const std::vector<MyrmexTrial>& trials, SlipWord word, bool late, std::uint64_t seed);

// What no network is judged on after it has learnt from it.
enum class MyrmexSplit {
  window,  // the paper's: of each class every n-th window in turn; its neighbours, which share 56 of its 64 ms, are learnt from
  trial,   // trials, dealt out by object, placement and whether they slip
  object,  // cylinder, remote, glass
};

// The fold of each place: of `count`, of objects as many as there are.
std::vector<std::size_t> window_folds(const std::vector<MyrmexTrial>& trials, const std::vector<WindowPlace>& places,
                                      SlipWord word, MyrmexSplit split, std::size_t count, std::uint64_t seed);

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

// Slip of an object between two arrays: when it begins by the truth, and when by the rule of the Myrmex paper (section 2.2).

// scenes/myrmex/dataset.yaml: the third sensor rests on the object, the arms begin to move [s].
inline constexpr double bench_settled = 2.0, bench_apart = 2.5;

// A sensor of that scene. Throws std::logic_error where the record has none of that name.
const SensorRecord& bench_sensor(const TrialRecord& record, std::string_view name);
// "cylinder", "remote" or "glass", by the shape.
std::string object_name(const BodyScene& body);
// Whether its centre of mass lies 5 mm or more to the side of the grip, so that it turns when it slips.
bool is_rotational(const BodyScene& body);

// The paper's rule: "the onset of slippage is the time when the sum of contacts on the third sensor started to decrease". What it
// leaves open:
struct OnsetRule {
  double window;     // s, over whose samples up to each the sum is averaged; 0: not at all
  double threshold;  // below its mean while nothing moves, in standard deviations of the averaged sum then
};

// The last sample's time at which the averaged `sum` falls to more than the threshold below its mean in [from, to) and stays
// there up to `end` [s]; empty: it does not stand below at the end, or there is none. `least`: in the unit of `sum`, by how much
// it must fall at least.
std::optional<double> decrease_onset(std::span<const double> time, std::span<const double> sum, const OnsetRule& rule,
                                     double from, double to, double end, double least = 0.0);

// Of each sample, the mean of `values` over the samples of the last `window` [s] up to it; 0: the values themselves.
std::vector<double> backward_mean(std::span<const double> time, std::span<const double> values, double window);

// Of each sample, the sum of 4095 - counts over all taxels of a myrmex.
std::vector<double> sum_of_contacts(const SensorRecord& sensor);

// Share of a pad's normal force, sample by sample, that slipping units carry; 0 where nothing touches.
std::vector<double> slipping_share(const SensorRecord& sensor);

// When the object begins to slip: the first sample's time from which on, as long as both pads touch, slipping taxels carry at
// least half of the normal force on both. At the limit of friction that is so of a translation and of a turn, whose centre
// sticks. Empty: it is not so at the end. `end`: the last sample at which both pads touch [s].
struct TrueSlip {
  std::optional<double> onset;
  double end = 0.0;
};
TrueSlip true_slip(const SensorRecord& left, const SensorRecord& right, double from);

// The end by the paper's rule, "no more contacts were detected on the sensors holding the object". What it leaves open is what a
// contact is:
struct ContactGate {
  bool of_sum;    // of an array: its sum of contacts; else its taxel that misses most counts
  double window;  // s, over whose samples up to each that is averaged; 0: not at all
  double counts;  // that must be missing; more is a contact
};
// An array's sum, mean of 20 ms, 5 sd above what its noise alone makes it, since in a trial it has some thousand independent means.
ContactGate sum_end();
inline constexpr double taxel_noise_sd = 9.0 / 1024.0 * 4095.0;  // counts, of a resting taxel (sensors/myrmex: 9 of 1,024)

// The last sample at which either array has a contact [s]; 0: there is none.
double contact_end(const SensorRecord& left, const SensorRecord& right, const ContactGate& gate);

// How far the body's centre of mass lies to the side of the grip, along Y [m]: what makes a trial one of rotation.
double side_of_mass(const BodyScene& body);

}  // namespace slipbench::reproduce

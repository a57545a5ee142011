// Networks that learn from recordings of the piezoelectric skin's bench, and how well they judge others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "detectors/network/description.h"
#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/train/network/examples.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/sequences.h"
#include "tools/studies/grid.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

// Recordings of the piezoelectric skin's bench as networks learn from them.
inline constexpr const char* piezo_bench_scene = "scenes/piezo_skin/dataset.yaml";

// The frames of a recording, and what each is by either label.
struct PiezoFrames {
  std::vector<float> features;             // [T, F]
  std::vector<std::uint8_t> truth, paper;  // [T] 1: slip

  [[nodiscard]] train::FrameSequence by(train::LabelRule rule) const {
    return {features, rule == train::LabelRule::micro ? truth : paper};
  }
};

// A recording, its signal already turned into frames.
struct PiezoRecording {
  double level = 0.0;                                            // of the motors' vibration; NaN: the dataset does not say
  std::string tip;                                               // what was swept but the motion; equal texts are equal tips
  bool motors_only = true;                                       // nothing ever touches
  double slip_time = std::numeric_limits<double>::quiet_NaN();   // s, the true first slip of a part; NaN: none
  double label_time = std::numeric_limits<double>::quiet_NaN();  // s, the first sample that slips by the position; NaN: none
  std::vector<PiezoFrames> inputs;                               // of each kind that was asked for
  // Of the frames of the first kind, [T]: what no network is shown.
  std::vector<double> time;           // s, of the last sample
  std::vector<std::uint8_t> contact;  // 1: something touches then
  std::vector<float> motors;          // m/s, the sum of the speeds of all axes whose motors run then
};

// What the tables' networks eat: the published band, the whole spectrum cut to a band [Hz], the signal at 100 Hz.
network::Input published_spectra();
network::Input spectra_of(double low, double high);
network::Input signal_at_100_hz();

// Which motors run: in half of the scene's recordings one that does not move the tip, or in none.
enum class Motors { others_too, of_the_tip };

// Runs the published bench, scenes/piezo_skin/dataset.yaml, at each level: `recordings` of them, half with a slip and half of
// motors alone. Throws InputError, Interrupted.
std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const std::vector<network::Input>& inputs, const ReproduceOptions& options,
                                           Motors motors = Motors::others_too);

// The same from a dataset, whose levels are those that it swept. Throws InputError.
std::vector<PiezoRecording> read_recordings(const std::string& path, const std::vector<network::Input>& inputs);

// What a recording is for those above. Throws InputError when no sensor is a piezo_skin.
PiezoRecording make_recording(const TrialRecord& record, const std::vector<network::Input>& inputs);

// What a shortcut is told of each frame.
struct Told {
  bool time = false, contact = false, motors = false, kind = false;  // kind: whether the recording is of motors alone

  [[nodiscard]] std::size_t values() const {
    return std::size_t{time} + std::size_t{contact} + std::size_t{motors} + std::size_t{kind};
  }
};

inline constexpr std::size_t fold_count = 5;
inline constexpr std::size_t with_slip = 0, motors_alone = 1;  // groups of recordings

// A row of a table: a network, what it eats and what the paper says of it.
struct NetworkRow {
  std::string name, text;
  train::NetworkShape shape;
  train::TrainingOptions training = {};  // of the default size
  std::size_t input = 0;                 // PiezoRecording::inputs
  Told told = {};                        // a shortcut eats this instead
  std::size_t later = 0;                 // frames after the one that is named, which it has seen
  double f1 = std::numeric_limits<double>::quiet_NaN(),
         accuracy = std::numeric_limits<double>::quiet_NaN();  // paper's, 0 to 1, %
};

// A recipe's network, as it teaches it.
NetworkRow row_of(const char* name, const char* text, const char* recipe, double f1, double accuracy);
// The networks of every table.
NetworkRow mlp_32();
NetworkRow gru_32();

// What the options make of a study's size.
struct StudySize {
  std::size_t recordings = 0;  // of each level
  bool full = false;  // 200 epochs, the best state by a fifth of the recordings learnt from; else a row's own, the last state

  [[nodiscard]] train::Validation training(const NetworkRow& row, std::uint64_t seed) const;
};
inline constexpr std::size_t published_recordings = 3200, usual_recordings = 200;

// `usual`: recordings by default. Throws InputError: no libtorch, too few recordings, --trials with --data.
StudySize size_of(const ReproduceOptions& options, std::size_t usual);

// Those of --data, or run at these levels. Throws InputError where too few of them slip for the folds.
std::vector<PiezoRecording> recordings_for(const ReproduceOptions& options, const StudySize& size,
                                           const std::vector<double>& levels, const std::vector<network::Input>& inputs,
                                           Motors motors = Motors::others_too);

inline constexpr double bench_level = 2.0;  // of the motors, in dataset.yaml

// As examples of a row, by a label. What convolutions look back to before a recording is its first frame again, and what they see after it its
// last: so all frames are judged. An answer that has seen `later` frames stands so many frames after the one that it names.
std::vector<train::FoldExample> examples_of(const std::vector<PiezoRecording>& recordings, const NetworkRow& row,
                                            train::LabelRule rule);

// with_slip or motors_alone, of each.
std::vector<std::size_t> groups_of(const std::vector<PiezoRecording>& recordings);

using GroupCounts = std::array<Confusion, 2>;  // of with_slip and of motors_alone

// Mean and standard deviation of the folds; NaN where there is none.
struct NetworkFigures {
  MeanSd accuracy, f1;  // balanced, %; of slip, 0 to 1
};
NetworkFigures on_slip(const std::vector<GroupCounts>& folds);  // on recordings with a slip
NetworkFigures on_all(const std::vector<GroupCounts>& folds);
MeanSd motors_right(const std::vector<GroupCounts>& folds);  // share of the frames of motors alone that are called hold, %

// "96.2 +- 0.8, 0.885", "-" of none; and as JSON.
std::string cell(const NetworkFigures& figures);
std::string cell(const MeanSd& percent);
Json json_of(const NetworkFigures& figures);
// {"on_slip_and_noise", "on_slip", "motors_right"}
Json json_of(const std::vector<GroupCounts>& folds);
// "98.70, 0.978" of the paper's.
std::string paper_cell(const NetworkRow& row);

const char* label_name(train::LabelRule rule);  // "position", "true"

// What is said of every table: how it was measured, and what differs.
std::vector<std::string> setup_lines(const ReproduceOptions& options, const StudySize& size, std::size_t recordings);
inline constexpr const char* table_source =
    "\"Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor\". Cells are balanced accuracy in % and F1 of slip.";

// Validations that the tables need: queued first, then run together, each network in a process of its own.
class Validations {
 public:
  // `options` must outlive it.
  Validations(const ReproduceOptions& options, StudySize size) : options_(options), size_(size) {}

  // One network for each fold of `fold_of`. `slip_alone`: it learns from recordings with a slip alone. Returns a number to ask
  // with.
  std::size_t queue(const std::vector<PiezoRecording>& recordings, const std::vector<std::size_t>& fold_of, const NetworkRow& row,
                    train::LabelRule rule, bool slip_alone = false);
  // Five folds by recording, with and without a slip dealt out apart.
  std::size_t queue_folds(const std::vector<PiezoRecording>& recordings, const NetworkRow& row, train::LabelRule rule,
                          bool slip_alone = false);
  // Throws InputError and Interrupted.
  void run();

  // After run(): fold by fold, and what each recording's frames are called by the network that has not learnt it.
  [[nodiscard]] const std::vector<GroupCounts>& folds(std::size_t validation) const { return results_[validation].folds; }
  [[nodiscard]] const train::Calls& calls(std::size_t validation) const { return results_[validation].calls; }

 private:
  struct Outcome {
    std::vector<GroupCounts> folds;
    train::Calls calls;
  };

  const ReproduceOptions& options_;
  StudySize size_;
  std::vector<FoldTask> tasks_;   // of a validation each
  std::vector<Outcome> results_;  // of each validation
};

// When a network that names every frame has noticed a slip.

// From `onset` [s] to the beginning of the alarm that is on then, which is negative, or else of the first one after it. `time` [s] and `called`
// (1: slip) of each frame. NaN: none is on then or comes after it. The paper's mean of 8.5 ms counts so: its delays may be negative.
double alarm_delay(std::span<const double> time, std::span<const std::uint8_t> called, double onset);

// Over recordings.
struct Alarms {
  Delays first;              // the first alarm decides, an early one has no delay (Detection)
  std::vector<double> near;  // s, alarm_delay() of those that slip, where there is one
  std::size_t silent = 0;    // those that slip and have none

  // `onset` [s]; NaN: never.
  void add(std::span<const double> time, std::span<const std::uint8_t> called, double onset);
};

// A spread of times [s].
struct DelaySpread {
  double mean = std::numeric_limits<double>::quiet_NaN(), sd = mean, median = mean, p10 = mean, p90 = mean, greatest = mean;
};
// NaN of none; the sd of fewer than two.
DelaySpread delay_spread(const std::vector<double>& times);
Json json_of(const DelaySpread& spread);
// "12 (3 to 40)": median, 10 and 90 % in ms; "-" of none.
std::string cell(const DelaySpread& spread);

}  // namespace slipbench::reproduce

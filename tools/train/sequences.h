// Training sequences for a slip detector from a dataset: PapillArray frames at 100 Hz with the
// truth of each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "sim/api/pad_state.h"
#include "tools/learning_data/label_rules.h"
#include "tools/learning_data/samples.h"

namespace slipbench {

inline constexpr double detector_rate = 100.0;  // Hz, of the published detector

// Displacements of the nine pillars [m], x, y, z of P0, then of P1, ... in the sensor's frame.
using Displacements = std::array<float, 27>;

// One trial.
struct Sequence {
  std::size_t trial = 0;
  std::string sha256;      // the trial's digest (trial_identity)
  std::string part;        // in the dataset's own split: "train", "valid", "test", or "none"; empty: no masks
  CommandedMotion motion;  // all 0 in a grasp, whose pad has no commanded motion
  double onset = std::numeric_limits<double>::quiet_NaN();  // s, true start of slip by the rule of the labels; NaN: no slip
  std::size_t dataset = 0;                                  // index of its file in the training
  std::vector<double> time;                                 // [T] s
  std::vector<double> path;                                 // [T] m, path that the object has slipped; empty: unknown
  std::vector<Displacements> displacements;                 // [T]
  std::vector<PadState> label;                              // [T] by the rule of the labels; no_contact without contact
  std::vector<std::uint8_t> moving;                         // [T] 1 while the pad translates or rotates
};

struct TrainingData {
  std::string command;  // command that wrote the dataset
  std::string sensor;   // of its first trial
  std::vector<Sequence> sequences;
};

struct SequenceOptions {
  LabelRule labels = LabelRule::paper;
  std::string sensor;  // empty: the only PapillArray of the dataset
};

// Reads every trial of all shards. A frame is every n-th sample of the sensor, beginning with the
// first, as in the detector's loop; its label is that of the sample. `onset` is resolved within the
// step: the first event `slip` of a pillar for the labels strict, of a part of a pillar for the
// others, since the paper's camera sees the tip as soon as a part detaches. has_slipped uses the
// threshold default_label_speed on every sample of the sensor, not on frames alone. Throws
// InputError, naming the file, unless it is a complete dataset of PapillArrays, on a stage or in a
// grasp, with a rate that is a multiple of 100 Hz.
TrainingData read_sequences(const std::string& dataset_path, const SequenceOptions& options);

// Draws from a dataset: number 0 selects parameters, the others give the figures (paper, section
// IV.A).
inline constexpr std::size_t draw_count = 6;

// Condition of a sequence: the band of its commanded compression (up to 0.75, 1, 1.125 mm and
// above, as the paper's contexts) and the octave of its commanded speed (nearest power of two in
// mm/s; of a corner pillar if the rotation is faster). Equal numbers are equal conditions.
std::size_t condition_of(const CommandedMotion& motion);

// Number of times that each item is used for training in a draw; items with 0 are its test.
struct BootstrapDraw {
  std::vector<std::uint32_t> times;

  [[nodiscard]] bool tests(std::size_t item) const { return times[item] == 0; }
  [[nodiscard]] std::size_t training_size() const;  // number of items, with repeats
  [[nodiscard]] std::size_t distinct() const;       // number of distinct training items
};

// Conditional bootstrap: draws as many items of each condition as it has, with replacement, by
// RandomStream(seed, draw, "bootstrap"). `conditions`: one per item. On average (1 - 1/n)^n of the
// n items of a condition are left for the test: 35 % of 10.
BootstrapDraw bootstrap(std::span<const std::size_t> conditions, std::uint64_t seed, std::size_t draw);

// Results over sequences; `early`, `missed` and the like as in Detection
// (tools/dataset/record/trial_record.h): the first frame called slip decides.
struct Delays {
  std::vector<double>
      delay;              // s, of the seen sequences: from the true onset to the first frame called slip, which is at or after it
  std::size_t early = 0;  // sequences with slip and a frame before the onset called slip
  std::size_t missed = 0;        // sequences with slip and no frame called slip
  std::size_t false_alarms = 0;  // sequences without slip and a frame called slip
  std::size_t slipping = 0;      // sequences with slip: delay.size() + early + missed
  std::size_t sequences = 0;     // all sequences

  // Adds a sequence: times of its judged frames [s], ascending, and their assigned classes. `onset`
  // [s]; NaN: no slip.
  void add(std::span<const double> time, std::span<const PadState> called, double onset);
  void add(const Delays& other);
};

}  // namespace slipbench

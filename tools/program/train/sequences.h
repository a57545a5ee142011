// The trials of a dataset as a slip detector learns from them: PapillArray frames at 100 Hz, and the truth beside each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "sim/core/pad_state.h"
#include "tools/program/samples/samples.h"

namespace slipbench {

inline constexpr double detector_rate = 100.0;  // Hz, of the published detector

// Displacements of the nine pillars [m], x, y, z of P0, then of P1, ... in the sensor's own frame.
using Displacements = std::array<float, 27>;

// One trial.
struct Sequence {
  std::size_t trial = 0;
  std::string sha256;      // the trial's digest (trial_identity)
  std::string part;        // of the dataset's own split: "train", "valid", "test", or "none"; empty: the dataset has no masks
  CommandedMotion motion;  // all 0 in a grasp, whose pad no motion commands
  double onset =
      std::numeric_limits<double>::quiet_NaN();  // s, true begin of slip by the rule of the labels; NaN: it never slips
  std::vector<double> time;                      // [T] s
  std::vector<Displacements> displacements;      // [T]
  std::vector<PadState> label;                   // [T] by the rule of the labels; no_contact where nothing touches
  std::vector<std::uint8_t> moving;              // [T] 1 while the pad slides or turns
};

struct TrainingData {
  std::string command;  // that made the dataset
  std::string sensor;   // of its first trial
  std::vector<Sequence> sequences;
};

struct SequenceOptions {
  SlipRule labels = SlipRule::paper;
  std::string sensor;  // empty: the only PapillArray of the dataset
};

// Reads every trial, all shards. A frame is every n-th sample of the sensor, the first one included, as the detector in the loop
// takes them; its label is that sample's own. `onset` is resolved inside the step: the first event `slip` of a pillar for the
// labels strict, the first of a part of a pillar for the others: the paper's camera sees the tip as soon as a part lets go.
// has_slipped has the threshold default_label_speed, and sees every sample of the sensor, not the frames alone.
// Throws InputError, naming the file, for what is no complete dataset of PapillArrays, on a stage or in a grasp, whose rate is a
// multiple of 100 Hz.
TrainingData read_sequences(const std::string& dataset_path, const SequenceOptions& options);

// Draws made of a dataset: number 0 is for choosing parameters, the others make the figures (paper, section IV.A).
inline constexpr std::size_t draw_count = 6;

// The condition of a sequence: the band of its commanded compression (up to 0.75, 1, 1.125 mm and above, as the paper's contexts)
// and the octave of its commanded speed (nearest power of two in mm/s; that of a corner pillar where the turn is the faster). Equal
// numbers are equal conditions.
std::size_t condition_of(const CommandedMotion& motion);

// How often each item trains in a draw; those that never do are its test.
struct BootstrapDraw {
  std::vector<std::uint32_t> times;

  [[nodiscard]] bool tests(std::size_t item) const { return times[item] == 0; }
  [[nodiscard]] std::size_t training_size() const;  // items, repeats counted
  [[nodiscard]] std::size_t distinct() const;       // items that train at all
};

// Conditional bootstrap: of each condition as many items are drawn as it has, with replacement, by RandomStream(seed, draw,
// "bootstrap"). `conditions`: one an item. Of n items of a condition (1 - 1/n)^n are left for the test on average: 35 % of 10.
BootstrapDraw bootstrap(std::span<const std::size_t> conditions, std::uint64_t seed, std::size_t draw);

// Over sequences; `early`, `missed` and the like are those of Detection (tools/base/record/trial_record.h): the first frame that is called slip
// decides.
struct Delays {
  std::vector<double>
      delay;              // s, of the sequences seen: from the true onset to the first frame called slip, which is at or after it
  std::size_t early = 0;  // of those that slip: a frame before the onset was called slip
  std::size_t missed = 0;        // of those that slip: no frame was
  std::size_t false_alarms = 0;  // of those that do not: a frame was
  std::size_t slipping = 0;      // sequences that slip: delay.size() + early + missed
  std::size_t sequences = 0;     // all

  // Adds a sequence: times of its judged frames [s], ascending, and what each was called. `onset` [s]; NaN: it never slips.
  void add(std::span<const double> time, std::span<const PadState> called, double onset);
  void add(const Delays& other);
};

}  // namespace slipbench

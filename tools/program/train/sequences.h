// The trials of a dataset as a slip detector learns from them: PapillArray frames at 100 Hz, and the truth beside each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sim/core/pad_state.h"
#include "tools/program/samples/commanded_motion.h"
#include "tools/program/samples/samples.h"

namespace slipbench {

inline constexpr double detector_rate = 100.0;  // Hz, of the published detector

// Displacements of the nine pillars [m], x, y, z of P0, then of P1, ... in the sensor's own frame.
using Displacements = std::array<float, 27>;

// One trial.
struct Sequence {
  std::size_t trial = 0;
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
// multiple of 100 Hz. Reads in a child process (tools/base/dataset/guarded.h).
TrainingData read_sequences(const std::string& dataset_path, const SequenceOptions& options);

}  // namespace slipbench

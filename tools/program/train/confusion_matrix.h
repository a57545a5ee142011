// What a test gave, in numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/pad_state.h"

namespace slipbench {

// Counts of frames by what is true and what was called: classes 0 non-slip, 1 incipient, 2 gross.
class ConfusionMatrix {
 public:
  // Both any state but no_contact.
  void add(PadState truth, PadState called) { ++counts_[index(truth)][index(called)]; }
  void add(const ConfusionMatrix& other);

  [[nodiscard]] std::uint64_t count(PadState truth, PadState called) const { return counts_[index(truth)][index(called)]; }
  [[nodiscard]] std::uint64_t total() const;
  // Share of frames called right; NaN of none.
  [[nodiscard]] double accuracy() const;
  // Share of the frames of a class that were called so; NaN where the class does not occur.
  [[nodiscard]] double recall(PadState truth) const;
  // Mean of the recalls of the classes that occur; NaN of none.
  [[nodiscard]] double balanced_accuracy() const;

 private:
  static std::size_t index(PadState state) { return static_cast<std::size_t>(state) - 1; }

  std::array<std::array<std::uint64_t, 3>, 3> counts_{};
};

// When slip was noticed, over sequences.
struct Delays {
  std::vector<double> delay;  // s, from the true onset to the first frame at or after it that is called slip, of those not early
  std::size_t early = 0;      // the last frame before the onset was called slip already: nothing is left to notice
  std::size_t missed = 0;     // sequences that slip, and no frame from then on is called slip
  std::size_t false_alarms = 0;  // sequences with a frame called slip before the onset, or in which nothing ever slips
  std::size_t slipping = 0;      // sequences that slip
  std::size_t sequences = 0;     // all

  // Adds a sequence: times of its judged frames [s], ascending, and what each was called. `onset` [s]; NaN: it never slips.
  void add(std::span<const double> time, std::span<const PadState> called, double onset);
  void add(const Delays& other);
};

}  // namespace slipbench

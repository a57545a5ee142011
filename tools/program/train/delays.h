// When slip was noticed.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/core/pad_state.h"

namespace slipbench {

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

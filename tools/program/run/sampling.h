// When a pad's sensor reads the contact, and when that completes a sample.
#pragma once

#include <cstddef>

namespace slipbench {

// Ticks are the pad's own (simulation.h).
struct Sampling {
  std::size_t stride = 1;  // ticks between two readings
  std::size_t scans = 1;   // readings a sample (Sensor::scans)

  [[nodiscard]] bool reads_at(std::size_t tick) const { return tick % stride == 0; }
  [[nodiscard]] bool completes_at(std::size_t tick) const { return tick % ticks() == (scans - 1) * stride; }
  // Ticks between two samples.
  [[nodiscard]] std::size_t ticks() const { return stride * scans; }
  // Samples that are complete in a trial of so many ticks.
  [[nodiscard]] std::size_t samples(std::size_t trial_ticks) const { return ((trial_ticks + stride - 1) / stride) / scans; }
};

}  // namespace slipbench

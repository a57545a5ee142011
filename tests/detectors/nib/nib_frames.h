// Artificial frames of a nib pad at 300 Hz.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "detectors/nib/features.h"
#include "sim/api/detector.h"

namespace slipbench::nib {

inline FrameSource nib_source(double rate = 300.0) {
  return {
      "pad", "nib_pad", rate, {{"si", "counts", {taxels, electrodes}, {}}, {"fl", "counts", {2}, {}}, {"fr", "counts", {2}, {}}}};
}

// A pad whose electrodes all read 6960 counts, plus changes.
class NibFrames {
 public:
  NibFrames() { values_.fill(baseline); }

  // Changes all taxels alike, in the order W, N, E, S.
  void load(const std::array<float, electrodes>& change) {
    for (std::size_t i = 0; i < taxels * electrodes; ++i) values_[i] = baseline + change[i % electrodes];
  }
  // Sets the differences of the clusters from now on: a cosine of `amplitude` [counts] at 4 Hz.
  void vibrate(double linear, double rotational) {
    linear_ = linear;
    rotational_ = rotational;
  }

  SensorFrame next() {
    const double time = static_cast<double>(++frames_) / 300.0, tone = std::cos(2.0 * std::numbers::pi * 4.0 * time);
    values_[36] = baseline + static_cast<float>(linear_ * tone);
    values_[38] = baseline + static_cast<float>(rotational_ * tone);
    return {time, values_};
  }
  [[nodiscard]] int frames() const { return frames_; }

 private:
  static constexpr float baseline = 6960.0F;
  std::array<float, 40> values_{};
  double linear_ = 0.0, rotational_ = 0.0;
  int frames_ = 0;
};

}  // namespace slipbench::nib

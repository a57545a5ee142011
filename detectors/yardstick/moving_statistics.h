// Mean and standard deviation of several values over the latest frames.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slipbench {

// Keeps `frames` frames of `size` values. Sums are kept of the differences from the first frame, so
// that a large level costs no digits.
class MovingStatistics {
 public:
  // `frames` >= 2, `size` >= 1.
  MovingStatistics(std::size_t frames, std::size_t size);

  // Takes the next frame, [size].
  void push(std::span<const float> values);
  // True once `frames` frames have been taken. The functions below need it.
  [[nodiscard]] bool full() const { return seen_ >= frames_; }

  // Mean of value `i` over the latest `frames` frames.
  [[nodiscard]] double mean(std::size_t i) const;
  // Standard deviation of value `i` over the latest `frames` frames, with the divisor `frames`.
  [[nodiscard]] double deviation(std::size_t i) const;
  // Value `i` of the latest frame less that of the earliest of the latest `frames` frames.
  [[nodiscard]] double change(std::size_t i) const;

 private:
  std::size_t frames_, seen_ = 0;
  std::vector<double> past_;     // [frames, size], a ring of differences from first_
  std::vector<double> first_;    // [size], the first frame
  std::vector<double> sum_;      // [size] of past_
  std::vector<double> squares_;  // [size] of the squares of past_
};

}  // namespace slipbench

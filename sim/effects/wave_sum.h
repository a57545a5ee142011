// Sums of waves with a whole number of waves per period.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace slipbench {

// Fast Fourier transform of Cooley and Tukey [cooley1965], radix 2. Eigen's and FFTW's take their
// sines from the C library, whose bits depend on the processor.
class WaveSum {
 public:
  // `points`: number of points per period, evenly spaced; a power of two.
  explicit WaveSum(std::size_t points);

  // Returns at point k: Re sum_n waves[n] exp(2 pi i n k/points). `waves`: complex amplitudes, at
  // most `points`.
  [[nodiscard]] std::vector<double> at_points(std::span<const std::complex<double>> waves) const;

 private:
  std::vector<std::complex<double>> turn_;  // exp(2 pi i k/points), half a period of them
};

}  // namespace slipbench

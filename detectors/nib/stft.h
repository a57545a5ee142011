// Short-time spectra of a sampled signal, as the nib pad's slip detection takes them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "detectors/spectral/spectral_features.h"

namespace slipbench::nib {

// Spectrum of one stretch of N samples d_n:
//   X_k = sum_n w_n (d_n - l_n) exp(-2 pi i k n/N),  k = 0 to N/2
// l: the straight line of least squares through d; w_n = 0.54 - 0.46 cos(2 pi n/N), Hamming's window with period N, whose sum is 0.54 N exactly.
// Nothing is divided by: |X_k| is in the samples' own unit, and a sine of amplitude A at the middle of a bin has |X_k| = 0.54 N A/2, less
// what the line takes from it.
class WindowSpectrum {
 public:
  // `size`: N, at least 4; `rate` [Hz] of the samples.
  WindowSpectrum(std::size_t size, double rate);

  [[nodiscard]] std::size_t size() const { return window_.size(); }
  [[nodiscard]] double bin_width() const { return rate_ / static_cast<double>(size()); }  // Hz, rate/N

  // |X_k| of `samples`, which must be N: [N/2 + 1]. Valid until the next call.
  std::span<const double> magnitudes(std::span<const double> samples);

 private:
  double rate_;  // Hz
  RealFft fft_;
  std::vector<double> window_, magnitudes_;
};

// Spectra of a signal as it comes in: one of the last `window`, a `hop` after the other.
class SlidingSpectrum {
 public:
  // Both lengths in samples; `hop` at least 1.
  SlidingSpectrum(std::size_t window, std::size_t hop, double rate);

  // Takes the next sample. Whether it completed a window whose spectrum is due: the first when `window` samples are there, then
  // every `hop`.
  bool push(double sample);

  // Mean of the magnitudes of the spectrum made last over the bins from `low` to `high` [Hz], both included; 0 before the first.
  // Throws std::invalid_argument where no bin is between them.
  [[nodiscard]] double band_mean(double low, double high) const;
  // The spectrum made last; empty before the first.
  [[nodiscard]] std::span<const double> magnitudes() const { return magnitudes_; }

 private:
  WindowSpectrum spectrum_;
  std::size_t hop_;
  std::vector<double> ring_, ordered_, magnitudes_;
  std::size_t next_ = 0;  // place in the ring
  std::size_t missing_;   // samples until the next spectrum
};

}  // namespace slipbench::nib

// The discrete Fourier transform of real numbers, by FFTW.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace slipbench {

// X_k = sum_n x_n exp(-2 pi i k n/N), k = 0 .. N/2. The plan uses FFTW_ESTIMATE, because plans
// chosen by timing would round differently from run to run. Several threads may make, use and
// destroy objects at the same time, each its own.
class RealFft {
 public:
  explicit RealFft(std::size_t size);  // N >= 1
  ~RealFft();
  RealFft(RealFft&&) noexcept;
  RealFft& operator=(RealFft&&) noexcept;

  // [N], to be filled before transform(), which does not change it.
  [[nodiscard]] std::span<double> input();
  // [N/2 + 1]. Valid until the next call.
  std::span<const std::complex<double>> transform();

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

// Running spectrogram of a signal, one power spectrum per frame.

// How a signal is cut into frames, and which bins are kept.
struct SpectralLayout {
  double rate = 10e3;        // Hz, of the signal
  std::size_t window = 200;  // samples per frame
  std::size_t hop = 100;     // samples from one frame to the next
  double low = 50.0;         // Hz, first bin kept
  double high = 600.0;       // Hz, last bin kept
  bool hann = false;         // applies a Hann taper after subtracting the window's mean; false: rectangular
};

// Consecutive bins of a spectrum.
struct BinRange {
  std::size_t first = 0;
  std::size_t count = 0;
};

// Returns the bins k rate/window within [low, high], both included, for a window of `window`
// samples (at least 1) at `rate` [Hz] (above 0). count is 0 for a band without a bin.
BinRange bins_within(double rate, std::size_t window, double low, double high);

// Hann's taper, sin^2(pi n/window). [window]
std::vector<double> hann_taper(std::size_t window);

// Power spectral density of each window, mean subtracted. The defaults are the published features
// of the piezoelectric skin (FFT-GRU slip detection, section IV-A): windows of 20 ms every 10 ms at
// 10 kHz, twelve bins of 50 Hz. They are rectangular because the paper names no taper. A slow
// change, such as a rising force, then leaks into all bins as 1/frequency; with a Hann taper it
// leaks as 1/frequency^3, and a spectral line is two bins wider.
class SpectralFeatures {
 public:
  // Keeps the bins k rate/window within [low, high], both included. Throws std::logic_error for an
  // empty window or hop, and if no bin is left.
  explicit SpectralFeatures(const SpectralLayout& layout);

  // Takes the next sample. Returns true if it completes a frame: the first after `window` samples,
  // then one every `hop`.
  bool push(float value);
  // One-sided density of the last complete frame, 2 |X_k|^2/(rate sum w_n^2) [unit^2/Hz] with the
  // taper w. The sum over all bins above 0, times rate/window, is the variance of a rectangular
  // window. (The bin at rate/2 has no mirror image and counts once.) [bins()]
  [[nodiscard]] std::span<const double> density() const { return density_; }

  [[nodiscard]] std::size_t bins() const { return density_.size(); }
  [[nodiscard]] double frequency(std::size_t bin) const { return static_cast<double>(kept_.first + bin) * width_; }  // Hz
  [[nodiscard]] double bin_width() const { return width_; }                                                          // Hz

 private:
  void transform();

  SpectralLayout layout_;
  double width_;
  BinRange kept_;
  RealFft fft_;
  std::vector<double> past_;   // [window], a ring
  std::vector<double> taper_;  // [window]; empty: rectangular
  double taper_power_;         // sum of its squares
  std::size_t seen_ = 0;
  std::vector<double> density_;
};

}  // namespace slipbench

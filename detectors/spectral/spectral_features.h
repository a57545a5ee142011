// The discrete Fourier transform of real numbers, by FFTW.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace slipbench {

// X_k = sum_n x_n exp(-2 pi i k n/N), k = 0 .. N/2. The plan is made once, by FFTW_ESTIMATE: a plan chosen by timing would give other bits
// from one run to the next. Objects may be made, used and destroyed on several threads at a time, each object on one.
class RealFft {
 public:
  explicit RealFft(std::size_t size);  // N >= 1
  ~RealFft();
  RealFft(RealFft&&) noexcept;
  RealFft& operator=(RealFft&&) noexcept;

  // [N], to be filled before transform(), which leaves it as it is.
  [[nodiscard]] std::span<double> input();
  // [N/2 + 1]. Valid until the next call.
  std::span<const std::complex<double>> transform();

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

// The spectrogram of a signal as it comes in, one power spectrum a frame.

// How a signal is cut into frames, and which bins of them are kept.
struct SpectralLayout {
  double rate = 10e3;        // Hz, of the signal
  std::size_t window = 200;  // samples a frame
  std::size_t hop = 100;     // samples from one frame to the next
  double low = 50.0;         // Hz, of the first bin kept
  double high = 600.0;       // Hz, of the last
  bool hann = false;         // tapers the window (Hann) after its mean is taken off; false: rectangular
};

// Bins of a spectrum, one after the other.
struct BinRange {
  std::size_t first = 0;
  std::size_t count = 0;
};

// The bins k rate/window within [low, high], both included, of a window of so many samples (1 or more) at `rate` [Hz] (more than 0). Of a band
// that holds none, count is 0.
BinRange bins_within(double rate, std::size_t window, double low, double high);

// Hann's taper, sin^2(pi n/window). [window]
std::vector<double> hann_taper(std::size_t window);

// The power spectral density of each window less its mean. At the defaults these are the published features of the piezoelectric skin (FFT-GRU
// slip detection, section IV-A): windows of 20 ms every 10 ms at 10 kHz, twelve bins of 50 Hz. They are rectangular: the paper names no taper. What changes slowly, a force that is built up, then leaks into all bins as
// 1/frequency; with Hann's taper it does as 1/frequency^3, and a line is two bins wider.
class SpectralFeatures {
 public:
  // Keeps the bins k rate/window within [low, high], both included. Throws std::logic_error for an empty window or hop, and where no bin is
  // left.
  explicit SpectralFeatures(const SpectralLayout& layout);

  // Takes the next sample. True when a frame is complete with it: the first after `window` samples, then one every `hop`.
  bool push(float value);
  // Of the last complete frame, one-sided: 2 |X_k|^2/(rate sum w_n^2) [unit^2/Hz] with the taper w, so that the sum over all bins above 0 times
  // rate/window is the variance of a rectangular window. (The bin at rate/2, which has no mirror image, counts once.) [bins()]
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

#include "detectors/nib/stft.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace slipbench::nib {
namespace {

std::size_t checked_size(std::size_t size) {
  if (size < 4) throw std::invalid_argument("a window of fewer than four samples");
  return size;
}

}  // namespace

WindowSpectrum::WindowSpectrum(std::size_t size, double rate)
    : rate_(rate), fft_(checked_size(size)), window_(size), magnitudes_(size / 2 + 1) {
  for (std::size_t n = 0; n < size; ++n) {
    window_[n] = 0.54 - 0.46 * std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(size));
  }
}

std::span<const double> WindowSpectrum::magnitudes(std::span<const double> samples) {
  if (samples.size() != size()) throw std::invalid_argument("a stretch of another length than the window");
  // Least squares about the middle, where mean and slope are apart: sum (n - m)^2 = N (N^2 - 1)/12.
  const auto n = static_cast<double>(size());
  const double middle = 0.5 * (n - 1.0);
  double mean = 0.0, slope = 0.0;
  for (const double sample : samples) mean += sample;
  mean /= n;
  for (std::size_t i = 0; i < size(); ++i) slope += (static_cast<double>(i) - middle) * (samples[i] - mean);
  slope *= 12.0 / (n * (n * n - 1.0));
  const std::span<double> in = fft_.input();
  for (std::size_t i = 0; i < size(); ++i) in[i] = window_[i] * (samples[i] - mean - slope * (static_cast<double>(i) - middle));
  std::ranges::transform(fft_.transform(), magnitudes_.begin(), [](const std::complex<double>& x) { return std::abs(x); });
  return magnitudes_;
}

SlidingSpectrum::SlidingSpectrum(std::size_t window, std::size_t hop, double rate)
    : spectrum_(window, rate), hop_(hop), ring_(window), ordered_(window), missing_(window) {
  if (hop == 0) throw std::invalid_argument("a hop of no samples");
}

bool SlidingSpectrum::push(double sample) {
  ring_[next_] = sample;
  next_ = next_ + 1 == ring_.size() ? 0 : next_ + 1;
  if (--missing_ > 0) return false;
  missing_ = hop_;
  std::rotate_copy(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(next_), ring_.end(), ordered_.begin());
  const std::span<const double> found = spectrum_.magnitudes(ordered_);
  magnitudes_.assign(found.begin(), found.end());
  return true;
}

double SlidingSpectrum::band_mean(double low, double high) const {
  // A bound that is a bin's own frequency must find it, whatever its rounding.
  constexpr double rounding = 1e-9;
  const auto first = static_cast<std::size_t>(std::ceil(low / spectrum_.bin_width() - rounding));
  const auto last = static_cast<std::size_t>(std::floor(high / spectrum_.bin_width() + rounding));
  if (!(low >= 0.0) || first > last || last > spectrum_.size() / 2) throw std::invalid_argument("no bin in this band");
  if (magnitudes_.empty()) return 0.0;
  double sum = 0.0;
  for (std::size_t k = first; k <= last; ++k) sum += magnitudes_[k];
  return sum / static_cast<double>(last - first + 1);
}

}  // namespace slipbench::nib

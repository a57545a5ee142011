#include "detectors/spectral/spectral_features.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace slipbench {

SpectralFeatures::SpectralFeatures(const SpectralLayout& layout)
    : layout_(layout),
      width_(layout.rate / static_cast<double>(layout.window)),
      first_bin_(0),
      fft_(std::max<std::size_t>(layout.window, 1)),
      past_(layout.window),
      taper_power_(static_cast<double>(layout.window)) {
  if (layout.window == 0 || layout.hop == 0) throw std::logic_error("SpectralFeatures: an empty window or hop");
  constexpr double rounding = 1e-9;  // of a decimal length times a decimal rate
  first_bin_ = static_cast<std::size_t>(std::ceil(layout.low / width_ * (1.0 - rounding)));
  const auto last = std::min(layout.window / 2, static_cast<std::size_t>(layout.high / width_ * (1.0 + rounding)));
  if (last < first_bin_) throw std::logic_error("SpectralFeatures: no bin between low and high");
  density_.resize(last - first_bin_ + 1);
  if (!layout.hann) return;
  taper_power_ = 0.0;
  for (std::size_t n = 0; n < layout.window; ++n) {
    taper_.push_back(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(layout.window)));
    taper_power_ += taper_.back() * taper_.back();
  }
}

bool SpectralFeatures::push(float value) {
  past_[seen_ % layout_.window] = static_cast<double>(value);
  ++seen_;
  if (seen_ < layout_.window || (seen_ - layout_.window) % layout_.hop != 0) return false;
  transform();
  return true;
}

void SpectralFeatures::transform() {
  const double mean = std::accumulate(past_.begin(), past_.end(), 0.0) / static_cast<double>(layout_.window);
  const std::span<double> input = fft_.input();
  const auto oldest = past_.begin() + static_cast<std::ptrdiff_t>(seen_ % layout_.window);
  std::rotate_copy(past_.begin(), oldest, past_.end(), input.begin());
  for (double& x : input) x -= mean;
  for (std::size_t n = 0; n < taper_.size(); ++n) input[n] *= taper_[n];
  const std::span<const std::complex<double>> spectrum = fft_.transform();
  for (std::size_t b = 0; b < density_.size(); ++b) {
    const std::size_t bin = first_bin_ + b;
    const double sides = bin == 0 || 2 * bin == layout_.window ? 1.0 : 2.0;
    density_[b] = sides * std::norm(spectrum[bin]) / (layout_.rate * taper_power_);
  }
}

}  // namespace slipbench

#include "detectors/spectral/spectral_features.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <new>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "sim/core/fftw_planner.h"
#include "sim/core/math.h"

namespace slipbench {

struct RealFft::Plan {
  explicit Plan(std::size_t n) : size(n), in(fftw_alloc_real(n)), out(fftw_alloc_complex(n / 2 + 1)) {
    const std::lock_guard lock(fftw_planner());
    if (in != nullptr && out != nullptr) {
      plan = fftw_plan_dft_r2c_1d(static_cast<int>(n), in, out, fftw_plan_flags | FFTW_PRESERVE_INPUT);
    }
    if (plan == nullptr) {
      free();
      throw std::bad_alloc();
    }
  }
  ~Plan() {
    const std::lock_guard lock(fftw_planner());
    fftw_destroy_plan(plan);
    free();
  }
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  void free() const {
    fftw_free(in);
    fftw_free(out);
  }

  std::size_t size;
  double* in;
  fftw_complex* out;
  fftw_plan plan = nullptr;
};

RealFft::RealFft(std::size_t size) : plan_(std::make_unique<Plan>(size)) {}
RealFft::~RealFft() = default;
RealFft::RealFft(RealFft&&) noexcept = default;
RealFft& RealFft::operator=(RealFft&&) noexcept = default;

std::span<double> RealFft::input() { return {plan_->in, plan_->size}; }

std::span<const std::complex<double>> RealFft::transform() {
  fftw_execute(plan_->plan);
  // FFTW's complex number is two doubles, like the standard library's.
  return {reinterpret_cast<const std::complex<double>*>(plan_->out), plan_->size / 2 + 1};
}

BinRange bins_within(double rate, std::size_t window, double low, double high) {
  constexpr double rounding = 1e-9;  // relative rounding error of a decimal length times a decimal rate
  const double width = rate / static_cast<double>(window);
  const double last = std::floor(std::min(0.5 * static_cast<double>(window), high / width * (1.0 + rounding)));
  const double first = std::ceil(std::max(0.0, low / width * (1.0 - rounding)));
  if (!(first <= last)) return {};
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(last - first) + 1};
}

std::vector<double> hann_taper(std::size_t window) {
  std::vector<double> taper(window);
  for (std::size_t n = 0; n < window; ++n) {
    taper[n] = 0.5 - 0.5 * math::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(window));
  }
  return taper;
}

SpectralFeatures::SpectralFeatures(const SpectralLayout& layout)
    : layout_(layout),
      width_(layout.rate / static_cast<double>(layout.window)),
      fft_(std::max<std::size_t>(layout.window, 1)),
      past_(layout.window),
      taper_power_(static_cast<double>(layout.window)) {
  if (layout.window == 0 || layout.hop == 0) throw std::logic_error("SpectralFeatures: an empty window or hop");
  kept_ = bins_within(layout.rate, layout.window, layout.low, layout.high);
  if (kept_.count == 0) throw std::logic_error("SpectralFeatures: no bin between low and high");
  density_.resize(kept_.count);
  if (!layout.hann) return;
  taper_ = hann_taper(layout.window);
  taper_power_ = std::inner_product(taper_.begin(), taper_.end(), taper_.begin(), 0.0);
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
    const std::size_t bin = kept_.first + b;
    const double sides = bin == 0 || 2 * bin == layout_.window ? 1.0 : 2.0;
    density_[b] = sides * std::norm(spectrum[bin]) / (layout_.rate * taper_power_);
  }
}

}  // namespace slipbench

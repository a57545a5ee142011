#include "detectors/nib/stft.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>

namespace slipbench::nib {
namespace {

// FFTW's planner is not to be called by two threads at a time; plans are run without it.
std::mutex& planner() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

struct WindowSpectrum::Plan {
  struct Free {
    void operator()(void* block) const { fftw_free(block); }
  };

  Plan(std::size_t samples, double samples_a_second)
      : size(samples),
        bins(samples / 2 + 1),
        rate(samples_a_second),
        in(fftw_alloc_real(size)),
        out(fftw_alloc_complex(bins)),
        window(size),
        magnitudes(bins) {
    if (size < 4) throw std::invalid_argument("a window of fewer than four samples");
    for (std::size_t n = 0; n < size; ++n) {
      window[n] = 0.54 - 0.46 * std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(size));
    }
    const std::lock_guard lock(planner());
    plan = fftw_plan_dft_r2c_1d(static_cast<int>(size), in.get(), out.get(), FFTW_ESTIMATE);
    if (plan == nullptr) throw std::runtime_error("FFTW has no plan for this window");
  }
  ~Plan() {
    const std::lock_guard lock(planner());
    fftw_destroy_plan(plan);
  }
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  std::size_t size, bins;
  double rate;  // Hz
  std::unique_ptr<double, Free> in;
  std::unique_ptr<fftw_complex, Free> out;
  std::vector<double> window, magnitudes;
  fftw_plan plan = nullptr;
};

WindowSpectrum::WindowSpectrum(std::size_t size, double rate) : plan_(std::make_unique<Plan>(size, rate)) {}
WindowSpectrum::~WindowSpectrum() = default;
WindowSpectrum::WindowSpectrum(WindowSpectrum&&) noexcept = default;
WindowSpectrum& WindowSpectrum::operator=(WindowSpectrum&&) noexcept = default;

std::size_t WindowSpectrum::size() const { return plan_->size; }
double WindowSpectrum::bin_width() const { return plan_->rate / static_cast<double>(plan_->size); }

std::span<const double> WindowSpectrum::magnitudes(std::span<const double> samples) {
  Plan& p = *plan_;
  if (samples.size() != p.size) throw std::invalid_argument("a stretch of another length than the window");
  // Least squares about the middle, where mean and slope are apart: sum (n - m)^2 = N (N^2 - 1)/12.
  const auto n = static_cast<double>(p.size);
  const double middle = 0.5 * (n - 1.0);
  double mean = 0.0, slope = 0.0;
  for (const double sample : samples) mean += sample;
  mean /= n;
  for (std::size_t i = 0; i < p.size; ++i) slope += (static_cast<double>(i) - middle) * (samples[i] - mean);
  slope *= 12.0 / (n * (n * n - 1.0));
  for (std::size_t i = 0; i < p.size; ++i) {
    p.in.get()[i] = p.window[i] * (samples[i] - mean - slope * (static_cast<double>(i) - middle));
  }
  fftw_execute(p.plan);
  for (std::size_t k = 0; k < p.bins; ++k) p.magnitudes[k] = std::hypot(p.out.get()[k][0], p.out.get()[k][1]);
  return p.magnitudes;
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

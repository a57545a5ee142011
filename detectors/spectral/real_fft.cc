#include "detectors/spectral/real_fft.h"

#include <fftw3.h>

#include <mutex>
#include <new>

namespace slipbench {
namespace {

// FFTW's planner is not reentrant; its transforms are.
std::mutex& planner() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

struct RealFft::Plan {
  explicit Plan(std::size_t n) : size(n), in(fftw_alloc_real(n)), out(fftw_alloc_complex(n / 2 + 1)) {
    const std::lock_guard lock(planner());
    if (in != nullptr && out != nullptr) {
      plan = fftw_plan_dft_r2c_1d(static_cast<int>(n), in, out, FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
    }
    if (plan == nullptr) {
      free();
      throw std::bad_alloc();
    }
  }
  ~Plan() {
    const std::lock_guard lock(planner());
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
  // FFTW's complex number is two doubles, as that of the standard library.
  return {reinterpret_cast<const std::complex<double>*>(plan_->out), plan_->size / 2 + 1};
}

}  // namespace slipbench

// The discrete Fourier transform of real numbers, by FFTW.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>

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

}  // namespace slipbench

// FFTW's planner is not reentrant; its transforms are. Its plans are to be the same everywhere.
#pragma once

#include <mutex>

namespace slipbench {

// To be held while a plan is made or destroyed.
inline std::mutex& fftw_planner() {
  static std::mutex mutex;
  return mutex;
}

// FFTW_ESTIMATE and, of FFTW's own api/fftw3.h, FFTW_NO_SIMD, for every plan: a measured one would differ from run to run, and vector kernels, which
// FFTW takes by the processor, round each in its own way. Its sines are still the C library's, which round by the processor.
constexpr unsigned fftw_plan_flags = 1U << 6U | 1U << 17U;

}  // namespace slipbench

// FFTW's planner is not reentrant; its transforms are. Plans must be the same on every machine.
#pragma once

#include <mutex>

namespace slipbench {

// Returns the mutex to hold while a plan is made or destroyed.
inline std::mutex& fftw_planner() {
  static std::mutex mutex;
  return mutex;
}

// FFTW_ESTIMATE and, from FFTW's own api/fftw3.h, FFTW_NO_SIMD, for every plan. A measured plan
// would differ from run to run, and vector kernels, which FFTW chooses by the processor, round
// differently. FFTW's sines still come from the C library, whose rounding depends on the processor.
constexpr unsigned fftw_plan_flags = 1U << 6U | 1U << 17U;

}  // namespace slipbench

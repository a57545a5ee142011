// FFTW's planner is not reentrant; its transforms are. Plans must be the same on every machine.
#pragma once

#include <mutex>

namespace slipbench {

// Returns the mutex to hold while a plan is made or destroyed.
inline std::mutex& fftw_planner() {
  static std::mutex mutex;
  return mutex;
}

// Flags of every plan: FFTW_ESTIMATE and, from api/fftw3.h of FFTW, FFTW_NO_SIMD. A measured plan
// would differ from run to run, and FFTW chooses vector kernels by the processor, which round
// differently. The sines of FFTW still come from the C library, whose rounding depends on the
// processor.
constexpr unsigned fftw_plan_flags = 1U << 6U | 1U << 17U;

}  // namespace slipbench

// FFTW's planner is not reentrant; its transforms are.
#pragma once

#include <mutex>

namespace slipbench {

// To be held while a plan is made or destroyed.
inline std::mutex& fftw_planner() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace slipbench

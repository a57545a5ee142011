// Long work of the library on behalf of Python.
#pragma once

#include <mutex>
#include <optional>
#include <string_view>

#include <nanobind/nanobind.h>

#include "sim/core/process/interrupted.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench::python {

// HDF5 is not thread-safe. Lock without Python's lock.
inline std::mutex hdf5_in_use;

// One InterruptGuard shared by all threads that do such work. The notice is that of the first.
class SharedInterrupt {
 public:
  explicit SharedInterrupt(std::string_view notice = "stopping") {
    const std::lock_guard lock(mutex_);
    if (users_++ == 0) guard_.emplace(notice);
  }
  SharedInterrupt(const SharedInterrupt&) = delete;
  SharedInterrupt& operator=(const SharedInterrupt&) = delete;
  ~SharedInterrupt() {
    const std::lock_guard lock(mutex_);
    if (--users_ == 0) guard_.reset();
  }

 private:
  inline static std::mutex mutex_;
  inline static std::size_t users_ = 0;
  inline static std::optional<InterruptGuard> guard_;
};

// Runs `work` without Python's lock, and alone among the users of HDF5. Throws Interrupted after
// Ctrl-C, also if the work has ended meanwhile.
template <class Work>
auto call_library(const Work& work) {
  const SharedInterrupt guard;
  const nanobind::gil_scoped_release release;
  const std::lock_guard alone(hdf5_in_use);
  const InterruptScope scope(&InterruptGuard::flag());
  auto result = work();
  end_if_interrupted();
  return result;
}

}  // namespace slipbench::python

// Long work of the library on behalf of Python.
#pragma once

#include <mutex>
#include <optional>
#include <string_view>

#include <nanobind/nanobind.h>

#include "sim/core/process/interrupted.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench::python {

// Releases Python's lock and waits for the other users of HDF5, which is not thread-safe. Every
// function of the module that reads or writes a dataset holds one.
class Hdf5Use {
 public:
  Hdf5Use() : alone_(mutex_) {}

 private:
  inline static std::mutex mutex_;
  nanobind::gil_scoped_release release_;  // first: a thread that waits must not hold Python's lock
  std::lock_guard<std::mutex> alone_;
};

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
  const Hdf5Use alone;
  const InterruptScope scope(&InterruptGuard::flag());
  auto result = work();
  end_if_interrupted();
  return result;
}

}  // namespace slipbench::python

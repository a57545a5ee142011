// Lets Ctrl-C stop a command and keep finished work.
#pragma once

#include <atomic>
#include <csignal>
#include <string_view>

#include "sim/core/process/interrupted.h"

namespace slipbench {

// While alive, the first SIGINT, SIGTERM or SIGHUP sets the flag and prints `notice` on stderr, and
// the second ends the process as usual. A signal that was ignored before (a background job of a
// script) stays ignored. Only one guard may exist at a time.
class InterruptGuard {
 public:
  explicit InterruptGuard(std::string_view notice = "stopping");
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  [[nodiscard]] static const std::atomic<bool>& flag();

 private:
  struct sigaction previous_int_ {};
  struct sigaction previous_term_ {};
  struct sigaction previous_hang_up_ {};
};

}  // namespace slipbench

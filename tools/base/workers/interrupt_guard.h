// Ctrl-C that ends what runs and keeps what is finished.
#pragma once

#include <atomic>
#include <csignal>
#include <string_view>

#include "sim/core/process/interrupted.h"

namespace slipbench {

// While alive, the first SIGINT, SIGTERM or SIGHUP sets the flag and says on stderr what happens next, `notice`, and the second
// ends the process as usual; a signal that was ignored before (a job that a script put in the background) stays ignored. A write
// beyond the process's limit on file sizes fails instead of ending it. One at a time.
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
  struct sigaction previous_file_size_ {};
};

}  // namespace slipbench

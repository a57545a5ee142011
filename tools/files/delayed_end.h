// Delays the end of the program by a signal while temporary files exist.
#pragma once

namespace slipbench {

// While one lives, in any thread, end_by_signal() waits for it, so that no temporary file remains.
// For work of about a second; longer work needs an InterruptGuard. The destructor ends the process
// if a signal has arrived.
class DelayedEnd {
 public:
  DelayedEnd();
  ~DelayedEnd();
  DelayedEnd(const DelayedEnd&) = delete;
  DelayedEnd& operator=(const DelayedEnd&) = delete;
};

// Ends the process with `status`, not 0, once no DelayedEnd lives; the second call ends it at once.
// For signal handlers.
void end_by_signal(int status);

}  // namespace slipbench

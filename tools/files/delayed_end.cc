#include "tools/files/delayed_end.h"

#include <unistd.h>

#include <atomic>

namespace slipbench {
namespace {

std::atomic<int> alive{0};    // objects of DelayedEnd
std::atomic<int> pending{0};  // status with which the process will end; 0: no signal has arrived
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

}  // namespace

DelayedEnd::DelayedEnd() { ++alive; }

DelayedEnd::~DelayedEnd() {
  if (--alive == 0 && pending != 0) _exit(pending);
}

void end_by_signal(int status) {
  // `pending` is set before `alive` is read, so that either this thread or the destructor in another sees the other's change.
  const bool second = pending.exchange(status) != 0;
  if (second || alive == 0) _exit(status);
}

}  // namespace slipbench

#include "tools/workers/interrupt_guard.h"

#include <unistd.h>

#include <cerrno>
#include <string>

#include <fmt/format.h>

namespace slipbench {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

std::string announcement;                            // complete before the handler is installed
constexpr std::string_view clear_line = "\r\033[K";  // a terminal may show a progress bar
volatile std::sig_atomic_t on_terminal = 0;

// The result is ignored: nothing can be done if stderr is not writable.
void say(std::string_view text) { [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size()); }

void note_interrupt(int signal) {
  if (interrupted.exchange(true)) {
    std::raise(signal);  // the default action is restored: this is the second signal
    return;
  }
  const int before = errno;
  if (on_terminal != 0) say(clear_line);
  say(announcement);
  errno = before;
}

void catch_unless_ignored(int signal, const struct sigaction& action, struct sigaction& previous) {
  sigaction(signal, nullptr, &previous);
  if (previous.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard(std::string_view notice) {
  interrupted.store(false);
  announcement = fmt::format("slipbench: {}; interrupt again to stop at once\n", notice);
  on_terminal = isatty(STDERR_FILENO);
  struct sigaction action {};
  action.sa_handler = &note_interrupt;
  // SA_NODEFER: the second signal ends the process even if a full pipe blocks the announcement.
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART | SA_NODEFER;
  sigemptyset(&action.sa_mask);
  catch_unless_ignored(SIGINT, action, previous_int_);
  catch_unless_ignored(SIGTERM, action, previous_term_);
  catch_unless_ignored(SIGHUP, action, previous_hang_up_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &previous_int_, nullptr);
  sigaction(SIGTERM, &previous_term_, nullptr);
  sigaction(SIGHUP, &previous_hang_up_, nullptr);
}

const std::atomic<bool>& InterruptGuard::flag() { return interrupted; }

}  // namespace slipbench

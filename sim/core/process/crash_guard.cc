#include "sim/core/process/crash_guard.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <csignal>
#include <cstddef>
#include <cstring>

#include "sim/core/process/of_thread.h"

namespace slipbench {
namespace {

struct GuardedSignal {
  int number;
  const char* text;
};
constexpr std::array<GuardedSignal, 5> guarded_signals{{{SIGSEGV, "SIGSEGV (segmentation fault)"},
                                                        {SIGBUS, "SIGBUS (bus error)"},
                                                        {SIGFPE, "SIGFPE (arithmetic fault, as of a division by zero)"},
                                                        {SIGILL, "SIGILL (illegal instruction)"},
                                                        {SIGABRT, "SIGABRT (abort)"}}};

// Where this thread goes on when the guarded call that it is in crashes; null: it is in none.
thread_local sigjmp_buf* volatile landing = nullptr;

// The actions that were there before, in the order of guarded_signals.
std::array<struct sigaction, guarded_signals.size()> before;

// What would have happened without this guard. Only what a signal handler may call.
void pass_on(int signal, siginfo_t* info, void* context) {
  const auto* const found = std::ranges::find(guarded_signals, signal, &GuardedSignal::number);
  const struct sigaction& action = before[static_cast<std::size_t>(found - guarded_signals.begin())];
  if ((action.sa_flags & SA_SIGINFO) != 0) return action.sa_sigaction(signal, info, context);
  if (action.sa_handler == SIG_IGN && info->si_code <= 0)
    return;  // sent, and not the fault of an instruction, which would repeat for ever
  if (action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN) return action.sa_handler(signal);
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

void handle(int signal, siginfo_t* info, void* context) {
  sigjmp_buf* const target = landing;
  const bool own = info->si_code > 0 || info->si_code == SI_TKILL;  // by an instruction, or sent to this thread, as abort() does
  if (target == nullptr || !own) return pass_on(signal, info, context);
  siglongjmp(*target, signal);
}

// The handlers, set once a process. SA_NODEFER: a jump out of the handler leaves no signal blocked, so that no mask has to be
// kept at each call.
struct Handlers {
  Handlers() {
    struct sigaction action {};
    action.sa_sigaction = handle;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < guarded_signals.size(); ++i) ::sigaction(guarded_signals[i].number, &action, &before[i]);
  }
};

// A stack for handlers while the thread's own has overflowed. One that is there already is kept.
class SignalStack {
 public:
  SignalStack() {
    stack_t present{};
    ::sigaltstack(nullptr, &present);
    if ((present.ss_flags & SS_DISABLE) == 0) return;
    memory_ = std::make_unique<std::byte[]>(size);
    const stack_t own{.ss_sp = memory_.get(), .ss_flags = 0, .ss_size = size};
    ::sigaltstack(&own, nullptr);
  }
  ~SignalStack() {
    if (!memory_) return;
    const stack_t none{.ss_sp = nullptr, .ss_flags = SS_DISABLE, .ss_size = 0};
    ::sigaltstack(&none, nullptr);
  }
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  static constexpr std::size_t size = 65536;  // bytes: the registers of the widest vector units take 12 kB
  std::unique_ptr<std::byte[]> memory_;
};

// Takes the landing back however the call ends but by a crash.
class Landing {
 public:
  explicit Landing(sigjmp_buf* here) : outer_(landing) { landing = here; }
  ~Landing() { landing = outer_; }
  Landing(const Landing&) = delete;
  Landing& operator=(const Landing&) = delete;

 private:
  sigjmp_buf* outer_;
};

}  // namespace

int run_guarded(void (*call)(void*), void* context) {
  static const Handlers handlers;
  static OfThread<SignalStack> stacks;
  static_cast<void>(handlers), static_cast<void>(stacks.get());
  sigjmp_buf here;
  const Landing armed(&here);
  const int signal = sigsetjmp(here, 0);
  if (signal == 0) call(context);
  return signal;
}

std::string signal_text(int signal) {
  const auto* const found = std::ranges::find(guarded_signals, signal, &GuardedSignal::number);
  return found == guarded_signals.end() ? ::strsignal(signal) : found->text;
}

}  // namespace slipbench

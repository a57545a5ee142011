#include "sim/core/process/crash_guard.h"

#include <array>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

// An address in the first page, which no program has. Aligned and not null: no sanitizer sees it coming.
void write_nowhere() {
  volatile std::uintptr_t address = 64;
  *reinterpret_cast<volatile int*>(address) = 1;  // NOLINT(performance-no-int-to-ptr)
}

// Takes a page of the stack for each of `*depth` levels.
int sink(volatile const int* depth, int level) {
  volatile char room[4096] = {};
  if (level >= *depth) return 0;
  room[0] = static_cast<char>(sink(depth, level + 1));
  return room[0];
}

void overflow_stack() {
  const int depth = 1'000'000'000;
  static_cast<void>(sink(&depth, 0));
}

template <class Call>
int guarded(Call call) {
  return run_guarded(call);
}

struct CrashGuard : testing::Test {
  void SetUp() override {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "the sanitizer of threads keeps signals and jumps to itself";
#endif
  }
};
using CrashGuardDeathTest = CrashGuard;

TEST_F(CrashGuard, LetsACallRun) {
  int calls = 0;
  EXPECT_EQ(guarded([&] { ++calls; }), 0);
  EXPECT_EQ(calls, 1);
}

TEST_F(CrashGuard, LetsExceptionsPass) {
  EXPECT_THROW(guarded([] { throw std::runtime_error("x"); }), std::runtime_error);
  EXPECT_EQ(guarded(write_nowhere), SIGSEGV) << "the guard is in order after an exception";
}

TEST_F(CrashGuard, ReturnsTheSignal) {
  EXPECT_EQ(guarded(write_nowhere), SIGSEGV);
  EXPECT_EQ(guarded([] { std::abort(); }), SIGABRT);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    EXPECT_EQ(guarded([&] { std::raise(signal); }), signal);
    EXPECT_EQ(signal_text(signal).substr(0, 3), "SIG");
  }
  EXPECT_EQ(signal_text(SIGTERM), "Terminated");
}

TEST_F(CrashGuard, ReturnsFromAnOverflowOfTheStack) {
  EXPECT_EQ(guarded(overflow_stack), SIGSEGV);
  EXPECT_EQ(guarded(overflow_stack), SIGSEGV) << "a second time";
  int signal = 0;
  std::thread([&] { signal = guarded(overflow_stack); }).join();
  EXPECT_EQ(signal, SIGSEGV) << "in another thread";
}

TEST_F(CrashGuard, ReturnsToTheInnermostCall) {
  int inner = 0;
  const int outer = guarded([&] {
    inner = guarded([] { std::raise(SIGFPE); });
    std::raise(SIGILL);
  });
  EXPECT_EQ(inner, SIGFPE);
  EXPECT_EQ(outer, SIGILL);
}

// Each thread gets its own crashes back, whatever the others do.
TEST_F(CrashGuard, KeepsThreadsApart) {
  constexpr int rounds = 200;
  const std::array<int, 4> signals{SIGSEGV, SIGFPE, SIGABRT, SIGBUS};
  std::array<int, 4> returned{};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    threads.emplace_back([&, i] {
      for (int round = 0; round < rounds; ++round) {
        if (guarded([&] { std::raise(signals[i]); }) == signals[i]) ++returned[i];
        if (guarded([] {}) == 0) ++returned[i];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : returned) EXPECT_EQ(count, 2 * rounds);
}

// Outside of a call all is as before: the program ends by the signal, or by what a sanitizer makes of it.
TEST_F(CrashGuardDeathTest, LeavesOtherCrashesAlone) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_DEATH(
      {
        static_cast<void>(guarded(write_nowhere));
        write_nowhere();
      },
      "");
  EXPECT_DEATH(static_cast<void>(guarded([] { std::thread(write_nowhere).join(); })), "")
      << "in a thread that the call has started";
}

// A handler that was there first is called for what is not the guard's.
TEST_F(CrashGuardDeathTest, CallsTheHandlerThatWasThereBefore) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";  // a process in which no guard has been set yet
  EXPECT_EXIT(
      {
        std::signal(SIGSEGV, [](int) { std::_Exit(42); });
        if (guarded(write_nowhere) == SIGSEGV) write_nowhere();
      },
      testing::ExitedWithCode(42), "");
}

}  // namespace
}  // namespace slipbench

// The thread sanitizer of this build finds a planted race; without this test a silent sanitizer
// would pass for a clean program.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "tools/workers/ordered_workers.h"

namespace slipbench::testing {
namespace {

// Two unsynchronised tasks write one number, the first once the second has begun, the second after
// it. Their waiting creates no ordering, so that the race occurs in every run. The flag is kept
// away from the number because the sanitizer remembers the last four accesses of eight bytes.
void race() {
  alignas(64) int shared = 0;
  alignas(64) std::atomic<bool> begun{false};
  std::atomic<bool> written{false};
  const auto make_work = [&]() -> OrderedWorkers<int>::Work {
    return [&](std::size_t index) {
      if (index == 1) begun.store(true, std::memory_order_relaxed);
      const std::atomic<bool>& other = index == 0 ? begun : written;
      while (!other.load(std::memory_order_relaxed)) std::this_thread::yield();
      const int result = ++shared;
      written.store(true, std::memory_order_relaxed);
      return result;
    };
  };
  OrderedWorkers<int> workers(2, 2, make_work, nullptr);
  while (workers.next()) {
  }
}

// 66 is the sanitizer's exit status.
TEST(Threads, APlantedRaceIsFound) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(race(), ::testing::ExitedWithCode(66), "data race(.|\n)*race_test");
}

}  // namespace
}  // namespace slipbench::testing

#include "tools/run/ordered_workers.h"

#include <chrono>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

using Workers = OrderedWorkers<std::size_t>;

// Odd work takes longer, so that even work finishes out of turn.
Workers::Work uneven_work() {
  return [](std::size_t index) {
    std::this_thread::sleep_for(std::chrono::microseconds(index % 2 == 0 ? 10 : 500));
    return index * index;
  };
}

TEST(OrderedWorkers, HandOverInOrder) {
  for (const std::size_t threads : {1U, 2U, 5U}) {
    Workers workers(60, threads, uneven_work, nullptr);
    for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(workers.next(), i * i);
    EXPECT_EQ(workers.next(), std::nullopt);
  }
}

TEST(OrderedWorkers, NothingToDo) {
  Workers workers(0, 2, uneven_work, nullptr);
  EXPECT_EQ(workers.next(), std::nullopt);
}

TEST(OrderedWorkers, FirstFailureInOrderIsTheOneThrown) {
  const auto make_work = [] {
    return [](std::size_t index) -> std::size_t {
      if (index == 3) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      if (index >= 3) throw std::runtime_error(std::to_string(index));
      return index;
    };
  };
  Workers workers(60, 3, make_work, nullptr);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(workers.next(), i);
  try {
    workers.next();
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "3");
  }
}

TEST(OrderedWorkers, InterruptLetsBegunWorkFinish) {
  std::atomic<bool> interrupt{false};
  std::atomic<std::size_t> begun{0};
  const auto make_work = [&] {
    return [&](std::size_t index) {
      ++begun;
      return index;
    };
  };
  Workers workers(100'000, 2, make_work, &interrupt);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(workers.next(), i);
  interrupt = true;
  std::size_t delivered = 10;
  while (const std::optional<std::size_t> result = workers.next()) EXPECT_EQ(*result, delivered++);
  EXPECT_EQ(delivered, begun);
  EXPECT_LT(delivered, 100'000U);
}

TEST(OrderedWorkers, DoNotRunFarAhead) {
  std::atomic<std::size_t> begun{0};
  const auto make_work = [&] {
    return [&](std::size_t index) {
      ++begun;
      return index;
    };
  };
  Workers workers(100'000, 2, make_work, nullptr);
  EXPECT_EQ(workers.next(), 0U);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_LE(begun, 1U + 2U * 2U + 2U);  // one delivered, and the window of 2 threads
}

TEST(OrderedWorkers, CanBeLeftEarly) {
  Workers workers(100'000, 2, uneven_work, nullptr);
  EXPECT_EQ(workers.next(), 0U);
}

}  // namespace
}  // namespace slipbench

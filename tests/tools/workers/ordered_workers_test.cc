#include "tools/workers/ordered_workers.h"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>

#include "tests/expect.h"

namespace slipbench {
namespace {

using Workers = OrderedWorkers<std::size_t>;

// Odd tasks take longer, so that even tasks finish out of order.
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

// Records the thread that destroys it.
struct Spent {
  std::vector<std::thread::id>* threads;
  explicit Spent(std::vector<std::thread::id>* noted) : threads(noted) {}
  Spent(Spent&& other) noexcept : threads(std::exchange(other.threads, nullptr)) {}
  Spent& operator=(Spent&& other) noexcept {
    std::swap(threads, other.threads);
    return *this;
  }
  ~Spent() {
    if (threads != nullptr) threads->push_back(std::this_thread::get_id());
  }
};

TEST(OrderedWorkers, WhatIsGivenBackIsDestroyedByAWorker) {
  std::vector<std::thread::id> threads;
  {
    // A worker with four results waits until the first is taken, and begins no fifth before.
    OrderedWorkers<Spent> workers(
        6, 1, [&] { return [&](std::size_t) { return Spent(&threads); }; }, nullptr);
    for (int i = 0; i < 6; ++i) workers.give_back(*workers.next());
  }
  ASSERT_EQ(threads.size(), 6U);
  EXPECT_NE(threads.front(), std::this_thread::get_id());
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
  EXPECT_EQ(refusal_of<std::runtime_error>([&] { workers.next(); }), "3");
}

// A thread that fails at once would otherwise continue until its buffer is full of failures.
TEST(OrderedWorkers, NothingIsBegunAfterAFailure) {
  std::atomic<std::size_t> begun{0};
  const auto make_work = [&] {
    return [&](std::size_t) -> std::size_t {
      ++begun;
      throw std::runtime_error("failed");
    };
  };
  Workers workers(60, 1, make_work, nullptr);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_THROW(workers.next(), std::runtime_error);
  EXPECT_EQ(workers.next(), std::nullopt);
  EXPECT_EQ(begun, 1U);
}

TEST(OrderedWorkers, FailureToMakeTheWorkIsThrown) {
  for (const std::size_t threads : {1U, 3U}) {
    Workers workers(
        60, threads, []() -> Workers::Work { throw InputError("no work"); }, nullptr);
    EXPECT_THROW(workers.next(), InputError);
  }
}

// While alive, new threads have stacks of 256 MiB, and the process has address space for three of
// them, but not for four.
class RoomForThreeThreads {
 public:
  RoomForThreeThreads() {
    constexpr std::size_t stack = std::size_t{256} << 20;
    pthread_getattr_default_np(&attributes_);
    pthread_attr_t large = attributes_;
    pthread_attr_setstacksize(&large, stack);
    pthread_setattr_default_np(&large);
    std::size_t pages = 0;  // of the whole process: the first number of statm
    std::ifstream("/proc/self/statm") >> pages;
    getrlimit(RLIMIT_AS, &limit_);
    rlimit tight = limit_;
    tight.rlim_cur = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + 7 * stack / 2;
    setrlimit(RLIMIT_AS, &tight);
  }
  ~RoomForThreeThreads() {
    setrlimit(RLIMIT_AS, &limit_);
    pthread_setattr_default_np(&attributes_);
  }
  RoomForThreeThreads(const RoomForThreeThreads&) = delete;
  RoomForThreeThreads& operator=(const RoomForThreeThreads&) = delete;

 private:
  pthread_attr_t attributes_{};
  rlimit limit_{};
};

// Tasks that return their index and count how often they were begun.
auto counting(std::atomic<std::size_t>& begun) {
  return [&begun] {
    return [&begun](std::size_t index) {
      ++begun;
      return index;
    };
  };
}

TEST(OrderedWorkers, ThreadsThatCannotBeStartedAreRefused) {
  std::atomic<std::size_t> begun{0};
  const auto make_work = counting(begun);
  const std::string message = refusal_of([&] {
    const RoomForThreeThreads room;
    const Workers workers(100'000, 8, make_work, nullptr);
  });
  EXPECT_THAT(message, AllOf(::testing::ContainsRegex("[1-3] of 8"), mentions({"threads", "--jobs"})));
  EXPECT_EQ(begun, 0U);
}

TEST(OrderedWorkers, InterruptLetsBegunWorkFinish) {
  std::atomic<bool> interrupt{false};
  std::atomic<std::size_t> begun{0};
  const auto make_work = counting(begun);
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
  const auto make_work = counting(begun);
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

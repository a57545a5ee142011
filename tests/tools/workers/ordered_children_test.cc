#include "tools/workers/ordered_children.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string>

#include "tests/expect.h"

namespace slipbench {
namespace {

using Clock = std::chrono::steady_clock;

// Even tasks take longer, so that odd tasks finish out of order. Task 4 crashes.
TEST(OrderedChildren, HandOverInOrderAndLoseOneAlone) {
  for (const std::size_t jobs : {0U, 1U, 3U}) {
    OrderedChildren children(
        9, jobs,
        [](std::size_t index) {
          ::usleep(index % 2 == 0 ? 4000 : 10);
          if (index == 4) std::_Exit(0);
          return std::to_string(index);
        },
        nullptr);
    for (std::size_t index = 0; index < 9; ++index) {
      const std::optional<ChildEnd> end = children.next();
      ASSERT_TRUE(end);
      EXPECT_EQ(end->kind == ChildEnd::Kind::lost, index == 4);
      EXPECT_EQ(end->text, index == 4 ? "" : std::to_string(index));
    }
    EXPECT_FALSE(children.next());
  }
}

TEST(OrderedChildren, SayWhetherOneIsReady) {
  OrderedChildren children(
      1, 1,
      [](std::size_t) {
        ::usleep(200'000);
        return std::string();
      },
      nullptr);
  EXPECT_FALSE(children.ready_until(Clock::now() + std::chrono::milliseconds(1)));
  EXPECT_TRUE(children.ready_until(Clock::now() + std::chrono::minutes(1)));
  EXPECT_TRUE(children.next());
}

// The task would take a minute: the test's duration shows that it is not waited for.
TEST(OrderedChildren, AnInterruptEndsAll) {
  std::atomic<bool> interrupt{false};
  OrderedChildren children(
      3, 2,
      [](std::size_t) {
        ::sleep(60);
        return std::string();
      },
      &interrupt);
  EXPECT_FALSE(children.ready_until(Clock::now()));
  interrupt = true;
  EXPECT_FALSE(children.next());
}

}  // namespace
}  // namespace slipbench

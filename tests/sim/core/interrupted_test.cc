// How long work ends early.
#include "sim/core/process/interrupted.h"

#include <thread>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

TEST(Interrupted, EndsTheWorkOfTheThreadThatHasTheScope) {
  std::atomic<bool> interrupt{false};
  const InterruptScope scope(&interrupt);
  EXPECT_NO_THROW(end_if_interrupted());
  interrupt = true;
  EXPECT_THROW(end_if_interrupted(), Interrupted);
  std::thread([] { EXPECT_NO_THROW(end_if_interrupted()); }).join();
}

TEST(Interrupted, ScopesNest) {
  const std::atomic<bool> interrupt{true};
  EXPECT_NO_THROW(end_if_interrupted());
  {
    const InterruptScope outer(&interrupt);
    {
      const InterruptScope inner(nullptr);
      EXPECT_NO_THROW(end_if_interrupted());
    }
    EXPECT_THROW(end_if_interrupted(), Interrupted);
  }
  EXPECT_NO_THROW(end_if_interrupted());
}

}  // namespace
}  // namespace slipbench

#include "tools/files/delayed_end.h"

#include <cstdio>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

using testing::ExitedWithCode;

TEST(DelayedEnd, TheEndWaitsForTheLastOfThem) {
  EXPECT_EXIT(
      {
        {
          const DelayedEnd outer;
          {
            const DelayedEnd inner;
            end_by_signal(130);
          }
          std::fputs("went on", stderr);
        }
        std::fputs(" too long", stderr);
      },
      ExitedWithCode(130), "^went on$");
}

TEST(DelayedEnd, ASecondSignalEndsAtOnce) {
  EXPECT_EXIT(
      {
        const DelayedEnd delayed;
        end_by_signal(130);
        end_by_signal(129);
      },
      ExitedWithCode(129), "");
}

TEST(DelayedEnd, WithoutOneTheEndIsAtOnce) {
  EXPECT_EXIT(
      {
        { const DelayedEnd gone; }
        end_by_signal(130);
      },
      ExitedWithCode(130), "");
}

}  // namespace
}  // namespace slipbench

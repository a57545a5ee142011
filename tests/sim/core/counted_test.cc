#include "sim/core/counted.h"

#include <gtest/gtest.h>

namespace slipbench {
namespace {

TEST(Counted, OneIsSingularAndAllOtherCountsArePlural) {
  EXPECT_EQ(counted(1, "file"), "1 file");
  EXPECT_EQ(counted(0, "file"), "0 files");
  EXPECT_EQ(counted(2, "grid cell"), "2 grid cells");
}

TEST(Counted, AnEntryIsOneOfSeveralEntries) {
  EXPECT_EQ(counted(1, "entry"), "1 entry");
  EXPECT_EQ(counted(5, "entry"), "5 entries");
  EXPECT_EQ(counted(2, "key"), "2 keys");
}

}  // namespace
}  // namespace slipbench

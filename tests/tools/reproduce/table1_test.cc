#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/core/error.h"
#include "tests/tools/train/small_dataset.h"
#include "tools/reproduce/catalogue.h"

namespace slipbench::reproduce {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class Table1Test : public ::slipbench::testing::SmallDatasetTest {};

// On a given dataset: what needs fresh ones is left out.
TEST_F(Table1Test, IsTheSameOnAnyNumberOfThreads) {
  ReproduceOptions options;
  options.data = dataset();
  options.jobs = 1;
  const Result one = hd_table1(options);
  options.jobs = 3;
  const Result three = hd_table1(options);
  EXPECT_EQ(result_page("t", one), result_page("t", three));
  EXPECT_EQ(one.figures, three.figures);

  ASSERT_THAT(one.tables, SizeIs(4));
  EXPECT_THAT(one.tables[0].rows, SizeIs(5));  // four models, and the commonest class
  for (const ResultTable& table : one.tables) EXPECT_THAT(table.rows, Each(SizeIs(table.head.size()))) << table.title;
  EXPECT_EQ(one.tables[0].rows[3][0], "CL-gstHDC");
  EXPECT_EQ(one.tables[0].rows[3][1], "91.78 +- 0.53");
  EXPECT_THAT(one.setup[0], HasSubstr("data.h5"));
  EXPECT_FALSE(one.figures.contains("scatter"));
  // The model of the first row of the causes is that of the ablation.
  EXPECT_EQ(one.figures["causes"]["as published"], one.figures["by_sequence"]);
}

}  // namespace
}  // namespace slipbench::reproduce

// What the trials of the nib pad's tables II and III come to, of runs made up by hand.
#include <cmath>

#include "tests/expect.h"
#include "tools/studies/nib_reconfigurable/nib_table2.h"
#include "tools/studies/nib_reconfigurable/nib_table3.h"

namespace slipbench::reproduce::nib_figures_test {
namespace {

// Safe: before 6 mm. Gross: below the force that the pull requires; the other safe one is early.
TEST(ReleaseSummary, ErrorsAreThoseOfTheSafeRuns) {
  const std::vector<ReleaseRun> runs{
      {"paper", 4.0, 3.0, 1e-3}, {"paper", 4.0, 6.0, 3e-3}, {"paper", 4.0, 1.0, 7e-3}, {"felt", 1.0}};
  const ReleaseSummary paper = summary_of(runs, "paper");
  EXPECT_EQ(paper.runs, 3U);
  EXPECT_EQ(paper.safe, 2U);
  EXPECT_EQ(paper.early, 1U);
  EXPECT_DOUBLE_EQ(paper.error.mean, 1.5);
  EXPECT_DOUBLE_EQ(paper.gross_error.mean, 1.0);
  EXPECT_DOUBLE_EQ(paper.slip.mean, 2.0);
  EXPECT_EQ(summary_of(runs, "").runs, 4U);
  EXPECT_EQ(summary_of(runs, "felt").safe, 0U);
}

TEST(ReorientSummary, MediansLeaveOutWhatIsNone) {
  const double none = std::nan("");
  const ReorientRuns runs{{true, false, 0.1, 0.1, 5.0, {TurnEnd::standing, 0.2, 4.0}},
                          {false, false, 1.0, 0.3, 6.0, {TurnEnd::fell, 0.4, 3.0}},
                          {false, true, 1.5, 1.2, 7.0, {TurnEnd::lost, none, none}}};
  const ReorientSummary summary = summary_of(runs);
  EXPECT_EQ(summary.runs, 3U);
  EXPECT_EQ(summary.standing, 1U);
  EXPECT_EQ(summary.turned_up, 2U);
  EXPECT_EQ(summary.dropped, 1U);
  EXPECT_THAT(summary.ends, ElementsAre(1, 1, 0, 0, 1, 0, 0));
  EXPECT_DOUBLE_EQ(summary.tilt, 1.0);
  EXPECT_DOUBLE_EQ(summary.released_tilt, 0.3);
  EXPECT_DOUBLE_EQ(summary.held_by, 3.5);
  EXPECT_TRUE(std::isnan(summary_of({}).tilt));
}

}  // namespace
}  // namespace slipbench::reproduce::nib_figures_test

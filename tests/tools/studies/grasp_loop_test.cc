// The controls of the study of learned detectors: what learns nothing needs no training.

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::grasp_loop_test {
namespace {

// Two pads of 4 N hold 2 mu 4 N: 1.2 of 2.9 N at mu 0.15, 2.4 of 4.9 N at 0.3, 4 of 2 N at 0.5. The oracle's loop has no ceiling.
TEST(GraspLoop, NeverTighteningDropsWhatThePresetForceCannotHold) {
  ReproduceOptions options;
  options.trials = 2;
  options.only = {"oracle", "never"};
  const Result result = learned_grasp_loop(options);
  ASSERT_THAT(result.tables, SizeIs(4));
  ASSERT_THAT(result.tables[0].rows, SizeIs(2));
  const Json& loop = result.figures["loop"];
  for (const char* condition : {"mu 0.15, 0.3 kg", "mu 0.3, 0.5 kg"}) {
    EXPECT_EQ(loop[condition]["never"]["dropped"], 2) << condition;
    EXPECT_EQ(loop[condition]["oracle"]["dropped"], 0) << condition;
  }
  const Json& holds = loop["mu 0.5, 0.2 kg: the preset force holds"]["never"];
  EXPECT_EQ(holds["dropped"], 0);
  EXPECT_GT(holds["greatest_force_ratio"].get<double>(), 1.0);
}

TEST(GraspLoop, UnknownRowsGetTheNearest) {
  ReproduceOptions options;
  options.only = {"grasp_gro"};
  EXPECT_THAT(refusal_of([&] { learned_grasp_loop(options); }), mentions({"grasp_gru"}));
  options.only = {"papilarray"};
  EXPECT_THAT(refusal_of([&] { learned_scaling(options); }), mentions({"papillarray"}));
}

}  // namespace
}  // namespace slipbench::reproduce::grasp_loop_test

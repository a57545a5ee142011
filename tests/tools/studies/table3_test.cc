// Table III of the nib pad's paper: what is asked for is what runs, and the page says what the figures say.
#include <numbers>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::table3_test {
namespace {

ReproduceOptions one_trial_of(const std::string& cell) {
  ReproduceOptions options;
  options.trials = 1;
  options.jobs = 1;
  options.only = {cell};
  return options;
}

TEST(NibTable3, NamesThatNothingHasAreRefused) {
  const std::string said = refusal_of([&] { nib_table3(one_trial_of("com_hi")); });
  EXPECT_THAT(said, HasSubstr("--only: unknown name 'com_hi'"));
  EXPECT_THAT(said, HasSubstr("allowed: 200g, 100g, 300g, com_low, com_high, masonite, wavy, fl_slip_x0.5"));
}

#ifdef SLIPBENCH_WITH_MUJOCO

TEST(NibTable3, IsTheSameOnAnyNumberOfThreads) {
  ReproduceOptions options = one_trial_of("com_low");
  const Result one = nib_table3(options);
  options.jobs = 2;
  const Result two = nib_table3(options);
  EXPECT_EQ(one.figures, two.figures);
  ASSERT_THAT(one.tables, SizeIs(2));
  for (const ResultTable& table : one.tables) {
    ASSERT_THAT(table.rows, SizeIs(1));
    EXPECT_THAT(table.rows, Each(SizeIs(table.head.size())));
  }
  EXPECT_EQ(one.tables[0].rows[0][1], "11 of 11");
  const Json& cell = one.figures["cells"][0];
  EXPECT_EQ(cell["name"], "com_low");
  EXPECT_EQ(cell["published"], 11);
  EXPECT_EQ(cell["trials"], 1);
  int ended = 0;
  for (const Json& n : cell["ends"]) ended += n.get<int>();
  EXPECT_EQ(ended, 1);
  EXPECT_EQ(cell["ends"]["standing"], cell["standing"]);
  EXPECT_LE(cell["median_least_tilt_rad"], cell["median_tilt_rad"]);
  EXPECT_THAT(cell["command"].get<std::string>(), HasSubstr("--set 'box.weight_place=[0 mm, 41.08 mm, 0 mm]'"));
}

// With half of fl_slip the grip is firm enough for the decrements that turning takes: the box comes up, whatever becomes of it then.
TEST(NibTable3, AFirmerGripTurnsTheBoxUp) {
  const Result result = nib_table3(one_trial_of("fl_slip_x0.5"));
  EXPECT_LT(result.figures["cells"][0]["median_least_tilt_rad"].get<double>(), 20.0 * std::numbers::pi / 180.0);
}

#endif

}  // namespace
}  // namespace slipbench::reproduce::table3_test

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "sim/core/pad_state.h"
#include "sim/core/process/interrupted.h"
#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tests/tools/program/train/small_dataset.h"
#include "tools/studies/hd_papillarray/hd_tables.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

// By one thread, which has to say what three say. Every row is as long as its table's head.
Result same_on_any_threads(Result (*table_of)(const ReproduceOptions&), ReproduceOptions options) {
  options.jobs = 1;
  Result one = table_of(options);
  options.jobs = 3;
  const Result three = table_of(options);
  EXPECT_EQ(result_page("t", one), result_page("t", three));
  EXPECT_EQ(one.figures, three.figures);
  for (const ResultTable& table : one.tables) EXPECT_THAT(table.rows, Each(SizeIs(table.head.size()))) << table.title;
  return one;
}

class Table1Test : public ::slipbench::testing::SmallDatasetTest {};

// On a given dataset: what needs fresh ones is left out.
TEST_F(Table1Test, IsTheSameOnAnyNumberOfThreads) {
  ReproduceOptions options;
  options.data = dataset();
  const Result one = same_on_any_threads(hd_table1, options);

  ASSERT_THAT(one.tables, SizeIs(4));
  EXPECT_THAT(one.tables[0].rows, SizeIs(5));  // four models, and the best constant answer
  EXPECT_EQ(one.tables[0].rows[3][0], "CL-gstHDC");
  EXPECT_EQ(one.tables[0].head[1], "recall of slip");
  EXPECT_EQ(one.tables[0].head[4], "accuracy: paper");
  EXPECT_EQ(one.tables[0].rows[3][4], "91.78 +- 0.53");
  EXPECT_EQ(one.tables[0].rows[4][2], "33.33") << "of a constant answer, in three classes";
  EXPECT_THAT(one.setup[0], HasSubstr("data.h5"));
  EXPECT_FALSE(one.figures.contains("scatter"));
  // The model of the first row of the causes is that of the ablation.
  EXPECT_EQ(one.figures["causes"]["as published"], one.figures["by_sequence"]);
}

// The signal comes while the folder is there, and before the sweep that would fill it.
TEST_F(Table1Test, AnInterruptLeavesNoFolderBehind) {
  std::filesystem::create_directory(path("tmp"));
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("TMPDIR", path("tmp").c_str(), 1);
  ReproduceOptions options;
  options.say = [&](const std::string&) {
    EXPECT_FALSE(std::filesystem::is_empty(path("tmp")));
    std::raise(SIGINT);
  };
  EXPECT_THROW(hd_table1(options), Interrupted);
  before == nullptr ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1);
  EXPECT_TRUE(std::filesystem::is_empty(path("tmp")));
}

// On a given dataset nothing is simulated, and the models are what is cut short.
TEST_F(Table1Test, AnInterruptEndsTheModels) {
  ReproduceOptions options;
  options.data = dataset();
  std::size_t variants = 0;
  options.say = [&](const std::string&) {
    if (++variants == 2) std::raise(SIGTERM);
  };
  EXPECT_THROW(hd_table1(options), Interrupted);
  EXPECT_EQ(variants, 2U);
}

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

// A log of two pillars, a row a sample.
class Log {
 public:
  // Tangential and normal forces [N].
  Log& row(PadState state, float t1 = 0.0F, float n1 = 0.0F, float t2 = 0.0F, float n2 = 0.0F) {
    force_.insert(force_.end(), {0.6F * t1, -0.8F * t1, n1, t2, 0.0F, n2});
    classes_.push_back(static_cast<std::uint8_t>(state));
    return *this;
  }
  // `times` rows of nothing.
  Log& rest(std::size_t times) {
    while (times-- > 0) row(PadState::non_slip);
    return *this;
  }
  [[nodiscard]] EstimatedForces forces(std::size_t stride = 1) const { return estimated_forces(force_, classes_, stride); }

 private:
  std::vector<float> force_;
  std::vector<std::uint8_t> classes_;
};

using enum PadState;

// sum f_t / mean(f_t/f_n).
TEST(EstimatedForces, IdealIsShearOverTheMeanRatio) {
  // Equal ratios of 1/2: 2 / (1/2), the whole normal force.
  EXPECT_NEAR(Log().row(incipient, 0.5F, 1.0F, 1.5F, 3.0F).row(gross).row(gross).rest(2).forces().ideal, 4.0, 1e-6);
  // 1/2 and 1/8 on 1 N and 4 N: 1 / (5/16).
  EXPECT_NEAR(Log().row(incipient, 0.5F, 1.0F, 0.5F, 4.0F).row(gross).row(gross).rest(2).forces().ideal, 3.2, 1e-6);
}

TEST(EstimatedForces, WhatHasNoRatioBelowOneStaysInTheSumAlone) {
  // A ratio of 2, and one without normal force, beside 1/2: (2 + 1)/(1/2).
  for (const float normal : {1.0F, 0.0F}) {
    const EstimatedForces forces = Log().row(incipient, 2.0F, normal, 1.0F, 2.0F).row(gross).row(gross).rest(2).forces();
    EXPECT_NEAR(forces.ideal, 6.0, 1e-6) << normal;
  }
  // No shear is no ratio of 0: 1/(1/2).
  EXPECT_NEAR(Log().row(incipient, 0.0F, 3.0F, 1.0F, 2.0F).row(gross).row(gross).rest(2).forces().ideal, 2.0, 1e-6);
}

TEST(EstimatedForces, AWindowNeedsThreeSlipsOfFourAndAnIncipientOne) {
  const auto with = [](PadState a, PadState b, PadState c, PadState d) {
    return Log().row(a, 1, 2).row(b, 1, 2).row(c, 1, 2).row(d, 1, 2).rest(1).forces().ideal;
  };
  EXPECT_NEAR(with(gross, non_slip, gross, incipient), 2.0, 1e-6);
  EXPECT_NEAR(with(incipient, incipient, incipient, incipient), 2.0, 1e-6);
  EXPECT_TRUE(std::isnan(with(gross, non_slip, non_slip, incipient)));
  EXPECT_TRUE(std::isnan(with(gross, gross, gross, gross)));
  EXPECT_TRUE(std::isnan(with(non_slip, non_slip, non_slip, non_slip)));
}

TEST(EstimatedForces, WindowsDoNotOverlapOnceTheyCount) {
  // Rows 0 to 3 count; row 4, whose 1 N would be the least, begins a window that does not.
  Log log = Log().row(incipient, 1, 2).row(gross, 1, 2).row(gross, 1, 2).row(gross, 1, 2).row(incipient, 0.5F, 1);
  EXPECT_NEAR(log.rest(5).forces().ideal, 2.0, 1e-6);
  // With a row before them the first window is rows 1 to 4 only if rows 0 to 3 do not count: of those two slip.
  Log later = Log().rest(2).row(gross, 1, 2).row(gross, 1, 2).row(incipient, 0.5F, 1);
  EXPECT_NEAR(later.rest(5).forces().ideal, 1.0, 1e-6);
}

// The script's loop ends one window early.
TEST(EstimatedForces, TheLastFourRowsBeginNoWindow) {
  Log log = Log().row(incipient, 1, 2).row(gross, 1, 2).row(gross, 1, 2).row(gross, 1, 2);
  EXPECT_TRUE(std::isnan(log.forces().ideal));
  EXPECT_NEAR(log.rest(1).forces().ideal, 2.0, 1e-6);
}

TEST(EstimatedForces, TheMostIsOverAllRowsUpToTenNewtons) {
  EXPECT_DOUBLE_EQ(Log().row(non_slip, 0, 4, 0, 5).row(non_slip, 0, 4, 0, 6).row(non_slip, 0, 6, 0, 5).forces().most, 10.0);
  EXPECT_TRUE(std::isnan(Log().row(non_slip, 0, 6, 0, 5).forces().most));
}

TEST(EstimatedForces, RowsWithANumberThatIsNoneAreLeftOut) {
  // Without the second row the first four of the others are a window.
  Log log = Log().row(incipient, 1, 2).row(non_slip, 1, not_a_number, 0, 7).row(non_slip, 1, 2).row(gross, 1, 2);
  const EstimatedForces forces = log.row(gross, 1, 3).rest(1).forces();
  EXPECT_NEAR(forces.ideal, 2.0, 1e-6);
  EXPECT_DOUBLE_EQ(forces.most, 3.0);
  EXPECT_NEAR(forces.ratio(), 1.5, 1e-6);
}

TEST(EstimatedForces, RowsAreTheLastSampleOfEachStride) {
  Log log;
  for (int i = 0; i < 5; ++i) log.row(non_slip, 0, 9).row(gross, 1, 8).row(incipient, 1, 2);
  const EstimatedForces forces = log.forces(3);
  EXPECT_NEAR(forces.ideal, 2.0, 1e-6);
  EXPECT_DOUBLE_EQ(forces.most, 2.0);
}

// 200 samples; the arm rises by 100 mm between sample 60 and 90, and the box stays 2 mm behind.
TEST(MarkerSlip, IsTheDifferenceOfTheMeansBeforeAndAfter) {
  std::vector<float> arm, box;
  for (int i = 0; i < 200; ++i) {
    const float share = std::clamp((static_cast<float>(i) - 60.0F) / 30.0F, 0.0F, 1.0F);
    arm.insert(arm.end(), {0, 0, 0.1F * share, 1, 0, 0, 0});
    box.insert(box.end(), {0.01F, 0, 0.098F * share, 1, 0, 0, 0});
  }
  const MarkerSlip slip = marker_slip(arm, box, 60);
  EXPECT_NEAR(slip.along, 2e-3, 1e-8);
  const double beside = std::hypot(marker_line[0], marker_line[1]);
  EXPECT_NEAR(slip.spin, std::atan(beside / 135.4e-3) - std::atan(beside / 137.4e-3), 1e-7);
}

TEST(Spread, LeavesOutWhatIsNone) {
  const Spread value = spread({4.0, not_a_number, 1.0, 2.0});
  EXPECT_EQ(value.n, 3U);
  EXPECT_DOUBLE_EQ(value.median, 2.0);
  EXPECT_NEAR(value.mean_sd.mean, 7.0 / 3.0, 1e-12);
  EXPECT_NEAR(value.mean_sd.sd, std::sqrt((25.0 + 16.0 + 1.0) / 9.0 / 2.0), 1e-12);
  EXPECT_EQ(spread({not_a_number}).n, 0U);
  EXPECT_TRUE(std::isnan(spread({}).median));
}

ReproduceOptions small(std::vector<std::string> only) {
  ReproduceOptions options;
  options.trials = 1;
  options.jobs = 1;
  options.only = std::move(only);
  return options;
}

TEST(Table2, NamesThatNothingHasAreRefused) {
  EXPECT_THAT(refusal_of([] { hd_table2(small({"ptfe", "gst_hb"})); }), mentions({"--only", "gst_hb", "gst_hd"}));
}

#ifdef SLIPBENCH_WITH_MUJOCO

TEST(Table2, RefusesAFolderThatHoldsNoMemories) {
  ReproduceOptions options = small({"as_recorded", "light", "ptfe", "gst_hd_published"});
  options.memories = "/nowhere";
  EXPECT_THAT(refusal_of([&] { hd_table2(options); }),
              AllOf(HasSubstr("as_recorded, light, ptfe, gst_hd_published, trial 0: "), HasSubstr("/nowhere"),
                    HasSubstr("--set 'grip.protocol=as_recorded' --set 'box.mass=0.2 kg'")));
}

TEST(Table2, IsTheSameOnAnyNumberOfThreads) {
  const Result one = same_on_any_threads(hd_table2, small({"as_recorded", "light", "heavy", "rubber", "hold_preset", "gst_hd"}));

  // For either box its displacements and its forces.
  ASSERT_THAT(one.tables, SizeIs(4));
  ASSERT_THAT(one.tables[0].rows, SizeIs(3));
  EXPECT_EQ(one.tables[0].rows[0][0], "rubber: published");
  EXPECT_EQ(one.tables[0].rows[0][7], "1.34 +- 3.35");
  EXPECT_EQ(one.tables[0].rows[1][0], "rubber: gst_hd, shipped memory");
  EXPECT_EQ(one.tables[1].rows[0][7], "1.36 +- 0.36");
  EXPECT_THAT(one.tables[3].rows, SizeIs(2));  // the paper has no force of the heavy box
  ASSERT_THAT(one.figures["cells"], SizeIs(4));
  EXPECT_EQ(one.figures["cells"][3]["loop"], "hold_preset");
  EXPECT_EQ(one.figures["cells"][3]["slip_mm"]["n"], 1);
  EXPECT_THAT(one.remarks.front(), StartsWith("The negative control"));
}

// Beside the published rows of their surface, and what the fit saw is said.
TEST(Table2, FittedSurfacesSayWhatTheFitSaw) {
  const Result result = hd_table2(small({"as_recorded", "light", "heavy", "rubber_fitted", "oracle"}));
  ASSERT_THAT(result.real, SizeIs(2));
  EXPECT_EQ(result.real[0].what, "slip of the light box, rubber, median, mm");
  EXPECT_EQ(result.real[0].real, 0.25);
  EXPECT_THAT(result.real[0].note, StartsWith("fitted to it"));
  EXPECT_THAT(result.real[1].note, StartsWith("not seen by the fit"));
  EXPECT_EQ(result.tables[0].rows[0][0], "rubber: published");
  EXPECT_THAT(std::string(result.figures["cells"][0]["command"]), HasSubstr("friction.static=0.5"));
}

TEST(Table2, AnInterruptEndsIt) {
  ReproduceOptions options = small({"as_recorded", "light", "rubber", "hold_preset"});
  options.trials = 1000;
  options.say = [](const std::string&) { std::raise(SIGINT); };
  EXPECT_THROW(hd_table2(options), Interrupted);
}

#endif

}  // namespace
}  // namespace slipbench::reproduce

// The explorer on small scenes: it runs and compares what it reports, within its budget's plan.
// Times are not tested.
#include "tools/cost/explore.h"

#include "tests/expect.h"
#include "tools/registry/program_catalogues.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench::cost {
namespace {

const std::string stage = std::string(SLIPBENCH_SOURCE_DIR) + "/scenes/papillarray/stage.yaml";

// The stage's slide, shortened to the slip: pressed at 0.3 s, nine onsets within half a second of
// sliding.
ExploreOptions quick(double budget) {
  ExploreOptions options;
  options.scene_path = stage;
  options.overrides = {{"duration", "1 s"}, {"motion.start", "0.5 s"}};
  options.budget = budget;
  return options;
}

const Row* find(const Exploration& exploration, const std::string& series, const std::string& label) {
  for (const Row& row : exploration.rows) {
    if (row.setting.series == series && row.setting.label == label) return &row;
  }
  return nullptr;
}

TEST(CostExplore, OnsetsOfAStageAreComparedWithTheirClosedForm) {
  const Exploration exploration = explore(quick(4.0), program_catalogues());
  EXPECT_TRUE(exploration.reference.closed_onsets);
  EXPECT_TRUE(exploration.reference.converged);
  ASSERT_TRUE(exploration.own().ok());
  const auto& own = at(exploration.own().errors, Measure::onset);
  ASSERT_TRUE(own.has_value());
  EXPECT_FALSE(own->different);
  EXPECT_LT(own->worst, 1e-3);
  EXPECT_GT(own->worst, 0.0) << "a closed form is not a run of the program";
  EXPECT_GE(exploration.own().cpu->repeats, 3U);
  for (const Row& row : exploration.rows) {
    if (row.setting.series != "field") continue;
    EXPECT_TRUE(row.ok() || row.status == Status::over_budget) << row.setting.label << ": " << row.why;
  }
}

TEST(CostExplore, WhatCannotRunIsARowThatSaysWhy) {
  ExploreOptions options = quick(3.0);
  options.overrides.push_back({"friction", "{static: 0.6, kinetic: 0.4}"});  // MuJoCo knows one coefficient
  const Exploration exploration = explore(options, program_catalogues());
  const Row* const row = find(exploration, "articulated", "1 ms");
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->status, Status::refused);
  EXPECT_THAT(row->why, HasSubstr("one coefficient of friction"));
  EXPECT_FALSE(row->cpu.has_value());
}

TEST(CostExplore, EveryEffectAndPartOfTheElectronicsHasItsPrice) {
  ExploreOptions options = quick(4.0);
  options.overrides.push_back({"effects", "[ageing, viscous_friction]"});
  options.overrides.push_back({"sensors.pad.electronics", "[noise]"});
  const Exploration exploration = explore(options, program_catalogues());
  ASSERT_EQ(exploration.prices.size(), 3U);
  EXPECT_EQ(exploration.prices[0].name, "ageing");
  EXPECT_EQ(exploration.prices[2].name, "pad: noise");
  EXPECT_TRUE(exploration.prices[2].electronics);
  // Noise affects the signal and nothing in the truth.
  EXPECT_GT(at(exploration.prices[2].changes, Measure::signal)->worst, 0.0);
  EXPECT_EQ(at(exploration.prices[2].changes, Measure::force)->worst, 0.0);
}

TEST(CostExplore, AnInterruptEndsTheTimingOnly) {
  std::atomic<bool> interrupt{false};
  ExploreOptions options = quick(30.0);
  options.interrupt = &interrupt;
  options.say = [&](const std::string& what) { interrupt = interrupt || what.starts_with("timing"); };
  const Exploration exploration = explore(options, program_catalogues());
  EXPECT_TRUE(exploration.interrupted);
  EXPECT_TRUE(exploration.reference.closed_onsets);
}

TEST(CostExplore, ABudgetOfLessThanADozenRunsIsRefused) {
  EXPECT_THAT(refusal_of([&] { explore(quick(1e-6), program_catalogues()); }), mentions({"at least"}));
}

TEST(CostExplore, AnInterruptBeforeTheReferenceLeavesNothing) {
  std::atomic<bool> interrupt{true};
  ExploreOptions options = quick(30.0);
  options.interrupt = &interrupt;
  EXPECT_THROW(explore(options, program_catalogues()), Interrupted);
}

// If the run ended first, its time would exceed such a budget.
TEST(CostExplore, AnInterruptEndsTheRunAtHand) {
  std::atomic<bool> interrupt{false};
  ExploreOptions options = quick(1e-6);
  options.interrupt = &interrupt;
  options.say = [&](const std::string&) { interrupt = true; };
  EXPECT_THROW(explore(options, program_catalogues()), Interrupted);
}

TEST(CostExplore, ASettingThatAnInterruptEndsCountsForNothing) {
  std::atomic<bool> interrupt{false};
  ExploreOptions options = quick(30.0);
  options.interrupt = &interrupt;
  std::size_t said = 0;
  options.say = [&](const std::string&) { interrupt = ++said == 3; };  // after the scene itself and the reference
  const Exploration exploration = explore(options, program_catalogues());
  EXPECT_TRUE(exploration.interrupted);
  ASSERT_EQ(exploration.rows.size(), 1U);
  EXPECT_TRUE(exploration.own().ok());
}

TEST(CostExplore, ASceneThatDoesNotRunIsAnErrorAndNoDiagram) {
  ExploreOptions options = quick(3.0);
  options.overrides.push_back({"motion.speeed", "1 mm/s"});
  EXPECT_THROW(explore(options, program_catalogues()), InputError);
  options = quick(3.0);
  options.trial = 1;
  EXPECT_THAT(refusal_of([&] { explore(options, program_catalogues()); }), mentions({"--trial", "1"}));
}

}  // namespace
}  // namespace slipbench::cost

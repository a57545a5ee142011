#include "tools/cost/explore.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "sim/core/quantity.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/trial/run_trial.h"

namespace slipbench::cost {
namespace {

using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAre;

std::set<std::string> series_of(const std::vector<Setting>& settings) {
  std::set<std::string> names;
  for (const Setting& setting : settings) names.insert(setting.series);
  return names;
}

std::vector<std::string> labels_of(const std::vector<Setting>& settings, const std::string& series) {
  std::vector<std::string> labels;
  for (const Setting& setting : settings) {
    if (setting.series == series) labels.push_back(setting.label);
  }
  return labels;
}

TEST(CostSettings, WhatMovesAsPrescribedHasNoIntegratorAndNoSolver) {
  const auto settings = settings_to_try(parsed(shipped("papillarray/stage.yaml")), 1e-3);
  EXPECT_THAT(series_of(settings), UnorderedElementsAre("field", "articulated", "contact", "rate", "elements"));
}

TEST(CostSettings, WhatForcesMoveHasThem) {
  const auto settings = settings_to_try(parsed(shipped("bodies/held_box.yaml")), 2.5e-4);
  EXPECT_THAT(series_of(settings), IsSupersetOf({"implicit", "integrator", "articulated", "contact"}));
  EXPECT_THAT(labels_of(settings, "integrator"), UnorderedElementsAre("Euler", "implicitfast", "implicit", "discrete", "RK4"));
}

TEST(CostSettings, EffectsLeaveOutWhatHasNone) {
  const Scene scene = stage_scene({{"effects", "[stribeck]"}});
  EXPECT_THAT(series_of(settings_to_try(scene, 1e-3)), UnorderedElementsAre("field", "rate", "elements"));
}

TEST(CostSettings, ASoftSkinHasASolverAndCells) {
  const auto settings = settings_to_try(parsed(shipped("soft_skin/sphere.yaml")), 1e-3);
  EXPECT_THAT(labels_of(settings, "tolerance"), ElementsAre("0.01", "0.001", "0.0001", "1e-05", "1e-06", "1e-08"));
  EXPECT_THAT(labels_of(settings, "grid"), ElementsAre("8 x 8", "16 x 16", "24 x 24", "32 x 32", "48 x 48"));
  for (const Setting& setting : settings) {
    if (setting.series != "grid") continue;
    SceneFile file = shipped("soft_skin/sphere.yaml");
    for (const Override& change : setting.changes) file.apply(change);
    const Parameters pad = parsed(file).sensors.front().parameters;
    EXPECT_DOUBLE_EQ(static_cast<double>(pad.integer("rows")) * pad.number("pitch"), 16 * 0.37e-3) << setting.label;
  }
}

// 1 kHz: ten sampling times down to a twentieth; the scene's own millisecond is the scene itself.
TEST(CostSettings, StepsGoFromTenSamplingTimesToATwentieth) {
  const auto settings = settings_to_try(parsed(shipped("papillarray/stage.yaml")), 1e-3);
  EXPECT_THAT(labels_of(settings, "field"), ElementsAre("10 ms, output at 100 Hz", "4 ms, output at 250 Hz",
                                                        "2 ms, output at 500 Hz", "0.5 ms", "0.2 ms", "0.1 ms", "50 us"));
}

// Every row can be run by its reader.
TEST(CostSettings, EverySettingOfAShippedSceneIsASceneOrRefusedByName) {
  for (const char* const name :
       {"papillarray/stage.yaml", "bodies/held_box.yaml", "grasp/lift.yaml", "biotac_sp/grasp.yaml", "soft_skin/sphere.yaml"}) {
    const Scene scene = parsed(shipped(name));
    for (const Setting& setting : settings_to_try(scene, 1e-3)) {
      EXPECT_NO_THROW(parsed(shipped(name, setting.changes))) << name << ": " << setting.series << ", " << setting.label;
    }
  }
}

// The springs of its fingers are unstable above half a millisecond in the other scenes' steps.
TEST(CostSettings, EveryContactOfAGraspIsOneThatStarts) {
  std::set<double> steps;
  for (const Setting& setting : settings_to_try(parsed(shipped("grasp/lift.yaml")), 5e-4)) {
    if (setting.series != "contact") continue;
    const Scene scene = parsed(shipped("grasp/lift.yaml", setting.changes));
    steps.insert(scene.time_step.value());
    EXPECT_NO_THROW(check_trial(scene, 0)) << setting.label;
  }
  EXPECT_THAT(steps, ElementsAre(5e-5, 1e-4, 2e-4, 5e-4));
}

// 2,400 readings a second: 4 ms are 10 sampling times of 0.41667 ms, rounded; 2 ms are 5, 1 ms 2
// (2.4), 0.5 ms 1 (1.2), and 0.2 ms a third of one (0.48; at least three parts are short enough).
TEST(CostSettings, StepsOfMujocosContactFitAnyRate) {
  std::set<double> parts;
  for (const Setting& setting : settings_to_try(parsed(shipped("nib_pad/calibrate_lying.yaml")), 1.0 / 2400.0)) {
    if (setting.series != "contact") continue;
    const auto step = std::ranges::find(setting.changes, "time_step", &Override::path);
    ASSERT_NE(step, setting.changes.end()) << setting.label;
    parts.insert(1e-6 * std::round(1e6 * 2400.0 * parse_quantity(step->value, Quantity::time)));
  }
  EXPECT_THAT(parts, ElementsAre(1e-6 * 333333, 1.0, 2.0, 5.0, 10.0));
}

TEST(CostSettings, EverySeriesIsDeclared) {
  std::set<std::string> declared;
  for (const Series& series : all_series()) declared.insert(series.name);
  for (const char* const name : {"papillarray/stage.yaml", "bodies/held_box.yaml", "grasp/lift.yaml"}) {
    for (const std::string& series : series_of(settings_to_try(parsed(shipped(name)), 1e-3)))
      EXPECT_THAT(declared, Contains(series));
  }
}

}  // namespace
}  // namespace slipbench::cost

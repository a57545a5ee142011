#include "tools/cost/setting_search.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/quantity.h"
#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench::testing {
namespace {

constexpr std::uint64_t seed = 7;

SceneFile file_of(const std::string& text) { return SceneFile::from_text("slipbench: 1\n" + text, "scene.yaml"); }

using Texts = std::vector<std::string>;

// The setting found for the trials of the scene's own sweep, or of `sweep`.
FoundSetting found_for(const SceneFile& file, const Texts& accuracy, const SweepOptions& sweep = {}) {
  std::vector<Requirement> required;
  for (const std::string& text : accuracy) required.push_back(parse_requirement(text));
  const Catalogues catalogues = program_catalogues();
  return find_setting({file, seed, plan_trials(file, catalogues, sweep, seed)}, required);
}

std::string refusal(const std::string& text, const std::string& accuracy) {
  return refusal_of([&] { found_for(file_of(text), {accuracy}); });
}

// Runs one trial of the scene with other overrides.
TrialResult run_with(SceneFile file, const std::vector<Override>& overrides, std::size_t trial, Scene* scene = nullptr) {
  for (const Override& change : overrides) file.apply(change);
  const Scene as_set = TrialPlan(file, program_catalogues(), 0, seed).trial(trial).scene;
  if (scene != nullptr) *scene = as_set;
  return run_trial(as_set, trial, Recording::full);
}

double step_of(const std::vector<Override>& overrides) {
  const auto step = std::ranges::find(overrides, "time_step", &Override::path);
  return parse_quantity(step->value, Quantity::time);
}

const std::string stage = "duration: 1.2 s\nsensors: {pad: {type: papillarray, rate: 100 Hz}}\n";
const std::string moves = "motion: {kind: stage, start: 0.7 s, ";

TEST(FindSetting, TakesTheLongestStepWhereTheFieldIsExact) {
  // At constant speed each onset is exact at any step, and the closed form reports that.
  const FoundSetting found = found_for(file_of(stage + moves + "speed: 8 mm/s, acceleration: inf}\n"), {"onset=0.01 %"});
  EXPECT_EQ(found.reference, "closed form");
  ASSERT_EQ(found.overrides.size(), 1U);
  EXPECT_EQ(setting_text(found.overrides), "time_step 10 ms");
  EXPECT_EQ(found.tried.size(), 1U);
  EXPECT_EQ(found.trials, std::vector<std::size_t>{0});
}

TEST(FindSetting, HalvesTheStepUntilTheErrorIsSmall) {
  // In acceleration at 50 mm/s2 the straight line of a step is off by at most a h^2/8, 0.6 um at 10
  // ms, which is 0.1 % of the corners' 0.5 mm.
  const std::string text = stage + moves + "speed: 16 mm/s, acceleration: 50 mm/s2}\n";
  const FoundSetting found = found_for(file_of(text), {"onset=0.001 %"});
  ASSERT_GE(found.tried.size(), 3U);
  for (std::size_t k = 0; k < found.tried.size(); ++k) {
    EXPECT_EQ(step_of(found.tried[k].overrides), 0.01 / static_cast<double>(1U << k));
    const MeasureError& error = at(found.tried[k].errors, Measure::onset).value();
    EXPECT_EQ(error.worst <= margin * 1e-5, found.tried[k].met) << k;
    EXPECT_EQ(found.tried[k].met, k + 1 == found.tried.size()) << k;
  }
  // A looser requirement gives a longer step; the same requirement gives the same setting.
  const FoundSetting looser = found_for(file_of(text), {"onset=1 %"});
  EXPECT_GT(step_of(looser.overrides), step_of(found.overrides));
  EXPECT_EQ(setting_text(found_for(file_of(text), {"onset=0.001 %"}).overrides), setting_text(found.overrides));
}

// The error of the solver of a skin is separated from the error of the step only if the requirement
// is tight enough.
TEST(FindSetting, TightensTheSolverOfASoftSkinWhereTheAccuracyNeedsIt) {
  const std::string skin =
      "duration: 0.5 s\nsurface: {shape: sphere, radius: 40 mm}\neffects: [elastic_skin]\n"
      "sensors: {pad: {type: taxels, rows: 8, columns: 8, pitch: 0.74 mm, rate: 1 kHz}}\n"
      "motion: {kind: stage, compression: 0.15 mm, gap: 0.1 mm, speed: 0.4 mm/s, start: 0.2 s}\n";
  const std::string loose = setting_text(found_for(file_of(skin), {"force=10 %"}).overrides);
  const std::string tight = setting_text(found_for(file_of(skin), {"force=0.1 %"}).overrides);
  EXPECT_EQ(loose.find("tolerance"), std::string::npos) << loose;
  EXPECT_NE(tight.find("effects.0.elastic_skin.tolerance"), std::string::npos) << tight;
  // Not if the sweep sets it or the effects around it, and never looser than in the scene.
  for (const char* const sweep : {"{effects: [[elastic_skin], []]}", "{effects.0: [elastic_skin, stribeck]}",
                                  "{effects.0.elastic_skin.tolerance: [1e-3, 1e-6]}"}) {
    const FoundSetting swept = found_for(file_of(skin + "sweep: " + sweep + "\n"), {"force=5 %"});
    EXPECT_EQ(swept.reference.find("tolerance"), std::string::npos) << sweep << ": " << swept.reference;
  }
  SceneFile own = file_of(skin);
  own.apply({"effects", "[elastic_skin: {tolerance: 1e-9}]"});
  EXPECT_THAT(found_for(own, {"force=1 %"}).reference, HasSubstr("tolerance 1e-09"));
}

TEST(FindSetting, LooksAtTrialsSpreadOverTheSweep) {
  const FoundSetting found =
      found_for(file_of(stage + moves +
                        "speed: 8 mm/s}\n"
                        "sweep: {motion.direction: {draw: uniform, min: 0 deg, max: 90 deg}, trials: 9}\n"),
                {"micro_onset=1 %", "slip_distance=5 %"});
  EXPECT_EQ(found.trials, (std::vector<std::size_t>{0, 2, 4, 6, 8}));
  EXPECT_EQ(found.reference.substr(0, 10), "time_step ");  // distances have no closed form
  EXPECT_LE(at(found.reference_errors, Measure::slip_distance)->worst, reference_share * 0.05);
}

TEST(FindSetting, LooksAtTheTrialsThatRun) {
  const SceneFile file = file_of(stage + moves +
                                 "speed: 8 mm/s, acceleration: inf}\n"
                                 "sweep: {motion.direction: {draw: uniform, min: 0 deg, max: 90 deg}}\n");
  SweepOptions sweep;
  EXPECT_THAT(found_for(file, {"onset=1 %"}, sweep).trials, ElementsAre(0));
  sweep.trials = 6;  // draws of the one cell: k 5/4, rounded down
  EXPECT_THAT(found_for(file, {"onset=1 %"}, sweep).trials, ElementsAre(0, 1, 2, 3, 5));
  sweep.only = 4;  // one of these, with their setting
  EXPECT_THAT(found_for(file, {"onset=1 %"}, sweep).trials, ElementsAre(0, 1, 2, 3, 5));
  SweepOptions run;
  run.limit = 3;  // the first three, of more than in the scene's sweep
  EXPECT_THAT(found_for(file, {"onset=1 %"}, run).trials, ElementsAre(0, 1, 2));
}

TEST(FindSetting, SaysStepsToFourDigits) {
  // 10 ms / 44 has no short decimal; the override is exact, the displayed value is not.
  const double step = 0.01 / 44;
  const std::string exact = format_quantity(step, Quantity::time);
  EXPECT_EQ(parse_quantity(exact, Quantity::time), step);
  EXPECT_EQ(setting_text({{"time_step", exact}, {"field_solver", "implicit"}}), "time_step 227.3 us, field_solver implicit");
  EXPECT_EQ(setting_text({{"time_step", "2 ms"}}), "time_step 2 ms");
}

TEST(FindSetting, RefusesWhatNeverHappens) {
  EXPECT_THAT(refusal(stage + moves + "speed: 0 mm/s}\n", "onset=1 %"), mentions({"cost: --accuracy onset: ", "trials", "0"}));
}

TEST(FindSetting, RefusesWhatCannotBeShown) {
  // Distances are float32, exact to 1e-7, and texture makes them depend on the step.
  const std::string message = refusal(stage + moves + "speed: 8 mm/s}\neffects: [texture]\n", "slip_distance=0.000001 %");
  EXPECT_THAT(message, mentions({"cost: --accuracy slip_distance: ", "1e-06 %", "time_step"}));
}

TEST(FindSetting, RefusesSensorsWithoutACommonStep) {
  EXPECT_THAT(
      refusal("sensors: {a: {type: papillarray}, b: {type: piezo_skin, rate: 10007 Hz, label_rate: 10007 Hz}}\n", "onset=1 %"),
      mentions({"cost: --accuracy: ", "sampling times"}));
}

TEST(FindSetting, RefusesASweepOverWhatItFinds) {
  EXPECT_THAT(refusal(stage + "sweep: {time_step: [1 ms, 2 ms]}\n", "onset=1 %"),
              refused_at("scene.yaml:4", {"the sweep varies time_step", "--set time_step=null"}));
}

// A scene's own step is replaced, and its own solver is kept.
TEST(FindSetting, ReplacesTheScenesStep) {
  const std::string moving = stage + moves + "speed: 8 mm/s, acceleration: inf}\n";
  EXPECT_EQ(setting_text(found_for(file_of(moving + "time_step: 1 ms\n"), {"onset=0.01 %"}).overrides), "time_step 10 ms");
}

TEST(Requirements, AreRead) {
  const Requirement onset = parse_requirement("onset=0.5 %"), creep = parse_requirement("creep=2 um/s");
  EXPECT_EQ(onset.measure, Measure::onset);
  EXPECT_EQ(onset.limit, 0.005);
  EXPECT_EQ(creep.measure, Measure::creep);
  EXPECT_EQ(creep.limit, 2e-6);
  const auto refused = [](const char* text) { return refusal_of([=] { parse_requirement(text); }); };
  EXPECT_THAT(refused("onsets=1 %"), mentions({"--accuracy onsets=1 %", "unknown measure 'onsets'", "'onset'"}));
  EXPECT_THAT(refused("onset"), mentions({"--accuracy onset: "}));
  EXPECT_THAT(refused("creep=1 %"), mentions({"--accuracy creep=1 %", "speed"}));
  EXPECT_THAT(refused("onset=200 %"), mentions({"--accuracy onset=200 %", "100 %"}));
}

// The printed setting can be pasted, and the printed command uses it.
TEST(CostProgram, PrintsTheSettingForAnAccuracy) {
  const TemporaryFolder folder;
  const std::string scene = folder / "s.yaml";
  std::ofstream(scene) << "slipbench: 1\n" << stage << moves << "speed: 8 mm/s, acceleration: inf}\n";
  const ChildResult text = run_program_file({"cost", scene, "--accuracy", "onset=1%"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, StartsWith("--set 'time_step=10 ms'\n"));
  EXPECT_THAT(text.out, mentions({"allowed 1 %", "closed form", "run " + scene + " --set 'time_step=10 ms'"}));
  EXPECT_EQ(run_program_file({"cost", scene, "--accuracy", "onset=1%", "-q"}).out, "--set 'time_step=10 ms'\n");
  const auto json = nlohmann::json::parse(run_program_file({"cost", scene, "--accuracy", "onset=1%", "--json"}).out);
  EXPECT_EQ(json.at("setting"), (nlohmann::json{{"time_step", "10 ms"}}));
  EXPECT_EQ(json.at("errors").at("onset").at("allowed"), 0.01);
  EXPECT_LE(json.at("errors").at("onset").at("worst").get<double>(), 0.005);
  EXPECT_EQ(run_program_file({"run", scene, "--set", "time_step=10 ms", "-q"}).status, 0);
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--stability"}, {"--trial", "1"}, {"--budget", "30s"}}) {
    std::vector<std::string> words{"cost", scene, "--accuracy", "onset=1%"};
    words.insert(words.end(), more.begin(), more.end());
    const ChildResult refused = run_program_file(words);
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("--accuracy needs SCENE.yaml, and can only be combined with"));
  }
}

// Ten scenes made for this test; each found setting is compared with a separate run that is finer
// than any run of the search.
struct SearchedScene {
  const char* name;
  std::string text;
  bool forces = false;  // bodies move by forces
};

void PrintTo(const SearchedScene& searched, std::ostream* out) { *out << searched.name; }

std::vector<SearchedScene> searched_scenes() {
  const std::string pad = "sensors: {pad: {type: papillarray, rate: 100 Hz}}\n",
                    bristles = "sensors: {pad: {type: papillarray, rate: 250 Hz, bristles: 6, profile: hexapod}}\n";
  const std::string holding =
      "model: " SLIPBENCH_SOURCE_DIR
      "/scenes/bodies/two_fingers.xml\n"
      "bodies: {box: {shape: box, size: [40 mm, 40 mm, 60 mm], mass: 100 g, position: [0 mm, 0 mm, 100 mm]}}\n"
      "controls: {left: [[0.1 s, 4 N], [0.5 s, 0.5 N]], right: [[0.1 s, 4 N], [0.5 s, 0.5 N]]}\n"
      "sensors:\n"
      "  left: {type: papillarray, rate: 1 kHz, site: left_pad, touches: [box]}\n"
      "  right: {type: papillarray, rate: 1 kHz, site: right_pad, touches: [box]}\n";
  return {
      {"SpeedingUp", "duration: 1.1 s\n" + moves + "speed: 30 mm/s, acceleration: 80 mm/s2, direction: 200 deg}\n" + pad},
      {"Slow", "duration: 1.6 s\nfriction: {static: 0.3, kinetic: 0.2}\n" + moves + "speed: 1 mm/s}\n" + bristles},
      {"Tilted",
       "duration: 1.2 s\nfriction: {static: 0.9, kinetic: 0.9}\n" + moves + "speed: 10 mm/s, tilt: [1 deg, -1.5 deg]}\n" + pad},
      {"Turning", "duration: 1.2 s\n" + moves + "speed: 4 mm/s, rotation: 60 deg/s, pivot: [5 mm, 2 mm]}\n" + bristles},
      {"Reversing", "duration: 1.5 s\n" + moves + "speed: 6 mm/s, reverse: 150 ms}\n" + bristles},
      {"OnASphere",
       "duration: 1.2 s\nsurface: {shape: sphere, radius: 60 mm}\n" + moves + "speed: 8 mm/s, rotation: 20 deg/s}\n" + pad},
      {"Viscoelastic", "duration: 1.2 s\neffects: [viscoelastic]\n" + moves + "speed: 12 mm/s}\n" + pad},
      {"Stribeck", "duration: 1.2 s\neffects: [stribeck, ageing]\n" + moves + "speed: 5 mm/s}\n" + bristles},
      {"HeldBox", "duration: 0.6 s\nfriction: {static: 0.5, kinetic: 0.5}\n" + holding, true},
      {"Lift",
       "duration: 3 s\nsurface: {material: ptfe}\nbox: {mass: 0.4 kg}\nmotion: {kind: lift, distance: 50 mm}\ncontroller: {type: hold_preset}\n" +
           pad,
       true},
  };
}

class OnsetSearch : public ::testing::TestWithParam<SearchedScene> {};

TEST_P(OnsetSearch, IsMetAgainstAFinerRun) {
#ifndef SLIPBENCH_WITH_MUJOCO
  if (GetParam().forces) GTEST_SKIP() << "a scene of bodies, and this build has no MuJoCo";
#endif
  for (const double limit : {0.01, 0.001}) {
    if (GetParam().forces && limit < 0.01) continue;  // takes a minute
    const SceneFile file = file_of(GetParam().text);
    const FoundSetting found = found_for(file, {fmt::format("onset={}", limit)});
    const bool exact = found.reference == "closed form";
    const double step = exact ? step_of(found.overrides) / 16.0 : step_of(found.reference_overrides) / 2.0;
    Scene scene;
    const TrialResult finer = run_with(file, {{"time_step", format_quantity(step, Quantity::time)}}, 0, &scene);
    const MeasureError error = at(compare(scene, run_with(file, found.overrides, 0), finer), Measure::onset).value();
    EXPECT_LE(error.worst, limit) << setting_text(found.overrides) << " against " << found.reference;
    EXPECT_FALSE(error.different);
    fmt::print("{}, {} %: {}, off by {} against {}; the search's reference: {}\n", GetParam().name, 100.0 * limit,
               setting_text(found.overrides), error_text(Measure::onset, error.worst), format_quantity(step, Quantity::time),
               found.reference);
  }
}

INSTANTIATE_TEST_SUITE_P(TenScenes, OnsetSearch, ::testing::ValuesIn(searched_scenes()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace slipbench::testing

#include "tools/cost/kept_setting.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/quantity.h"
#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench::testing {
namespace {

const std::string dragged =
    "slipbench: 1\nduration: 1.2 s\nmotion: {kind: stage, start: 0.7 s, speed: 8 mm/s}\n"
    "sensors: {pad: {type: papillarray, rate: 100 Hz}}\n";

struct KeptSettingTest : FolderTest {
  KeptSettingTest() { write("s.yaml", dragged + "accuracy: {onset: 1 %}\n"); }

  void write(const std::string& name, const std::string& bytes) const { std::ofstream(path(name), std::ios::binary) << bytes; }
  [[nodiscard]] std::string read(const std::string& name) const { return bytes_of(path(name)); }
  // Counts in `searches_` how often it searched.
  std::optional<KeptSetting> settle_for(SweepOptions sweep) {
    if (sweep.scene_path.empty()) sweep.scene_path = path("s.yaml");
    return setting_for(sweep, program_catalogues(), [this] { ++searches_; });
  }
  std::optional<KeptSetting> settle(const std::vector<Override>& overrides = {}, std::optional<std::uint64_t> seed = {}) {
    SweepOptions sweep;
    sweep.overrides = overrides;
    sweep.seed = seed;
    return settle_for(sweep);
  }
  std::string refusal(const std::string& name = "s.yaml") {
    SweepOptions sweep;
    sweep.scene_path = path(name);
    return refusal_of([&] { settle_for(sweep); });
  }

  int searches_ = 0;
};

TEST_F(KeptSettingTest, IsLookedForOnce) {
  const KeptSetting first = settle().value();
  EXPECT_EQ(first.file, path("s.yaml.accuracy.json"));
  EXPECT_EQ(first.overrides.front().path, "accuracy");
  EXPECT_EQ(first.overrides.front().value, "none");
  EXPECT_EQ(first.overrides.back().path, "time_step");
  EXPECT_THAT(first.text, HasSubstr("slip onset error "));
  const std::string bytes = read("s.yaml.accuracy.json");
  const KeptSetting again = settle().value();
  EXPECT_EQ(searches_, 1);
  EXPECT_EQ(again.overrides.back().value, first.overrides.back().value);
  EXPECT_EQ(again.text, first.text);
  EXPECT_EQ(read("s.yaml.accuracy.json"), bytes);
  EXPECT_THAT(names(), ElementsAre("s.yaml", "s.yaml.accuracy.json"));
}

TEST_F(KeptSettingTest, HoldsItsEvidence) {
  settle();
  const auto json = nlohmann::json::parse(read("s.yaml.accuracy.json"));
  const auto& entry = json.at("settings").at(0);
  EXPECT_EQ(entry.at("subject").at("scene_sha256").get<std::string>().size(), 64U);
  EXPECT_EQ(entry.at("wish").at("onset"), 0.01);
  EXPECT_EQ(entry.at("reference").at("is"), "closed form");
  EXPECT_EQ(entry.at("trials"), nlohmann::json::array({0}));
  EXPECT_LE(entry.at("looks").back().at("errors").at("onset").at("worst").get<double>(), 0.005);
  EXPECT_EQ(entry.at("looks").back().at("met"), true);
}

TEST_F(KeptSettingTest, IsOfThisSceneAlone) {
  settle();
  settle({{"motion.speed", "4 mm/s"}});
  settle({}, 3);
  EXPECT_EQ(searches_, 3);
  settle({{"motion.speed", "4 mm/s"}});
  settle({}, 3);
  settle();
  EXPECT_EQ(searches_, 3);
  write("s.yaml", dragged + "accuracy: {onset: 2 %}\n");
  settle();
  EXPECT_EQ(searches_, 4);
  // Settings for the old text are gone.
  EXPECT_EQ(nlohmann::json::parse(read("s.yaml.accuracy.json")).at("settings").size(), 1U);
}

TEST_F(KeptSettingTest, IsOfTheseTrialsAlone) {
  write("s.yaml", dragged + "accuracy: {onset: 1 %}\nsweep: {motion.direction: {draw: uniform, min: 0 deg, max: 90 deg}}\n");
  SweepOptions run;
  run.limit = 1;
  SweepOptions sweep;
  sweep.trials = 6;
  settle_for(run);
  settle_for(sweep);
  EXPECT_EQ(searches_, 2);
  settle_for(run);
  settle_for(sweep);
  SweepOptions first;  // the scene's own sweep: its one trial
  settle_for(first);
  SweepOptions one = sweep;  // its bytes include those of the one trial
  one.only = 4;
  settle_for(one);
  EXPECT_EQ(searches_, 2);
  one.only = 6;
  EXPECT_THAT(refusal_of([&] { settle_for(one); }), mentions({"trial 6", "0", "5"}));
  EXPECT_EQ(searches_, 2);
  const auto entries = nlohmann::json::parse(read("s.yaml.accuracy.json")).at("settings");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries.at(0).at("trials"), nlohmann::json::array({0}));
  EXPECT_EQ(entries.at(1).at("trials"), nlohmann::json::array({0, 1, 2, 3, 5}));
  EXPECT_EQ(entries.at(1).at("subject").at("trials").at("asked"), 6);
}

// Errors of a scene without an accuracy requirement are reported once, when the scene runs.
TEST_F(KeptSettingTest, ReadsNoMoreThanTheKeyOfASceneWithoutAWish) {
  write("s.yaml", dragged + "surface: {material: no such material}\n");
  EXPECT_FALSE(settle().has_value());
  write("s.yaml", dragged + "surface: {material: no such material}\naccuracy: {onset: 1 %}\n");
  EXPECT_THAT(refusal(), HasSubstr("no such material"));
}

TEST_F(KeptSettingTest, IsNoneWithoutAWish) {
  EXPECT_FALSE(settle({{"accuracy", "none"}}).has_value());
  EXPECT_TRUE(settle({{"accuracy", "none"}, {"accuracy", "{micro_onset: 1 %}"}}).has_value());
}

TEST_F(KeptSettingTest, RefusesADamagedFile) {
  write("s.yaml.accuracy.json", "{");
  EXPECT_THAT(refusal(), mentions({path("s.yaml.accuracy.json"), "settings"}));
  EXPECT_THAT(refusal(), mentions({"remove"}));
  std::filesystem::remove(path("s.yaml.accuracy.json"));
  settle();
  // A setting that someone has edited no longer matches its evidence.
  std::string bytes = read("s.yaml.accuracy.json");
  bytes.replace(bytes.find("10 ms"), 5, "20 ms");
  write("s.yaml.accuracy.json", bytes);
  EXPECT_THAT(refusal(), mentions({"entry"}));
}

TEST_F(KeptSettingTest, NamesTheFileThatCannotBeWrittenBeforeItLooks) {
  const std::string without_wish = "--set accuracy=none";
  std::filesystem::create_directory(path("s.yaml.accuracy.json"));
  EXPECT_THAT(refusal(), refused_at(path("s.yaml.accuracy.json"), {"not a file", without_wish}));
  std::filesystem::remove(path("s.yaml.accuracy.json"));
  std::filesystem::create_directory(path("s.yaml.accuracy.json.partial"));
  EXPECT_THAT(refusal(), mentions({path("s.yaml.accuracy.json.partial"), "a folder", without_wish}));
  // No user can write a file of this name: with .accuracy.json it exceeds the 255 bytes of a name.
  const std::string name = std::string(245, 's') + ".yaml";
  std::filesystem::rename(path("s.yaml"), path(name));
  EXPECT_THAT(refusal(name), mentions({path(name) + ".accuracy.json", "File name too long", without_wish}));
  EXPECT_EQ(searches_, 0);
  EXPECT_THAT(names(), ElementsAre("s.yaml.accuracy.json.partial", name));
  SweepOptions without;
  without.scene_path = path(name);
  without.overrides = {{"accuracy", "none"}};
  EXPECT_FALSE(settle_for(without).has_value());
}

TEST_F(KeptSettingTest, MakesTheSceneOneThatItsCommandRepeats) {
  const auto options = [&](const std::vector<Override>& overrides, const std::string& output) {
    SweepOptions sweep;
    sweep.scene_path = path("s.yaml");
    sweep.overrides = overrides;
    sweep.output = path(output);
    return sweep;
  };
  EXPECT_THROW(run_sweep(options({}, "wish.h5"), program_catalogues()), std::logic_error);
  const KeptSetting setting = settle().value();
  const std::string command = run_sweep(options(setting.overrides, "first.h5"), program_catalogues()).command;
  EXPECT_THAT(command, HasSubstr("s.yaml --set accuracy=none --set 'time_step="));
  std::filesystem::remove(path("s.yaml.accuracy.json"));
  run_sweep(options(settle()->overrides, "second.h5"), program_catalogues());
  EXPECT_EQ(read("first.h5"), read("second.h5"));
}

constexpr std::uint64_t seed = 7;

SceneFile file_of(const std::string& text) { return SceneFile::from_text("slipbench: 1\n" + text, "wish.yaml"); }

// The setting found for the trials of the scene's own sweep, or of `sweep`.
std::optional<FoundSetting> look_for(const SceneFile& file, const SweepOptions& sweep = {}) {
  const Catalogues catalogues = program_catalogues();
  return find_setting(plan_trials(file, catalogues, sweep, seed));
}

FoundSetting found_for(const SceneFile& file, const SweepOptions& sweep = {}) { return look_for(file, sweep).value(); }

std::string refusal(const std::string& text) {
  return refusal_of([&] { look_for(file_of(text)); });
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

TEST(FindSetting, LooksForNothingWithoutAWish) { EXPECT_FALSE(look_for(file_of(stage)).has_value()); }

TEST(FindSetting, TakesTheLongestStepWhereTheFieldIsExact) {
  // At constant speed each onset is exact at any step, and the closed form reports that.
  const FoundSetting found = found_for(file_of(stage + moves + "speed: 8 mm/s, acceleration: inf}\naccuracy: {onset: 0.01 %}\n"));
  EXPECT_EQ(found.reference, "closed form");
  ASSERT_EQ(found.overrides.size(), 2U);
  EXPECT_EQ(setting_text(found.overrides), "time_step 10 ms");
  EXPECT_EQ(found.looks.size(), 1U);
  EXPECT_EQ(found.trials, std::vector<std::size_t>{0});
}

TEST(FindSetting, HalvesTheStepUntilTheWishIsMet) {
  // In acceleration at 50 mm/s2 the straight line of a step is off by at most a h^2/8, 0.6 um at 10
  // ms, which is 0.1 % of the corners' 0.5 mm.
  const std::string text = stage + moves + "speed: 16 mm/s, acceleration: 50 mm/s2}\naccuracy: {onset: 0.001 %}\n";
  const FoundSetting found = found_for(file_of(text));
  ASSERT_GE(found.looks.size(), 3U);
  for (std::size_t k = 0; k < found.looks.size(); ++k) {
    EXPECT_EQ(step_of(found.looks[k].overrides), 0.01 / static_cast<double>(1U << k));
    const MeasureError& error = at(found.looks[k].errors, Measure::onset).value();
    EXPECT_EQ(error.worst <= margin * 1e-5, found.looks[k].met) << k;
    EXPECT_EQ(found.looks[k].met, k + 1 == found.looks.size()) << k;
  }
  // A looser requirement gives a longer step; the same requirement gives the same setting.
  const FoundSetting looser =
      found_for(file_of(stage + moves + "speed: 16 mm/s, acceleration: 50 mm/s2}\naccuracy: {onset: 1 %}\n"));
  EXPECT_GT(step_of(looser.overrides), step_of(found.overrides));
  EXPECT_EQ(setting_text(found_for(file_of(text)).overrides), setting_text(found.overrides));
}

// The error of the solver of a skin is separated from the error of the step only if the requirement
// is tight enough.
TEST(FindSetting, TightensTheSolverOfASoftSkinWhereTheWishNeedsIt) {
  const std::string skin =
      "duration: 0.5 s\nsurface: {shape: sphere, radius: 40 mm}\neffects: [elastic_skin]\n"
      "sensors: {pad: {type: taxels, rows: 8, columns: 8, pitch: 0.74 mm, rate: 1 kHz}}\n"
      "motion: {kind: stage, compression: 0.15 mm, gap: 0.1 mm, speed: 0.4 mm/s, start: 0.2 s}\n";
  const std::string loose = setting_text(found_for(file_of(skin + "accuracy: {force: 10 %}\n")).overrides);
  const std::string tight = setting_text(found_for(file_of(skin + "accuracy: {force: 0.1 %}\n")).overrides);
  EXPECT_EQ(loose.find("tolerance"), std::string::npos) << loose;
  EXPECT_NE(tight.find("effects.0.elastic_skin.tolerance"), std::string::npos) << tight;
  // Not if the sweep sets it or the effects around it, and never looser than in the scene.
  for (const char* const sweep : {"{effects: [[elastic_skin], []]}", "{effects.0: [elastic_skin, stribeck]}",
                                  "{effects.0.elastic_skin.tolerance: [1e-3, 1e-6]}"}) {
    const FoundSetting swept = found_for(file_of(skin + "accuracy: {force: 5 %}\nsweep: " + sweep + "\n"));
    EXPECT_EQ(swept.reference.find("tolerance"), std::string::npos) << sweep << ": " << swept.reference;
  }
  SceneFile own = file_of(skin + "accuracy: {force: 1 %}\n");
  own.apply({"effects", "[elastic_skin: {tolerance: 1e-9}]"});
  EXPECT_NE(found_for(own).reference.find("tolerance 1e-09"), std::string::npos) << found_for(own).reference;
}

TEST(FindSetting, LooksAtTrialsSpreadOverTheSweep) {
  const FoundSetting found =
      found_for(file_of(stage + moves +
                        "speed: 8 mm/s}\naccuracy: {micro_onset: 1 %, slip_distance: 5 %}\n"
                        "sweep: {motion.direction: {draw: uniform, min: 0 deg, max: 90 deg}, trials: 9}\n"));
  EXPECT_EQ(found.trials, (std::vector<std::size_t>{0, 2, 4, 6, 8}));
  EXPECT_EQ(found.reference.substr(0, 10), "time_step ");  // distances have no closed form
  EXPECT_LE(at(found.reference_errors, Measure::slip_distance)->worst, reference_share * 0.05);
}

TEST(FindSetting, LooksAtTheTrialsThatRun) {
  const SceneFile file = file_of(stage + moves +
                                 "speed: 8 mm/s, acceleration: inf}\naccuracy: {onset: 1 %}\n"
                                 "sweep: {motion.direction: {draw: uniform, min: 0 deg, max: 90 deg}}\n");
  SweepOptions sweep;
  EXPECT_THAT(found_for(file, sweep).trials, ElementsAre(0));
  sweep.trials = 6;  // draws of the one cell: k 5/4, rounded down
  EXPECT_THAT(found_for(file, sweep).trials, ElementsAre(0, 1, 2, 3, 5));
  sweep.only = 4;  // one of these, with their setting
  EXPECT_THAT(found_for(file, sweep).trials, ElementsAre(0, 1, 2, 3, 5));
  SweepOptions run;
  run.limit = 3;  // the first three, of more than in the scene's sweep
  EXPECT_THAT(found_for(file, run).trials, ElementsAre(0, 1, 2));
}

TEST(FindSetting, SaysStepsToFourDigits) {
  // 10 ms / 44 has no short decimal; the override is exact, the displayed value is not.
  const double step = 0.01 / 44;
  const std::string exact = format_quantity(step, Quantity::time);
  EXPECT_EQ(parse_quantity(exact, Quantity::time), step);
  EXPECT_EQ(setting_text({{"accuracy", "none"}, {"time_step", exact}, {"field_solver", "implicit"}}),
            "time_step 227.3 us, field_solver implicit");
  EXPECT_EQ(setting_text({{"time_step", "2 ms"}}), "time_step 2 ms");
}

TEST(FindSetting, RefusesAWishForWhatNeverHappens) {
  EXPECT_THAT(refusal(stage + moves + "speed: 0 mm/s}\naccuracy: {onset: 1 %}\n"),
              refused_at("wish.yaml:5", {"accuracy.onset", "trials", "0"}));
}

TEST(FindSetting, RefusesAWishThatCannotBeShown) {
  // Distances are float32, exact to 1e-7, and texture makes them depend on the step.
  const std::string message =
      refusal(stage + moves + "speed: 8 mm/s}\neffects: [texture]\naccuracy: {slip_distance: 0.000001 %}\n");
  EXPECT_THAT(message, mentions({"wish.yaml:6", "accuracy.slip_distance", "1e-06 %", "time_step"}));
}

TEST(FindSetting, RefusesSensorsWithoutACommonStep) {
  EXPECT_THAT(
      refusal(
          "sensors: {a: {type: papillarray}, b: {type: piezo_skin, rate: 10007 Hz, label_rate: 10007 Hz}}\naccuracy: {onset: 1 %}\n"),
      refused_at("wish.yaml:3", {"accuracy", "sampling times"}));
}

// Ten scenes made for this test; each found setting is compared with a separate run that is finer
// than any run of the search.
struct Wished {
  const char* name;
  std::string text;
  bool forces = false;  // bodies move by forces
};

void PrintTo(const Wished& wished, std::ostream* out) { *out << wished.name; }

std::vector<Wished> wished_scenes() {
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

class OnsetWish : public ::testing::TestWithParam<Wished> {};

TEST_P(OnsetWish, IsMetAgainstAFinerRun) {
#ifndef SLIPBENCH_WITH_MUJOCO
  if (GetParam().forces) GTEST_SKIP() << "a scene of bodies, and this build has no MuJoCo";
#endif
  for (const double wish : {0.01, 0.001}) {
    if (GetParam().forces && wish < 0.01) continue;  // takes a minute
    const SceneFile file = file_of(GetParam().text + fmt::format("accuracy: {{onset: {}}}\n", wish));
    const FoundSetting found = found_for(file);
    const bool exact = found.reference == "closed form";
    const double step = exact ? step_of(found.overrides) / 16.0 : step_of(found.reference_overrides) / 2.0;
    Scene scene;
    const TrialResult finer =
        run_with(file, {{"accuracy", "none"}, {"time_step", format_quantity(step, Quantity::time)}}, 0, &scene);
    const MeasureError error = at(compare(scene, run_with(file, found.overrides, 0), finer), Measure::onset).value();
    EXPECT_LE(error.worst, wish) << setting_text(found.overrides) << " against " << found.reference;
    EXPECT_FALSE(error.different);
    fmt::print("{}, wish {} %: {}, off by {} against {}; the search's reference: {}\n", GetParam().name, 100.0 * wish,
               setting_text(found.overrides), error_text(Measure::onset, error.worst), format_quantity(step, Quantity::time),
               found.reference);
  }
}

INSTANTIATE_TEST_SUITE_P(TenScenes, OnsetWish, ::testing::ValuesIn(wished_scenes()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace slipbench::testing

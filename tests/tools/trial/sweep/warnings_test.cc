// Valid scenes that are hardly intended.
#include "tools/trial/sweep/warnings.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "detectors/network/engine.h"
#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench::testing {
namespace {

struct Warnings : FolderTest {
  // Warnings for a pad on a stage, whose scene has these lines 1 and 2.
  std::vector<Warning> find_warnings(const std::string& text, const std::vector<Override>& overrides = {}) {
    std::ofstream(path("s.yaml")) << "slipbench: 1\nsensors: {pad: {type: papillarray}}\n" << text;
    SweepOptions sweep;
    sweep.scene_path = path("s.yaml");
    sweep.overrides = overrides;
    sweep.output = path("out.h5");
    sweep.limit = sweep.overrides.empty() ? 0 : 1;
    return scene_warnings(read_sweep(sweep, catalogues_), sweep);
  }
  // Subject and message of each warning, without the folder.
  std::vector<std::string> warning_texts(const std::string& text, const std::vector<Override>& overrides = {}) {
    std::vector<std::string> lines;
    for (const Warning& warning : find_warnings(text, overrides)) {
      const std::size_t folder = warning.text.find(path(""));
      lines.push_back(folder == 0 ? warning.text.substr(path("").size()) : warning.text);
      EXPECT_THAT(warning.text, HasSubstr(": " + warning.about));
    }
    return lines;
  }

  Catalogues catalogues_ = program_catalogues();
};

TEST_F(Warnings, MotionThatBeginsAtTheEndOrLater) {
  EXPECT_THAT(warning_texts("motion: {start: 4 s}\n"),
              ElementsAre("s.yaml:3: motion.start: 4 s is not before the end of the trial, 4 s, so the motion never starts"));
  EXPECT_THAT(warning_texts("motion: {start: 3.9 s}\n"), IsEmpty());
  EXPECT_THAT(warning_texts("motion: {start: 4 s, speed: 0}\n"), IsEmpty());  // a pad that is only pressed
}

// mlp13.onnx reads one sample in five of 1 kHz.
TEST_F(Warnings, SamplesThatAreResampledForANetwork) {
  if (!network::engine_available()) GTEST_SKIP() << "built without networks";
  std::ofstream(path("s.yaml")) << "slipbench: 1\nduration: 0.1 s\nsensors: {pad: {type: papillarray}}\n"
                                   "detector: {type: network, model: " SLIPBENCH_SOURCE_DIR
                                   "/tests/detectors/network/data/mlp13.onnx}\nsweep: {sensors.pad.rate: [250 Hz, 1 kHz]}\n";
  for (const bool isolated : {false, true}) {
    SweepOptions sweep;
    sweep.scene_path = path("s.yaml");
    sweep.jobs = 1;
    sweep.isolation.on = isolated;
    const std::vector<Warning> warnings = trial_warnings(run_sweep(sweep, catalogues_).trials);
    ASSERT_THAT(warnings, SizeIs(1)) << isolated;
    EXPECT_EQ(warnings[0].text, "detector: resampled from 250 Hz to 200 Hz for mlp13.onnx in 1 of 2 trials");
  }
}

// 4.2 mm by the vendor's data sheet.
TEST_F(Warnings, PillarPressedBeyondItsHeight) {
  EXPECT_THAT(
      warning_texts("motion: {compression: 5 mm}\n"),
      ElementsAre(AllOf(StartsWith("s.yaml:3: motion.compression: 5 mm exceeds the height"), HasSubstr("'pad', 4.2 mm;"))));
  EXPECT_THAT(warning_texts("motion: {compression: 4.2 mm}\n"), IsEmpty());
}

// Three points 4/3 mm apart span a wave of 4 mm, and their sum is 0; they are in phase for its
// third harmonic. Two points 2 mm apart also cancel 4 mm and are in phase for 2 mm, which a face of
// 4 mm would average to 0. Across the ridges a grid turned by 90 degrees is equal.
TEST_F(Warnings, TextureThatTheTaxelsPointsDoNotSample) {
  const auto of_taxels = [&](const std::string& keys, const std::string& texture) {
    return warning_texts("effects: [{texture: {" + texture + "}}]\n",
                         {{"sensors", "{skin: {type: taxels, width: 4 mm, " + keys + "}}"}});
  };
  for (const char* angle : {"0 deg", "90 deg", "180 deg"}) {
    EXPECT_THAT(
        of_taxels("points: 3", std::string("wavelength: 4 mm, angle: ") + angle),
        ElementsAre(AllOf(
            HasSubstr(
                "effects.texture.wavelength: 4 mm is cancelled by sensor 'skin': the 9 points of a unit have a distance of 1.333 mm"),
            HasSubstr("= 0.000 over them; the unit vibrates at 3 speed/wavelength"))));
  }
  EXPECT_THAT(of_taxels("points: 2", "wavelength: 4 mm"), ElementsAre(HasSubstr("vibrates at 2 speed/wavelength")));
  EXPECT_THAT(of_taxels("points: 2", "wavelength: 2 mm"),
              ElementsAre(AllOf(HasSubstr("2 mm is not resolved"), HasSubstr("= 1.000 over them"))));
  // At 45 degrees the columns of the grid are 4/3 mm/sqrt 2 apart: the sum is D(pi/3/sqrt 2)^2 =
  // 0.30, D(x) = sin(3 x)/(3 sin x).
  EXPECT_THAT(of_taxels("points: 3", "wavelength: 4 mm, angle: 45 deg"), IsEmpty());
  EXPECT_THAT(of_taxels("points: 3", "wavelength: 8 mm"), IsEmpty());  // D(pi/6) = 0.67
  EXPECT_THAT(of_taxels("points: 1", "wavelength: 4 mm"), IsEmpty());
  EXPECT_THAT(of_taxels("points: 3", "wavelength: 4 mm, height: 0 mm"), IsEmpty());
  EXPECT_THAT(warning_texts("effects: [texture]\n", {{"sensors", "{pad: {type: papillarray, bristles: 5}}"}}),
              IsEmpty());  // all at the pillar's tip
}

TEST_F(Warnings, SpeedWithoutAUnit) {
  EXPECT_THAT(warning_texts("motion: {speed: 4}\n"),
              ElementsAre("s.yaml:3: motion.speed: 4 has no unit, so it is in m/s; if mm/s is meant, write '4 mm/s'"));
  EXPECT_THAT(warning_texts("motion: {speed: 4 m/s}\n"), IsEmpty());
  EXPECT_THAT(warning_texts("motion: {speed: 0.004}\n"), IsEmpty());
  EXPECT_THAT(warning_texts("sweep: {motion.speed: [4 mm/s, 4, 5]}\n"),
              ElementsAre(AllOf(HasSubstr("motion.speed: 4 has no unit"), HasSubstr("in 2 of 3 examined trials"))));
}

TEST_F(Warnings, ExtremeMassesAndLengths) {
  const auto warning_about = [&](const std::string& key, const std::string& value) {
    const std::vector<Warning> found = find_warnings("box: {mass: 200 g}\ntime_step: 1 ms\n", {{key, value}});
    return found.empty() ? "" : found.front().text;
  };
  EXPECT_EQ(warning_about("box.mass", "1e-9 kg"), "--set box.mass=1e-9 kg: box.mass: 1e-09 kg is unusual: less than 1e-06 kg");
  EXPECT_EQ(warning_about("box.mass", "200"), "");
  EXPECT_EQ(warning_about("box.mass", "2000"), "--set box.mass=2000: box.mass: 2000 kg is unusual: more than 1000 kg");
  EXPECT_EQ(warning_about("box.size", "[60, 60 mm, 100 mm]"),
            "--set box.size=[60, 60 mm, 100 mm]: box.size.0: 60 m is unusual: more than 10 m");
}

TEST_F(Warnings, MaterialThatTheScenesFrictionReplaces) {
  const std::string friction = "friction: {static: 0.5, kinetic: 0.5}\n";
  EXPECT_THAT(
      warning_texts(friction, {{"surface.material", "ptfe"}}),
      ElementsAre(AllOf(StartsWith("--set surface.material=ptfe: surface.material: has no effect"), HasSubstr("s.yaml:3"))));
  EXPECT_THAT(warning_texts("friction: {static: 0.5}\n", {{"surface.material", "ptfe"}}), IsEmpty());
  EXPECT_THAT(warning_texts(friction, {{"surface.material", "ptfe"}, {"friction.static", "0.5"}}), IsEmpty());
}

TEST_F(Warnings, PartsOfASplitWithoutATrial) {
  const std::string two = "sweep: {surface.material: [ptfe, felt], trials: 10}\n",
                    three = "sweep: {surface.material: [ptfe, felt, paper]}\n";
  EXPECT_THAT(warning_texts(two),
              ElementsAre(AllOf(HasSubstr("split: by material there are only 2 to divide, so valid is without trials"))));
  EXPECT_THAT(warning_texts(three), IsEmpty());
  // Ten repeats of two experiments are two groups.
  EXPECT_THAT(
      warning_texts(two + "split: {by: trial}\n"),
      ElementsAre(AllOf(HasSubstr("by trial there are only 2 to divide, so valid is without trials"), HasSubstr("repeats"))));
  EXPECT_THAT(warning_texts(two + "split: {by: trial}\nmotion: {kind: wander}\n"), IsEmpty()) << "each trial has its own path";
  EXPECT_THAT(warning_texts(two + "split: {shares: [0.5, 0, 0.5]}\n"), IsEmpty());
  EXPECT_THAT(
      warning_texts("sweep: {trials: 10}\nsplit: {by: material}\n"),
      ElementsAre(AllOf(StartsWith("s.yaml:4: "), HasSubstr("there is only 1 to divide, so valid and test are without trials"))));
  EXPECT_THAT(warning_texts("sweep: {trials: 10}\n"), IsEmpty()) << "no split is asked for";
  EXPECT_THAT(warning_texts("sweep: {trials: 10}\nsplit: {by: trial}\n"),
              ElementsAre(AllOf(HasSubstr("by trial there is only 1 to divide, so valid and test are without trials"),
                                HasSubstr("sweep or draw a key that changes the contact"))));
  EXPECT_THAT(warning_texts("sweep: {motion.speed: [1 mm/s, 2 mm/s, 3 mm/s], trials: 2}\nsplit: {by: speed}\n"), IsEmpty());
  EXPECT_THAT(warning_texts("sweep: {surface.shape: [plane, sphere, box]}\nsplit: {by: object}\n"), IsEmpty());
}

TEST_F(Warnings, ConverterAtAnEndInMostSamples) {
  EXPECT_THAT(converter_warnings({{"pad", {50, 100}}}), IsEmpty());
  const std::vector<Warning> most = converter_warnings({{"nib", {0, 100}}, {"pad", {51, 100}}});
  ASSERT_EQ(most.size(), 1U);
  EXPECT_EQ(most.front().about, "sensors.pad.electronics");
  EXPECT_THAT(most.front().text, HasSubstr("in 51 of 100 samples"));
}

// A day at 1 kHz has 8.64e7 steps, within the 10^8 that are allowed.
TEST_F(Warnings, StepsThatTakeTenMinutes) {
  const std::vector<Warning> found = find_warnings("duration: 86400 s\nfidelity: articulated\n");
  const auto steps = std::ranges::find(found, "time_step", &Warning::about);
  ASSERT_NE(steps, found.end());
  EXPECT_THAT(steps->text, AllOf(HasSubstr("auto gives steps of"), HasSubstr(" or more")));
  EXPECT_EQ(std::ranges::count(find_warnings("box: {mass: 200 g}\n"), "time_step", &Warning::about), 0);
  EXPECT_THAT(warning_texts("fidelity: articulated\ntime_step: 0.05 us\n"),
              ElementsAre(AllOf(StartsWith("s.yaml:4: time_step: 0.05 us gives steps of 5e-08 s"), HasSubstr("; auto chooses"))));
}

TEST_F(Warnings, ShippedScenesHaveNone) {
  std::size_t scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SLIPBENCH_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    SweepOptions sweep;
    sweep.scene_path = entry.path().string();
    sweep.output = path("out.h5");
    EXPECT_THAT(warnings_json(scene_warnings(read_sweep(sweep, catalogues_), sweep)).dump(), "[]") << entry.path();
    ++scenes;
  }
  EXPECT_GE(scenes, 20U);
}

}  // namespace
}  // namespace slipbench::testing

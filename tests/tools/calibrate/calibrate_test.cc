#include "tools/calibrate/calibrate.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/calibrate/calibrate_page.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/writer.h"
#include "tools/formats/export/export.h"
#include "tools/formats/import/import.h"
#include "tools/formats/import/source_table.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::calibrate::calibrate_test {
namespace {

// Four recordings: pressed from 0.13 s on, moved from 0.5 s on at 4 mm/s in directions of their
// own. With mu 0.5 and 7.1/3.9 N/mm a pillar that is pressed in by 1 mm slips after 0.5 * 7.1/3.9 *
// 1 mm = 0.91 mm, which takes 0.23 s and the 0.08 s of the start: all slide at the end.
constexpr const char* scene_text = R"(slipbench: 1
description: four slides
duration: 1.1 s
time_step: 1 ms
seed: 5
surface: {material: acrylic}
friction: {static: 0.5, kinetic: 0.5}
motion: {kind: stage, compression: 1 mm, start: 0.5 s, speed: 4 mm/s, tilt: [0 deg, 0 deg]}
sensors:
  pad: {type: papillarray, rate: 250 Hz, electronics: typical, profile: gripper}
sweep:
  motion: [{direction: 0 deg}, {direction: 100 deg, compression: 0.8 mm}, {direction: 200 deg}, {direction: 300 deg, compression: 0.8 mm}]
)";

struct Calibrated : slipbench::testing::FolderTest {
  Options options(const std::vector<std::string>& fits, const std::vector<Override>& overrides = {}) {
    Options result;
    result.scene_path = path("scene.yaml");
    std::ofstream(result.scene_path) << scene_text;
    result.overrides = overrides;
    for (const std::string& fit : fits) result.keys.push_back(parse_fit_keys(fit).at(0));
    result.synthetic_truth = true;
    result.starts = 1;
    result.command = "slipbench calibrate scene.yaml";
    return result;
  }
  static Json fitted(const Options& options) { return calibrate(options, program_catalogues()).json; }
  static const Json& parameter_of(const Json& result, const std::string& key) {
    for (const Json& parameter : result.at("parameters")) {
      if (parameter.at("key") == key) return parameter;
    }
    throw std::logic_error(key);
  }
  static double error(const Json& result, const std::string& key) {
    const Json& parameter = parameter_of(result, key);
    EXPECT_TRUE(parameter.at("determined").get<bool>()) << key;
    return parameter.at("error").get<double>();
  }
  static double relative(const Json& result, const std::string& key) {
    return error(result, key) / parameter_of(result, key).at("truth").get<double>();
  }
  // A dataset of the scene's trials.
  std::string simulated_with(const std::vector<Override>& overrides) {
    SweepOptions sweep;
    sweep.scene_path = path("scene.yaml");
    sweep.overrides = overrides;
    sweep.output = path("made.h5");
    run_sweep(sweep, program_catalogues(), {});
    return sweep.output;
  }
  std::string refusal(const Options& options) {
    return refusal_of([&] { fitted(options); });
  }
};

constexpr const char* normal = "sensors.pad.k_normal: {min: 4 N/mm, max: 10 N/mm}";
constexpr const char* friction = "friction.scale: {min: 0.6, max: 1.4}";

// Limits with typical electronics: 3 %, 0.02 mm, 0.2 degrees.
TEST_F(Calibrated, DrawnParametersComeBack) {
  const Json result =
      fitted(options({normal, "sensors.pad.k_tangential: {min: 2 N/mm, max: 6 N/mm}", friction,
                      "sensors.pad.edge_drop: {min: 0.1 mm, max: 0.3 mm}", "motion.tilt.1: {min: -2 deg, max: 2 deg}"}));
  EXPECT_NEAR(relative(result, "sensors.pad.k_normal"), 0.0, 0.03);
  EXPECT_NEAR(relative(result, "sensors.pad.k_tangential"), 0.0, 0.03);
  EXPECT_NEAR(relative(result, "friction.scale"), 0.0, 0.03);
  EXPECT_NEAR(error(result, "sensors.pad.edge_drop"), 0.0, 0.02e-3);
  EXPECT_NEAR(error(result, "motion.tilt.1"), 0.0, 0.2 * 3.14159 / 180.0);
  EXPECT_TRUE(recovers(result));
  // The residual is the sensor's noise, within the few percent of chance.
  EXPECT_NEAR(result.at("residual_over_repeatability").get<double>(), 1.0, 0.2);
  for (const Json& one : result.at("residuals"))
    EXPECT_LT(one.at("residual").get<double>(), 1.5 * one.at("repeatability").get<double>()) << one.dump();
}

// Nothing moves sideways, so the recordings do not determine the friction, and the scene's own
// value stays.
TEST_F(Calibrated, FrictionWithoutASlideIsNotDetermined) {
  const Json result = fitted(options({normal, friction}, {{"motion.start", "2 s"}}));
  EXPECT_NEAR(relative(result, "sensors.pad.k_normal"), 0.0, 0.03);
  EXPECT_FALSE(parameter_of(result, "friction.scale").at("determined").get<bool>());
  EXPECT_NEAR(parameter_of(result, "friction.scale").at("value").get<double>(), 1.0, 0.02);
  EXPECT_TRUE(recovers(result));
}

// The press separates the clock from the start of the slide, because the scene knows its time: it
// ends at 0.455 s.
TEST_F(Calibrated, ALateClockIsFound) {
  const Json result = fitted(options({normal, "lag: {min: -40 ms, max: 40 ms}", "motion.start: {min: 0.46 s, max: 0.6 s}"}));
  EXPECT_NEAR(error(result, "lag"), 0.0, 1e-3);
  EXPECT_NEAR(error(result, "motion.start"), 0.0, 2e-3);
}

// 0 and 360 degrees are one direction: a slide next to it is found from either side of the circle,
// with an interval that reaches over the seam, and not "at its bound". Limit: 1
// degree, because gains and couplings of typical electronics scatter by some percent for each of
// nine pillars, which turns their sum by up to 0.01 rad.
TEST_F(Calibrated, AnAngleOverItsWholeCircleHasNoBound) {
  for (const double direction : {0.2, 359.7, 350.0, 180.0}) {
    Options wanted =
        options({"motion.direction: {min: 0 deg, max: 360 deg}"}, {{"sweep", "{trials: 1}"}, {"motion.direction", "90 deg"}});
    wanted.starts = 2;
    wanted.synthetic_truth = false;
    wanted.recordings = {simulated_with({{"sweep", "{trials: 1}"}, {"motion.direction", fmt::format("{} deg", direction)}})};
    const Json fit = parameter_of(fitted(wanted), "motion.direction");
    constexpr double degree = 3.14159265358979 / 180.0;
    EXPECT_NEAR(std::remainder(fit.at("value").get<double>() / degree - direction, 360.0), 0.0, 1.0) << direction;
    EXPECT_GE(fit.at("value").get<double>(), 0.0);
    EXPECT_LT(fit.at("value").get<double>(), 360.0 * degree);
    EXPECT_TRUE(fit.at("determined").get<bool>()) << direction;
    EXPECT_FALSE(fit.at("at_bound").get<bool>()) << direction;
    EXPECT_LT(fit.at("low").get<double>(), fit.at("value").get<double>());
    EXPECT_GT(fit.at("high").get<double>(), fit.at("value").get<double>());
  }
}

// The recordings have 5.5 N/mm, which lies outside the bounds: the best value is at the nearer
// bound, and the result says so. The residuals rise away from that bound, so the recordings do
// determine the value.
TEST_F(Calibrated, AValueAtItsBoundIsCalledSo) {
  Options wanted = options({"sensors.pad.k_normal: {min: 6 N/mm, max: 10 N/mm}"},
                           {{"sensors.pad.electronics", "ideal"}, {"sensors.pad.k_normal", "7 N/mm"}});
  wanted.synthetic_truth = false;
  wanted.recordings = {simulated_with({{"sensors.pad.k_normal", "5.5 N/mm"}, {"sensors.pad.electronics", "ideal"}})};
  const Result low = calibrate(wanted, program_catalogues());
  EXPECT_NEAR(parameter_of(low.json, "sensors.pad.k_normal").at("value").get<double>(), 6000.0, 0.005 * 4000.0);
  EXPECT_TRUE(parameter_of(low.json, "sensors.pad.k_normal").at("at_bound").get<bool>());
  EXPECT_TRUE(parameter_of(low.json, "sensors.pad.k_normal").at("determined").get<bool>());
  EXPECT_THAT(low.fitted, HasSubstr(", at its bound"));
  wanted.keys = parse_fit_keys("sensors.pad.k_normal: {min: 3 N/mm, max: 5 N/mm}");
  const Json high = fitted(wanted);
  EXPECT_NEAR(parameter_of(high, "sensors.pad.k_normal").at("value").get<double>(), 5000.0, 0.005 * 2000.0);
  EXPECT_TRUE(parameter_of(high, "sensors.pad.k_normal").at("at_bound").get<bool>());
  EXPECT_TRUE(parameter_of(high, "sensors.pad.k_normal").at("determined").get<bool>());
}

TEST_F(Calibrated, EachRecordingHasItsFriction) {
  const Options wanted = options({normal, "friction.scale: {min: 0.6, max: 1.4, each: true}"});
  const Result result = calibrate(wanted, program_catalogues());
  const Json& found = parameter_of(result.json, "friction.scale").at("by_recording");
  ASSERT_EQ(found.size(), 4U);
  double mean = 0.0, square = 0.0;
  for (const Json& one : found) {
    EXPECT_NEAR(one.at("error").get<double>() / one.at("truth").get<double>(), 0.0, 0.03);
    mean += one.at("truth").get<double>() / 4.0;
    square += std::pow(one.at("truth").get<double>(), 2) / 4.0;
  }
  const double sd = std::sqrt((square - mean * mean) * 4.0 / 3.0);
  EXPECT_NEAR(parameter_of(result.json, "friction.scale").at("scatter").get<double>(), sd, 0.1 * sd);
  EXPECT_THAT(result.fitted, HasSubstr("  friction.scale: {draw: normal, mean: "));
}

// Noise of half to twice the device's own. The steps of 27 sources over some thousand samples
// determine its size to a few percent.
TEST_F(Calibrated, NoiseIsFittedByItsSize) {
  const Json result = fitted(options({normal, "sensors.pad.electronics.0.noise.scale: {min: 0.5, max: 2}"},
                                     {{"sensors.pad.electronics", "[{noise: {scale: 1}}, gain]"}}));
  EXPECT_NEAR(relative(result, "sensors.pad.electronics.0.noise.scale"), 0.0, 0.1);
  EXPECT_NEAR(relative(result, "sensors.pad.k_normal"), 0.0, 0.03);
}

TEST_F(Calibrated, ThreadsChangeNoByte) {
  Options one = options({normal, friction}, {{"motion.speed", "8 mm/s"}}), two = one;
  one.starts = two.starts = 3;
  two.jobs = 2;
  const Result first = calibrate(one, program_catalogues()), second = calibrate(two, program_catalogues());
  EXPECT_EQ(first.json.dump(), second.json.dump());
  EXPECT_EQ(first.fitted, second.fitted);
}

// Logs in the vendor's format, written from simulated trials with 5.5 N/mm. Their first column
// counts microseconds from an arbitrary start.
TEST_F(Calibrated, LogsAreReadAndTheFittedSceneIsAScene) {
  Options wanted = options({normal});
  simulated_with({{"sensors.pad.k_normal", "5.5 N/mm"}, {"sensors.pad.electronics", "ideal"}});
  ExportOptions exported;
  exported.format = ExportFormat::vendor_csv;
  export_dataset(path("made.h5"), path("logs"), exported);

  wanted.synthetic_truth = false;
  wanted.overrides = {{"sensors.pad.electronics", "ideal"}};
  wanted.recordings = {path("logs")};
  wanted.format = &import_format("papillarray-csv");
  const Result logs = calibrate(wanted, program_catalogues());
  EXPECT_NEAR(parameter_of(logs.json, "sensors.pad.k_normal").at("value").get<double>(), 5500.0, 5.5);
  wanted.format = nullptr;
  wanted.recordings = {path("made.h5")};
  EXPECT_NEAR(parameter_of(fitted(wanted), "sensors.pad.k_normal").at("value").get<double>(), 5500.0, 5.5);

  const std::vector<std::string> files = write_calibration(path("mine.yaml"), logs.fitted, logs.json);
  EXPECT_EQ(files, (std::vector<std::string>{path("mine.yaml"), path("mine.html"), path("mine.json")}));
  const Scene scene = parse_scene(SceneFile::load(path("mine.yaml")), program_catalogues());
  // The scene holds the fitted value exactly.
  EXPECT_EQ(scene.sensors.front().parameters.number("k_normal"),
            parameter_of(logs.json, "sensors.pad.k_normal").at("value").get<double>());
  EXPECT_EQ(TrialPlan(SceneFile::load(path("mine.yaml")), program_catalogues(), 0, 5).size(), 4U);
  EXPECT_THAT(calibration_page(logs.json), HasSubstr("Real and synthetic"));
}

// A trial of 1.1 s at 250 Hz has samples at 4 ms, 8 ms ... 1.1 s, a span of 1096 ms. Recordings of
// 1.2 s are 9 % longer, which is allowed for logs stopped by hand; those of 1.3 s are 18 % longer.
TEST_F(Calibrated, RecordingsLastAsLongAsTheirTrialsAndHaveTheirRate) {
  const Override one{"sweep", "{motion.direction: [0 deg]}"};
  Options wanted = options({normal}, {one, {"sensors.pad.electronics", "ideal"}});
  wanted.synthetic_truth = false;
  const auto recorded = [&](const Override& other) {
    wanted.recordings = {
        simulated_with({one, {"sensors.pad.electronics", "ideal"}, {"sensors.pad.k_normal", "5.5 N/mm"}, other})};
    return refusal(wanted);
  };
  const std::string name = "demo_0 of " + path("made.h5");
  EXPECT_EQ(recorded({"duration", "1.2 s"}), "accepted");
  EXPECT_NEAR(parameter_of(fitted(wanted), "sensors.pad.k_normal").at("value").get<double>(), 5500.0, 5.5);
  EXPECT_THAT(recorded({"duration", "1.3 s"}), refused_at(name, {"1296 ms", "1096 ms", "10 %"}));
  EXPECT_THAT(recorded({"duration", "0.9 s"}), refused_at(name, {"896 ms", "1096 ms", "10 %"}));
  EXPECT_THAT(recorded({"sensors.pad.rate", "100 Hz"}), refused_at(name, {"10 ms", "4 ms", "1 %", "100 Hz", "250 Hz"}));
  // The allowed difference increases by the largest lag.
  wanted.keys.push_back(parse_fit_keys("lag: {min: -0.1 s, max: 0.05 s}").at(0));
  EXPECT_EQ(recorded({"duration", "1.3 s"}), "accepted");
}

// Each recording is compared with its own trial.
TEST_F(Calibrated, TrialsMayLastDifferently) {
  const Override trials{"sweep", "{scene: [{duration: 1.1 s}, {duration: 1.6 s}]}"};
  Options wanted = options({normal}, {trials, {"sensors.pad.electronics", "ideal"}});
  wanted.synthetic_truth = false;
  wanted.recordings = {simulated_with({trials, {"sensors.pad.electronics", "ideal"}, {"sensors.pad.k_normal", "5.5 N/mm"}})};
  const Json result = fitted(wanted);
  EXPECT_NEAR(parameter_of(result, "sensors.pad.k_normal").at("value").get<double>(), 5500.0, 5.5);
  EXPECT_NEAR(result.at("recordings").at(1).at("compared_s").get<double>(), 1.6, 0.01);
}

TEST_F(Calibrated, RefusesWhatCannotBeFitted) {
  EXPECT_THAT(refusal(options({"sensors.pad.k_normla: {min: 1, max: 2}"})), mentions({"k_normal"}));
  EXPECT_THAT(refusal(options({normal, normal})), mentions({"sensors.pad.k_normal", "twice"}));
  EXPECT_THAT(refusal(options({"friction.scale: {min: -2, max: 1}"})), StartsWith("--fit friction.scale=-2: "));
  EXPECT_THAT(refusal(options({normal}, {{"sweep.motion.tilt.0", "{draw: uniform, min: 0 deg, max: 1 deg}"}})),
              mentions({"sweep.motion.tilt.0", "random"}));
  EXPECT_THAT(refusal(options({"sensors.pad.electronics.0.noise.scale: {min: 0.5, max: 2}"})), mentions({"electronics"}));
  Options wanted = options({normal});
  wanted.synthetic_truth = false;
  SweepOptions sweep;
  sweep.scene_path = wanted.scene_path;
  sweep.limit = 3;
  sweep.output = path("three.h5");
  run_sweep(sweep, program_catalogues(), {});
  wanted.recordings = {path("three.h5")};
  EXPECT_THAT(refusal(wanted), mentions({"3 recordings", "4 trials"}));
  { DatasetWriter(path("none.h5"), {"1.2.3", "slipbench: 1\n", "{}", 7, "slipbench sweep a.yaml"}).commit(); }
  wanted.recordings = {path("none.h5")};
  EXPECT_THAT(refusal(wanted), mentions({"none.h5", "recording"}));
  wanted.recordings = {path("three.csv")};
  EXPECT_THAT(refusal(wanted), mentions({"three.csv", "dataset", "--format"}));
  EXPECT_THROW(check_calibration_target(path("mine.txt"), {}), InputError);
  std::ofstream(path("notes.yaml")) << "mine: 1\n";
  EXPECT_THROW(check_calibration_target(path("notes.yaml"), {}), InputError);
}

TEST_F(Calibrated, RecordingsHoldTheSameArrays) {
  const Override one{"sweep", "{motion.direction: [0 deg]}"}, second{"sensors.other", "{type: papillarray, electronics: ideal}"};
  Options wanted = options({normal}, {one, second});
  wanted.synthetic_truth = false;
  std::filesystem::rename(simulated_with({one, second}), path("both.h5"));
  wanted.recordings = {path("both.h5"), simulated_with({one})};
  EXPECT_THAT(refusal(wanted), mentions({"other/force"}));
}

TEST_F(Calibrated, IsInterrupted) {
  Options wanted = options({normal});
  const std::atomic<bool> interrupt = true;
  wanted.interrupt = &interrupt;
  EXPECT_THROW(fitted(wanted), Interrupted);
}

// A value that differs from the truth by more than twice its interval is not recovered, unless it
// was reported as not determined.
TEST(Recovers, HoldsDeterminedParametersToTheirInterval) {
  const auto result = [](double error, bool determined) {
    return Json{{"parameters",
                 {{{"each", false}, {"determined", determined}, {"value", 5.0}, {"low", 4.0}, {"high", 6.0}, {"error", error}}}}};
  };
  EXPECT_TRUE(recovers(result(1.9, true)));
  EXPECT_FALSE(recovers(result(-2.1, true)));
  EXPECT_TRUE(recovers(result(-2.1, false)));
}

// Tables of a custom skin that is stiffer, more sensitive and noisier than in the scene. Noise of 8
// counts is 1 % of a reading and 0.02 % of the mean of 2,300, but the converter clips values below
// 0. So 1 % is allowed, and 10 % of the noise.
TEST_F(Calibrated, ASkinOfOnesOwnByAColumnMap) {
  const std::map<std::string, double> truth{
      {"k_normal", 1700}, {"k_tangential", 620}, {"curve.1.1", 1100}, {"electronics.0.white_noise.scale", 2}};
  std::vector<std::string> fits;
  SweepOptions sweep;
  for (const auto& [key, value] : truth) {
    fits.push_back(fmt::format("sensors.skin.{}: {{min: {}, max: {}}}", key, 0.3 * value, 2.5 * value));
    sweep.overrides.push_back({"sensors.skin." + key, std::to_string(value)});
  }
  Options wanted = options(fits);
  std::ofstream(wanted.scene_path) << R"(slipbench: 1
duration: 1.6 s
friction: {static: 0.6, kinetic: 0.6}
motion: {compression: 0.5 mm, start: 0.6 s, speed: 3 mm/s}
sensors:
  skin: {type: taxels, channels: {force: force, counts: signal}, curve: [[0, 0], [1, 800]], electronics: [{white_noise: {scale: 1}}, quantisation]}
sweep: {motion: [{direction: 0 deg}, {direction: 100 deg, compression: 0.4 mm}, {direction: 200 deg, compression: 0.6 mm}]}
)";
  sweep.scene_path = wanted.scene_path;
  sweep.output = path("made.h5");
  run_sweep(sweep, program_catalogues(), {});
  RecordingWriter writer({.sources = {"made"}, .output = path("mine.h5"), .map = "map.yaml"}, "trial");
  const DatasetReader made(path("made.h5"));
  for (const std::size_t trial : made.trials()) {
    TrialRecord recording = make_recording({{"file", std::to_string(trial)}}, "");
    recording.sensors.push_back(made.read_sensor(trial, "skin"));
    recording.sensors.back().labels = LabelRecord();
    recording.sensors.back().labels.truth = false;
    recording.body_time = recording.sensors.back().time;
    writer.add(std::move(recording), "made", 0);
  }
  wanted.recordings = writer.finish(1).files;
  wanted.synthetic_truth = false;
  const Json result = fitted(wanted);
  for (const auto& [key, value] : truth)
    EXPECT_NEAR(parameter_of(result, "sensors.skin." + key).at("value").get<double>() / value, 1.0, key[0] == 'e' ? 0.1 : 0.01)
        << key;
  EXPECT_THAT(calibration_page(result), Not(HasSubstr("when sensors.skin.electronics")));  // keys without a profile
}

}  // namespace
}  // namespace slipbench::calibrate::calibrate_test

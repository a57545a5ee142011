// Custom sensors in whole trials: a library, and the PapillArray defined in three ways.
#include <cmath>
#include <fstream>
#include <vector>

#include "sensors/plugins/plugin_sensor.h"
#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tools/registry/program_catalogues.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {
namespace {

const std::string plugins = SLIPBENCH_TEST_PLUGINS;

SceneFile stage(const std::string& sensor, const std::string& more = "") {
  return SceneFile::from_text(
      "slipbench: 1\nduration: 1 s\nmotion: {compression: 1 mm, start: 0.5 s, speed: 4 mm/s, rotation: 20 deg/s, tilt: [1 deg, 2 deg]}\n"
      "sensors:\n  pad: {" +
          sensor + "}\n" + more,
      "stage.yaml");
}
TrialRecord record_of(const std::string& sensor, const std::string& more = "") {
  return run_trial(parse_scene(stage(sensor, more), program_catalogues()), 3, Recording::full).record;
}
std::string wrong(const std::string& fault) {
  return "type: plugin, library: " + plugins + "/wrong.so, parameters: {fault: " + fault + "}";
}
std::string outcome(const std::string& sensor) {
  std::string said = refusal_of([&] { static_cast<void>(record_of(sensor)); });
  const std::string name = "'" + plugins + "/wrong.so'";
  const std::size_t at = said.find(name);
  return at == std::string::npos ? said : said.replace(at, name.size(), "IT");
}

// Nine pillars in columns from +Y to -Y, each from +X to -X, 7 mm apart; those at the edges 0.2 mm
// shorter, at the corners 0.45 mm.
const std::string nine_taxels =
    "type: taxels, rate: 1 kHz, k_normal: 7.1 N/mm, k_tangential: 3.9 N/mm, channels: {force: force}, places: ["
    "[7 mm, 7 mm, 0.45 mm], [0, 7 mm, 0.2 mm], [-7 mm, 7 mm, 0.45 mm], [7 mm, 0, 0.2 mm], [0, 0], [-7 mm, 0, 0.2 mm], "
    "[7 mm, -7 mm, 0.45 mm], [0, -7 mm, 0.2 mm], [-7 mm, -7 mm, 0.45 mm]]";

TEST(OwnSensor, APapillArrayIsTheSameAsTaxelsAndAsALibrary) {
  const TrialRecord built_in = record_of("type: papillarray");
  for (const std::string& own : {nine_taxels, "type: plugin, library: " + plugins + "/nine_pillars.so"}) {
    const TrialRecord record = record_of(own);
    ASSERT_EQ(record.sensors[0].time, built_in.sensors[0].time);
    const std::vector<float>&expected = built_in.sensors[0].channels[0].values, &found = record.sensors[0].channels[0].values;
    ASSERT_EQ(found.size(), expected.size());
    double largest = 0.0, worst = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      largest = std::max(largest, std::abs(static_cast<double>(expected[i])));
      worst = std::max(worst, std::abs(static_cast<double>(found[i]) - static_cast<double>(expected[i])));
    }
    EXPECT_GT(largest, 1.0);
    EXPECT_LE(worst, 1e-12) << own;
    EXPECT_EQ(record.sensors[0].labels.onset_time, built_in.sensors[0].labels.onset_time);
  }
}

// The library's noise is uniform in +-0.1 N here: sd 0.1/sqrt(3), to 2 % with 27,000 draws, and
// different in another trial.
TEST(OwnSensor, DrawsAsTrialAndSeedSay) {
  const std::string pillars = "type: plugin, library: " + plugins + "/nine_pillars.so";
  const std::string noisy = pillars + ", parameters: {noise: 100 mN}";
  const TrialRecord record = record_of(noisy), again = record_of(noisy), other = record_of(noisy, "seed: 1\n");
  const std::vector<float>& values = record.sensors[0].channels[0].values;
  EXPECT_EQ(values, again.sensors[0].channels[0].values);
  EXPECT_NE(values, other.sensors[0].channels[0].values);
  const std::vector<float> quiet = record_of(pillars).sensors[0].channels[0].values;
  double square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) square += std::pow(static_cast<double>(values[i] - quiet[i]), 2);
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(values.size())), 0.1 / std::sqrt(3.0), 0.02 * 0.1 / std::sqrt(3.0));
}

TEST(OwnSensor, IsRefusedWithWhatItSaid) {
  EXPECT_EQ(outcome(wrong("none")), "accepted");
  EXPECT_THAT(outcome(wrong("refuses")), refused_at("sensors.pad.library", {"no, thanks"}));
  EXPECT_THAT(outcome(wrong("rate")), refused_at("sensors.pad.library", {"rate", "-1 Hz"}));
  EXPECT_THAT(outcome(wrong("bare")), refused_at("sensors.pad.library", {"0 elements", "4096"}));
  EXPECT_THAT(outcome(wrong("soft")), refused_at("sensors.pad.library", {"element 1", "stiffness", "0 N/m"}));
  EXPECT_THAT(outcome(wrong("direction")), refused_at("sensors.pad.library", {"element 0", "direction"}));
  EXPECT_THAT(outcome(wrong("nowhere")), refused_at("sensors.pad.library", {"element 1", "tip"}));
  EXPECT_THAT(outcome(wrong("gap")), refused_at("sensors.pad.library", {"element 1", "unit 2", "unit 1"}));
  EXPECT_THAT(outcome(wrong("mute")), refused_at("sensors.pad.library", {"0 channels", "64"}));
  EXPECT_THAT(outcome(wrong("empty")), refused_at("sensors.pad.library", {"force", "values"}));
  EXPECT_THAT(outcome(wrong("times")), refused_at("sensors.pad.library", {"channel", "t"}));
  EXPECT_THAT(outcome("type: plugin"), refused_at("sensors.pad.library", {"path"}));
  EXPECT_THAT(outcome(wrong("none, falt: 1")), refused_at("sensors.pad.parameters.falt", {"falt", "fault"}));
}

TEST(OwnSensor, ThatFailsIsNamedWithItsFunction) {
  EXPECT_THAT(outcome(wrong("nan")), refused_at("sensors.pad.library", {"nan", "force_1_1", "0 s"}));
  EXPECT_THAT(outcome(wrong("infinite")), refused_at("sensors.pad.library", {"inf", "force_1_2", "0 s"}));
  EXPECT_THAT(outcome(wrong("throws")), refused_at("sensors.pad.library", {"out of ideas", "measure"}));
}

TEST(OwnSensor, ThatCastsConstAwayChangesNoLabel) {
  const auto truth = [](const std::string& fault) { return record_of(wrong(fault)).sensors[0].labels.force; };
  EXPECT_EQ(truth("writes"), truth("none"));
}

// wrong.cc is also built into this program: as a bundled sensor it gives the same values and
// errors, under the scene's type.
TEST(OwnSensor, OfTheProgramItselfIsCheckedAsALibrary) {
  static constexpr slipbench_note note{"The kind of fault.", "the test's", 0.0, 0.0,
                                       "none|refuses|rate|bare|soft|gap|mute|empty|times|nan|throws"};
  static constexpr slipbench_about about{"A sensor with a fault.", "", "the test's", &note, nullptr};
  static constexpr BundledSensor bundled{"faulty", slipbench_sensor_parameters, &about, &slipbench_make_sensor};
  const auto make = [](const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) {
    return make_bundled(bundled, scene.parameters, seed, trial, scene.name);
  };
  register_sensor({.about = {bundled.type, about.summary, about.law, about.source, specs_of(bundled)}, .electronics = {}}, make);
  const Catalogues catalogues = program_catalogues();
  for (const std::string& fault : catalogues.sensors.back().parameters[0].choices) {
    std::string expected = outcome(wrong(fault));
    const std::string library = "library: IT";
    if (const std::size_t at = expected.find(library); at != std::string::npos)
      expected.replace(at, library.size(), "type: 'faulty'");
    EXPECT_EQ(outcome("type: faulty, fault: " + fault), expected);
  }
  EXPECT_THAT(outcome("type: faulty, fault: nun"), mentions({"nun", "nan"}));
}

// Two of four trials run; the others fail: one with an error at a line of the scene, one with a
// crashed process.
TEST(OwnSensor, EndsItsOwnTrialOnly) {
  const std::string scene = testing::TempDir() + "own_faults.yaml", data = testing::TempDir() + "own_faults.h5";
  std::ofstream(scene) << stage(wrong("none"), "sweep: {sensors.pad.parameters.fault: [none, nan, crashes, none]}\n").text();
  SweepOptions options;
  options.scene_path = scene;
  options.output = data;
  options.isolation.on = true;
  const SweepSummary summary = run_sweep(options, program_catalogues(), {});
  EXPECT_EQ(summary.trials.size(), 2U);
  ASSERT_EQ(summary.failed.size(), 2U);
  EXPECT_EQ(summary.failed[0].trial, 1U);
  EXPECT_THAT(summary.failed[0].message, HasSubstr("own_faults.yaml:5: sensors.pad.library: "));
  EXPECT_EQ(summary.failed[1].trial, 2U);
  EXPECT_THAT(summary.failed[1].message, HasSubstr("SIGSEGV"));
}

}  // namespace
}  // namespace slipbench

// A detector from a shared library in whole trials: its parameters from a scene and a sweep, and
// all sensors.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/dataset/record/encoder.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/sweep_shard.h"

namespace slipbench {
namespace {

const std::string plugins = SLIPBENCH_TEST_PLUGINS;

SceneFile stage(const std::string& more, const std::string& sensors = "pad: {type: papillarray}") {
  return SceneFile::from_text(
      "slipbench: 1\nduration: 1 s\nfriction: {static: 0.5, kinetic: 0.5}\n"
      "motion: {compression: 1 mm, start: 0.5 s, speed: 4 mm/s}\nsensors: {" +
          sensors + "}\n" + more + "\n",
      "stage.yaml");
}

std::string with_parameters(const std::string& parameters) {
  return "detector: {type: plugin, library: " + plugins + "/ratio_gate.so, parameters: " + parameters + "}";
}

std::string refusal(const std::string& more) {
  return refusal_of([&] { static_cast<void>(parsed(stage(more))); });
}

// The example's estimate for a sample of nine forces.
std::uint8_t gate(const float* force, double threshold) {
  double x = 0.0, y = 0.0, z = 0.0;
  for (std::size_t i = 0; i < 9; ++i) {
    x += static_cast<double>(force[3 * i]);
    y += static_cast<double>(force[3 * i + 1]);
    z += static_cast<double>(force[3 * i + 2]);
  }
  if (z < 0.05) return 0;
  const double ratio = std::sqrt(x * x + y * y) / z;
  return ratio < 0.8 * threshold ? 1 : ratio < threshold ? 2 : 3;
}

// A resumed run must know whether they have changed.
TEST(PluginInTrial, LibrariesAreNamedFiles) {
  const std::string library = plugins + "/ratio_gate.so";
  std::set<std::string> paths;
  add_named_files(parsed(stage("detector: {type: plugin, library: " + library + "}")), catalogues(), paths);
  EXPECT_THAT(paths, ElementsAre(library));
  EXPECT_THAT(HeldFiles(paths).digests(), ElementsAre(Pair(library, file_sha256(library))));
  EXPECT_THAT(HeldFiles({plugins}).digests(), Contains(Pair(library, file_sha256(library))));
  paths.clear();
  // A name of a shipped classifier is not a file.
  for (const char* detector : {"force_ratio", "gst_hd", "gst_hd, memories: cl_gst_hd", "gst_hd, memories: learn_gst_hd"}) {
    add_named_files(parsed(stage(std::string("detector: {type: ") + detector + "}")), catalogues(), paths);
    EXPECT_THAT(paths, IsEmpty()) << detector;
  }
}

TEST(PluginInTrial, SaysWhatItsLawSaysOfTheSamples) {
  for (const double threshold : {0.3, 0.45}) {
    const Scene scene = parsed(stage(with_parameters("{threshold: " + std::to_string(threshold) + ", rate: 100 Hz}")));
    const TrialRecord record = run_trial(scene, 0, Recording::full).record;
    EXPECT_EQ(record.control->detector, "plugin");
    ASSERT_EQ(record.sensors[0].channels[0].name, "force");
    const std::vector<float>& force = record.sensors[0].channels[0].values;
    std::vector<std::uint8_t> expected;
    for (std::size_t i = 0; i < record.sensors[0].time.size(); ++i) {
      expected.push_back(gate(force.data() + 27 * (i - i % 10), threshold));  // every tenth of 1 kHz
    }
    EXPECT_EQ(record.control->detector_class, expected);
    for (const int state : {0, 1, 2, 3}) EXPECT_THAT(expected, Contains(state));
  }
}

TEST(PluginInTrial, ThresholdsAreSwept) {
  const SceneFile file = stage(with_parameters("{rate: 100 Hz}") + "\nsweep: {detector.parameters.threshold: [0.3, 0.45]}");
  const TrialPlan plan(file, catalogues(), 0, 0);
  ASSERT_EQ(plan.size(), 2U);
  std::vector<std::vector<std::uint8_t>> classes;
  for (std::size_t i = 0; i < 2; ++i) {
    const TrialPlan::Trial trial = plan.trial(i);
    ASSERT_EQ(trial.drawn.size(), 1U);
    EXPECT_EQ(trial.drawn[0].first, "detector.parameters.threshold");
    EXPECT_EQ(trial.drawn[0].second, i == 0 ? "0.3" : "0.45");
    EXPECT_EQ(trial.scene.detector->parameters.map("parameters"),
              (ParameterMap{{"rate", "100 Hz"}, {"threshold", i == 0 ? "0.3" : "0.45"}}));
    classes.push_back(run_trial(trial.scene, i, Recording::full).record.control->detector_class);
  }
  EXPECT_NE(classes[0], classes[1]);
}

// Values are reported in SI, with their types.
TEST(PluginInTrial, SweptValuesAreReportedAsWhatTheyAre) {
  const SceneFile file =
      stage(with_parameters("{}") + "\nsweep: {scene: [{detector: {parameters: {a: 4 mm/s, b: true, c: soft rubber, d: 1e3}}}]}");
  const TrialPlan::Trial trial = TrialPlan(file, catalogues(), 0, 0).trial(0);
  const std::vector<std::pair<std::string, std::string>> expected{{"detector.parameters.a", "0.004"},
                                                                  {"detector.parameters.b", "true"},
                                                                  {"detector.parameters.c", "\"soft rubber\""},
                                                                  {"detector.parameters.d", "1000"}};
  EXPECT_EQ(trial.drawn, expected);
}

TEST(PluginInTrial, ParametersAreAMapOfPlainValues) {
  EXPECT_THAT(refusal(with_parameters("0.3")), refused_at("stage.yaml:6", {"detector.parameters", "0.3", "map"}));
  EXPECT_THAT(refusal(with_parameters("{threshold: [1, 2]}")),
              refused_at("stage.yaml:6", {"detector.parameters.threshold", "sequence"}));
  EXPECT_THAT(refusal(with_parameters("{thres.hold: 1}")), refused_at("stage.yaml:6", {"thres.hold", "parameter"}));
}

// A skin of 10 kHz and the pad of 1 kHz. The library is updated at every sample of the pad; its
// estimate is visible a millisecond later, its latency.
TEST(PluginInTrial, HearsASensorThatItDoesNotRead) {
  const std::string sensors = "pad: {type: papillarray}, skin: {type: piezo_skin}";
  const TrialRecord bare = run_trial(parsed(stage("", sensors)), 0, Recording::full).record;
  ASSERT_EQ(bare.sensors[1].channels[0].values.size(), bare.sensors[1].time.size()) << "one value a sample";
  const std::vector<float>& signal = bare.sensors[1].channels[0].values;
  const double threshold = 0.5 * static_cast<double>(*std::ranges::max_element(signal));
  const Scene scene = parsed(stage("detector: {type: plugin, sensor: pad, library: " + plugins +
                                       "/ears.so, parameters: {sensor: skin, threshold: " + std::to_string(threshold) + "}}",
                                   sensors));
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  ASSERT_EQ(record.sensors[1].channels[0].values, signal) << "who listens changes nothing";
  const std::vector<std::uint8_t>& seen = record.control->detector_class;
  std::vector<std::uint8_t> expected{0};
  for (std::size_t i = 0; i + 1 < seen.size(); ++i) {
    expected.push_back(static_cast<double>(signal[10 * i]) > threshold ? 3 : 1);
  }
  EXPECT_EQ(seen, expected);
  EXPECT_THAT(expected, Contains(3));
}

}  // namespace
}  // namespace slipbench

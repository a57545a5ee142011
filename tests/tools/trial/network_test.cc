// Networks in whole trials.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>

#include "tests/detectors/network/networks.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/trial/run_trial.h"

namespace slipbench::network_trial_test {
namespace {

Scene scene_with(const std::string& detector) { return stage_scene({{"detector", detector}}); }

std::string network_of(const std::string& name, const std::string& more = "") {
  return "{type: network, model: " + network::shipped(name) + more + "}";
}

// ctest runs each test in a separate process; run by hand this must be the first test with a
// network.
TEST(NetworkInTrial, LoadsItsLibrariesWhereASceneNamesOneAlone) {
  run_trial(scene_with("{type: force_ratio}"), 0, Recording::full);
  EXPECT_FALSE(network::openvino_is_loaded());
  run_trial(scene_with(network_of("gru21.onnx")), 0, Recording::full);
  EXPECT_TRUE(network::openvino_is_loaded());
}

TEST(NetworkInTrial, SaysWhatTheSameNetworkSaysOfTheRecordedSamples) {
  const TrialRecord record = run_trial(scene_with(network_of("gru21.onnx")), 0, Recording::full).record;
  const SensorRecord& sensor = record.sensors.at(0);
  const auto force = std::ranges::find(sensor.channels, "force", &SensorColumn::name);
  ASSERT_NE(force, sensor.channels.end());
  const std::size_t samples = record.control->detector_class.size();
  const std::size_t width = force->values.size() / samples;
  network::Gru gru;
  std::array<std::size_t, 2> said{};
  for (std::size_t row = 0; row < samples; ++row) {
    const std::array<float, 3> input{force->values[row * width], force->values[row * width + 1], force->values[row * width + 2]};
    const double p = gru.step(input)[1];
    if (std::abs(p - 0.6) < 1e-5) continue;  // float32 may decide otherwise here
    const bool slips = p >= 0.6;
    ++said[slips ? 1 : 0];
    ASSERT_EQ(record.control->detector_class[row], slips ? 3 : 1) << "row " << row;
  }
  EXPECT_GT(said[0], 100u);
  EXPECT_GT(said[1], 100u);
}

TEST(NetworkInTrial, ItsLatencyIsTheLoops) {
  const auto prompt = run_trial(scene_with(network_of("gru21.onnx")), 0, Recording::full).record.control->detector_class;
  const auto late =
      run_trial(scene_with(network_of("gru21.onnx", ", latency: 5 ms")), 0, Recording::full).record.control->detector_class;
  ASSERT_EQ(prompt.size(), late.size());
  for (std::size_t row = 0; row < late.size(); ++row) {
    ASSERT_EQ(late[row], row < 5 ? 0 : prompt[row - 5]) << "row " << row;  // 5 samples of 1 ms
  }
}

TEST(NetworkInTrial, AModelOfAnotherSensorIsRefusedAtItsKey) {
  const Scene scene = parsed(shipped("piezo_skin/slide.yaml", {{"detector", network_of("gru21.onnx")}}));
  EXPECT_THAT(scene_refusal_of([&] { run_trial(scene, 0, Recording::full); }),
              AllOf(StartsWith("detector.model | "),
                    HasSubstr("the network reads a 'papillarray' according to its metadata, but this sensor is a 'piezo_skin'")));
}

}  // namespace
}  // namespace slipbench::network_trial_test

// A network as a detector: its estimates equal the output of the same network outside, frame by
// frame.

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

#include "detectors/detector_kinds.h"
#include "detectors/network/engine.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "tests/detectors/network/networks.h"
#include "tests/expect.h"
#include "tests/files.h"

namespace slipbench::network {
namespace {

FrameSource papillarray(double rate = 1000.0) {
  return {.sensor = "pad",
          .type = "papillarray",
          .rate = rate,
          .channels = {{.name = "force", .unit = "N", .shape = {9, 3}, .channel_names = {}}}};
}

Parameters parameters(const std::string& model, double threshold = 0.0, double latency = 0.0) {
  Parameters values = defaults_of(network_detector().about.parameters);
  values.set("model", model);
  values.set("threshold", threshold);
  values.set("latency", latency);
  return values;
}

// The force of pillar 0 in sample n; the other pillars, which no network here reads, have other
// values.
std::vector<float> sample(int n) {
  std::vector<float> values(27, 99.0F);
  values[0] = 0.125F * static_cast<float>(n % 7);
  values[1] = -0.25F * static_cast<float>(n % 5);
  values[2] = 1.0F;
  return values;
}

double probability(double hold, double slip) { return std::exp(slip) / (std::exp(hold) + std::exp(slip)); }

// ctest runs each test in a separate process; run by hand this test comes first.
TEST(NetworkDetector, LoadsItsLibraryWithTheFirstNetwork) {
  ASSERT_FALSE(openvino_is_loaded());
  EXPECT_THROW(network_detector().create(parameters("none"), papillarray()), SceneValueError);
  EXPECT_FALSE(openvino_is_loaded());
  network_detector().create(parameters(shipped("mlp13.onnx")), papillarray());
  EXPECT_TRUE(openvino_is_loaded());
}

TEST(NetworkDetector, SaysWhatItsNetworkSaysOfTheLastFrames) {
  const auto detector = network_detector().create(parameters(shipped("mlp13.onnx")), papillarray());
  ASSERT_EQ(detector->features().size(), 1u);
  EXPECT_EQ(detector->features()[0].name, "slip_probability");
  // A frame of one sample, every 5 samples, scaled as (x - 0.5) 2; the input is the last two
  // frames.
  std::deque<float> fed;
  int changes = 0;
  double last = 0.0;
  for (int n = 0; n < 60; ++n) {
    const std::vector<float> values = sample(n);
    const SlipEstimate& said = detector->update({.time = 1e-3 * n, .values = values});
    if (n % 5 == 0) {
      for (std::size_t i = 0; i < 3; ++i) fed.push_back((values[i] - 0.5F) * 2.0F);
      while (fed.size() > 6) fed.pop_front();
    }
    if (n < 5) {
      EXPECT_EQ(said.state, PadState::no_contact);
      EXPECT_TRUE(std::isnan(said.features.at(0)));
      continue;
    }
    std::array<float, 6> input{};
    std::ranges::copy(fed, input.begin());
    const std::array<double, 2> logits = mlp(input);
    const double p = probability(logits[0], logits[1]);
    EXPECT_NEAR(said.features.at(0), p, 1e-5);
    EXPECT_EQ(said.state, p >= 0.5 ? PadState::gross : PadState::non_slip);
    EXPECT_EQ(said.time, 1e-3 * (n - n % 5));  // of the frame, not of the sample
    changes += p != last ? 1 : 0;
    last = p;
  }
  EXPECT_GT(changes, 5);
}

// mlp13.onnx reads one sample in five of 1 kHz. The same samples at 200 Hz, and every second one of
// 400 Hz, give the same bits.
TEST(NetworkDetector, ReadsItsSamplesAtAnyMultipleOfTheRateThatItReads) {
  const auto own = network_detector().create(parameters(shipped("mlp13.onnx")), papillarray());
  const auto slow = network_detector().create(parameters(shipped("mlp13.onnx")), papillarray(200.0));
  const auto fast = network_detector().create(parameters(shipped("mlp13.onnx")), papillarray(400.0));
  EXPECT_EQ(own->notice(), "");
  EXPECT_EQ(slow->notice(), "");
  EXPECT_EQ(fast->notice(), "resampled from 400 Hz to 200 Hz for mlp13.onnx");
  for (int n = 0; n < 100; ++n) {
    const std::vector<float> read = sample(n), other(27, 7.0F);
    SlipEstimate said;
    for (int k = 0; k < 5; ++k) said = own->update({.time = 5e-3 * n + 1e-3 * k, .values = k == 0 ? read : other});
    const SlipEstimate& at_200 = slow->update({.time = 5e-3 * n, .values = read});
    SlipEstimate at_400 = fast->update({.time = 5e-3 * n, .values = read});
    EXPECT_EQ(at_400.time, n < 1 ? -std::numeric_limits<double>::infinity() : 5e-3 * n);
    at_400 = fast->update({.time = 5e-3 * n + 2.5e-3, .values = other});
    for (const SlipEstimate& one : {at_200, at_400}) {
      ASSERT_EQ(one.state, said.state) << n;
      ASSERT_EQ(one.time, said.time) << n;
      if (n > 0) {
        ASSERT_EQ(one.features, said.features) << n;
      }
    }
  }
}

TEST(NetworkDetector, CarriesItsStateAndBeginsATrialWithoutOne) {
  for (int trial = 0; trial < 2; ++trial) {
    const auto detector = network_detector().create(parameters(shipped("gru21.onnx")), papillarray());
    Gru gru;
    for (int n = 0; n < 40; ++n) {
      const std::vector<float> values = sample(n);
      const double p = gru.step(std::span(values).first<3>())[1];
      const SlipEstimate& said = detector->update({.time = 1e-3 * n, .values = values});
      ASSERT_NEAR(said.features.at(0), p, 1e-5);
      ASSERT_EQ(said.state, p >= 0.6 ? PadState::gross : PadState::non_slip);
    }
  }
}

TEST(NetworkDetector, TheScenesThresholdAndLatencyCount) {
  const std::vector<float> values = sample(3);
  const double p = Gru().step(std::span(values).first<3>())[1];
  for (const double threshold : {p - 0.01, p + 0.01}) {
    const auto detector = network_detector().create(parameters(shipped("gru21.onnx"), threshold, 0.004), papillarray());
    const SlipEstimate& said = detector->update({.time = 0.0, .values = values});
    EXPECT_EQ(said.state, threshold < p ? PadState::gross : PadState::non_slip);
    EXPECT_EQ(said.latency, 0.004);
  }
}

std::string refusal(const Parameters& values, const FrameSource& source) {
  return scene_refusal_of([&] { network_detector().create(values, source); });
}

// A network exported with the number of frames left open, whose description asks for another
// number.
TEST(NetworkDetector, SaysThatAnOpenExtentIsOne) {
  std::string bytes = bytes_of(shipped("mlp13.onnx"));
  const std::string two = "\"history\": 2";
  bytes.replace(bytes.find(two), two.size(), "\"history\": 4");
  const std::string path = testing::TempDir() + "network-" + std::to_string(::getpid()) + "-open.onnx";
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_THAT(refusal(parameters(path), papillarray()), mentions({"6 values", "4 frames", "3"}));
  std::filesystem::remove(path);
}

// mlp13.onnx, which takes two frames of the three values of one pillar, with a description that
// reads all pillars.
TEST(NetworkDetector, SaysThatTheSensorHasOtherUnits) {
  std::string bytes = bytes_of(shipped("mlp13.onnx"));
  const std::string values = ", \"values\": [0, 1, 2]";
  bytes.replace(bytes.find(values), values.size(), std::string(values.size(), ' '));
  const std::string path = testing::TempDir() + "network-" + std::to_string(::getpid()) + "-units.onnx";
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_THAT(refusal(parameters(path), papillarray()), mentions({"expects 1 unit of force", "sensor 'pad' has 9"}));
  FrameSource flat = papillarray();
  flat.channels.front().shape = {19};
  EXPECT_THAT(refusal(parameters(path), flat), mentions({"expects 3 values of force", "sensor 'pad' has 19"}));
  std::filesystem::remove(path);
}

// 3e38 times the weights exceeds a float32.
TEST(NetworkDetector, NamesTheSceneWhereItsNetworkFails) {
  const auto detector = network_detector().create(parameters(shipped("mlp13.onnx")), papillarray());
  const std::vector<float> values(27, 3e38F);
  EXPECT_THAT(scene_refusal_of([&] {
                for (int n = 0; n < 10; ++n) detector->update({.time = 1e-3 * n, .values = values});
              }),
              mentions({"detector.model", "mlp13.onnx", "finite"}));
}

TEST(NetworkDetector, SaysAtTheModelWhatIsWrong) {
  EXPECT_THAT(refusal(parameters("none"), papillarray()), mentions({"detector.model", "no network"}));
  EXPECT_THAT(refusal(parameters("/nowhere.onnx"), papillarray()), mentions({"detector.model", "/nowhere.onnx", "opened"}));
  EXPECT_THAT(refusal(parameters(shipped("mlp13.onnx")), papillarray(150.0)),
              mentions({"mlp13.onnx", "150 Hz", "200 Hz", "1.33 times"}));
  FrameSource other = papillarray();
  other.type = "biotac_sp";
  EXPECT_THAT(refusal(parameters(shipped("mlp13.onnx")), other), mentions({"mlp13.onnx", "papillarray", "biotac_sp"}));
}

// The table of scenes/learn names each shipped file with the rate that it reads.
TEST(ShippedNetworks, ReadAtTheRateOfTheirTable) {
  const std::filesystem::path folder = SLIPBENCH_SOURCE_DIR "/scenes/learn";
  std::istringstream table(bytes_of((folder / "README.md").string()));
  std::size_t files = 0;
  for (std::string line; std::getline(table, line);) {
    if (!line.starts_with("| ") || line.find(".onnx` |") == std::string::npos) continue;
    for (const char* kind : {"_slip.onnx", "_grasp.onnx"}) {
      const std::size_t end = line.find(kind);
      if (end == std::string::npos) continue;  // "no file"
      const std::size_t first = line.rfind('`', end) + 1;
      const std::string name = line.substr(first, end - first) + kind;
      const Input input = load_engine((folder / name).string())->description().input;
      EXPECT_THAT(line, HasSubstr(" | " + readable_quantity(rate_read(input), Quantity::frequency) + " | ")) << name;
      ++files;
    }
  }
  EXPECT_EQ(files, 14U);
}

}  // namespace
}  // namespace slipbench::network

#include "detectors/detector_kinds.h"

#include <cstdlib>
#include <filesystem>
#include <random>

#include <unistd.h>

#include "tests/detectors/frames.h"

namespace slipbench {
namespace {

std::string file(const std::string& name) { return SLIPBENCH_TEST_PLUGINS "/" + name + ".so"; }

// A pad of 1 kHz and a skin with one value.
FrameSource two_sensors() {
  FrameSource source = vector_source({"force", "displacement"}, 9, 1000.0);
  source.sensors = {{"skin", "piezo_skin", 4000.0, {{"signal", "counts", {1}, {}}}},
                    {"pad", "papillarray", 1000.0, source.channels}};
  return source;
}

std::unique_ptr<Detector> load(const std::string& path, const ParameterMap& parameters = {}) {
  Parameters given;
  given.set("library", path);
  given.set("parameters", parameters);
  return plugin_detector().create(given, two_sensors());
}

// Returns "accepted" for a trial of four samples, or the error.
std::string outcome(const std::string& path, const ParameterMap& parameters = {}) {
  const std::vector<float> zeros(54);
  return refusal_of([&] {
    const auto detector = load(path, parameters);
    for (int i = 0; i < 4; ++i) static_cast<void>(detector->update({.time = 1e-3 * i, .values = zeros}));
    detector->finish();
  });
}

// Copies wrong.so to a new file, because the loader does not load a known name again.
class FreshLibrary {
 public:
  explicit FreshLibrary(const std::string& wrong) {
    static int count = 0;
    path_ = testing::TempDir() + "wrong_" + std::to_string(::getpid()) + "_" + std::to_string(count++) + ".so";
    std::filesystem::copy_file(file("wrong"), path_, std::filesystem::copy_options::overwrite_existing);
    ::setenv("SLIPBENCH_WRONG", wrong.c_str(), 1);
  }
  ~FreshLibrary() {
    ::unsetenv("SLIPBENCH_WRONG");
    std::filesystem::remove(path_);
  }
  FreshLibrary(const FreshLibrary&) = delete;
  FreshLibrary& operator=(const FreshLibrary&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The error for a library with the fault `wrong`, without the library's name.
std::string outcome_of(const std::string& wrong, const ParameterMap& parameters = {}) {
  const FreshLibrary library(wrong);
  std::string message = outcome(library.path(), parameters);
  const std::string name = "'" + library.path() + "'";
  const std::size_t at = message.find(name);
  return at == std::string::npos ? message : message.replace(at, name.size(), "IT");
}

TEST(PluginDetector, RunsTheExample) {
  const auto detector = load(file("ratio_gate"), {{"threshold", "0.5"}, {"rate", "500 Hz"}});
  std::vector<float> values(54);
  const auto state_at = [&](double time, double ratio) {
    for (std::size_t i = 0; i < 9; ++i) {
      values[3 * i] = static_cast<float>(0.6 * ratio);
      values[3 * i + 1] = static_cast<float>(0.8 * ratio);  // with x, a vector of length `ratio`
      values[3 * i + 2] = 1.0F;
    }
    return detector->update({.time = time, .values = values}).state;
  };
  EXPECT_EQ(detector->update({.time = 0.0, .values = values}).state, PadState::no_contact);
  EXPECT_EQ(state_at(1e-3, 0.6), PadState::no_contact) << "between two updates";
  EXPECT_EQ(state_at(2e-3, 0.39), PadState::non_slip) << "below 0.8 of 0.5";
  EXPECT_EQ(state_at(3e-3, 0.6), PadState::non_slip);
  EXPECT_EQ(state_at(4e-3, 0.41), PadState::incipient);
  static_cast<void>(state_at(5e-3, 0.0));
  EXPECT_EQ(state_at(6e-3, 0.51), PadState::gross);
  EXPECT_EQ(detector->update({.time = 7e-3, .values = values}).time, 6e-3);
  detector->finish();
}

// Its threshold on the normal force is in N.
TEST(PluginDetector, TheExampleRefusesForcesInAnotherUnit) {
  FrameSource source = two_sensors();
  for (Channel& channel : source.sensors[1].channels) channel.unit = "counts";
  Parameters given;
  given.set("library", file("ratio_gate"));
  given.set("parameters", ParameterMap{});
  EXPECT_THAT(refusal_of([&] { static_cast<void>(plugin_detector().create(given, source)); }),
              mentions({"force in N", "counts"}));
}

// A skin of 4 kHz and a pad of 1 kHz, with an update at every second sample of the pad: eight
// samples of the skin and two of the pad.
TEST(PluginDetector, HearsEverySampleOfEverySensor) {
  const auto detector = load(file("ears"), {{"sensor", "skin"}, {"threshold", "7.5"}, {"rate", "0.5 kHz"}});
  const std::vector<float> zeros(54);
  SlipEstimate said = detector->update({.time = 0.0, .values = zeros});
  EXPECT_EQ(said.state, PadState::incipient) << "nothing heard yet";
  EXPECT_EQ(said.latency, 1e-3);
  for (int sample = 1; sample <= 2; ++sample) {
    for (int i = 0; i < 4; ++i) {
      const auto value = static_cast<float>(4 * (sample - 1) + i + 1);  // 1 to 8
      detector->listener()->hear(0, {.time = 1e-3 * (sample - 1) + 2.5e-4 * (i + 1), .values = {&value, 1}});
    }
    said = detector->update({.time = 1e-3 * sample, .values = zeros});
  }
  EXPECT_EQ(said.time, 2e-3);
  EXPECT_EQ(said.state, PadState::gross) << "8 is over 7.5";
  EXPECT_DOUBLE_EQ(said.stuck_fraction, 0.8);
  EXPECT_DOUBLE_EQ(said.latency, 2e-3);
  static_cast<void>(detector->update({.time = 3e-3, .values = zeros}));
  said = detector->update({.time = 4e-3, .values = zeros});
  EXPECT_EQ(said.state, PadState::gross) << "the newest is still 8";
  EXPECT_EQ(said.stuck_fraction, 0.0) << "and no longer new";
}

TEST(PluginDetector, RefusesWhatIsNoDetector) {
  EXPECT_THAT(outcome("none"), refused_at("detector.library", {"path"}));
  EXPECT_THAT(outcome(file("absent")), refused_at("detector.library", {file("absent")}));
  EXPECT_THAT(outcome(file("other_part")),
              refused_at("detector.library", {file("other_part"), "slipbench_detector_abi", "detectors/plugin_abi.h"}));
  EXPECT_THAT(outcome(file("ears"), {{"sensor", "nose"}}),
              refused_at("detector.library", {file("ears"), "no sensor of this name has one value"}));
}

TEST(PluginDetector, RefusesAnotherBuild) {
  EXPECT_EQ(outcome_of(""), "accepted");
  EXPECT_THAT(outcome_of("version=7"), refused_at("detector.library", {"IT", "version 7", "1"}));
  // Sizes on a 64-bit machine: pointers, doubles and size_t of 8 bytes.
  const std::array<std::pair<std::string, std::string>, 8> sizes{{{"slipbench_parameter", "40"},
                                                                  {"slipbench_channel", "48"},
                                                                  {"slipbench_sensor", "48"},
                                                                  {"slipbench_source", "40"},
                                                                  {"slipbench_samples", "40"},
                                                                  {"slipbench_detector", "288"},
                                                                  {"slipbench_detector_input", "24"},
                                                                  {"slipbench_estimate", "24"}}};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto& [type, bytes] = sizes[i];
    EXPECT_THAT(outcome_of("size" + std::to_string(i) + "=1"), refused_at("detector.library", {"IT", type, "1 byte;", bytes}));
  }
}

TEST(PluginDetector, RefusesARateThatDoesNotDivideTheSensors) {
  for (const std::string rate : {"nan", "inf", "-inf", "0", "-100", "300", "2000", "1e-300", "1e300"}) {
    EXPECT_THAT(outcome_of("rate=" + rate), refused_at("detector.library", {"IT", "Hz", "1 kHz", "sensors.pad"})) << rate;
  }
  EXPECT_EQ(outcome_of("rate=250"), "accepted");
}

TEST(PluginDetector, RefusesWhatIsNoEstimate) {
  for (const std::string state : {"-1", "4", "1000000"}) {
    EXPECT_THAT(outcome_of("state=" + state), refused_at("detector.library", {"IT", "update", state, "3"}));
  }
  for (const std::string latency : {"nan", "inf", "-1"}) {
    EXPECT_THAT(outcome_of("latency=" + latency), refused_at("detector.library", {"IT", "latency", latency, "0 s"}));
  }
  for (const std::string stuck : {"inf", "-0.5", "1.5"}) {
    EXPECT_THAT(outcome_of("stuck=" + stuck), refused_at("detector.library", {"IT", "stuck_fraction", stuck, "1"}));
  }
  EXPECT_EQ(outcome_of("stuck=nan"), "accepted");
}

TEST(PluginDetector, RefusesAFaultyDeclarationOfParameters) {
  const std::string where = "slipbench_detector_parameters";
  EXPECT_THAT(outcome_of("rows=2"), refused_at("detector.library", {where, "no name"}));
  EXPECT_THAT(outcome_of("rows=4"), refused_at("detector.library", {where, "threshold", "1000000", "SLIPBENCH_NUMBER"}));
  EXPECT_THAT(outcome_of("rows=5"), refused_at("detector.library", {where, "threshold", "nan", "finite"}));
  EXPECT_THAT(outcome_of("rows=6"), refused_at("detector.library", {where, "threshold", "bananas"}));
  EXPECT_THAT(outcome_of("rows=7"), refused_at("detector.library", {where, "threshold", "mN"}));
  EXPECT_THAT(outcome_of("rows=9"), refused_at("detector.library", {where, "threshold", "twice"}));
  EXPECT_THAT(outcome_of("rows=10"), refused_at("detector.library", {where, "1000", "SLIPBENCH_NO_MORE"}));
  EXPECT_EQ(outcome_of("", {{"threshold", "300 mN"}}), "accepted");
  EXPECT_THAT(outcome_of("", {{"treshold", "1"}}), refused_at("detector.parameters.treshold", {"IT", "treshold", "threshold"}));
}

TEST(PluginDetector, ThatThrowsIsNamedWithItsFunction) {
  const std::array<std::string, 3> functions{"slipbench_make_detector", "update", "destroy"};
  for (std::size_t in = 0; in < functions.size(); ++in) {
    EXPECT_THAT(outcome_of("crash=7,in=" + std::to_string(in + 2)),
                refused_at("detector.library", {"IT", "out of ideas", functions[in]}));
  }
}

// The loader would return the library that it knows by that name.
TEST(PluginDetector, ThatIsBuiltAnewNeedsAnotherStart) {
  const std::string path = testing::TempDir() + "rebuilt_" + std::to_string(::getpid()) + ".so";
  std::filesystem::copy_file(file("ratio_gate"), path, std::filesystem::copy_options::overwrite_existing);
  const std::string first = outcome(path);
  std::filesystem::remove(path);
  std::filesystem::copy_file(file("ears"), path);
  EXPECT_THAT(first, Not(mentions({"changed"})));
  EXPECT_THAT(outcome(path), mentions({"changed", "restart the program"}));
  std::filesystem::remove(path);
}

// Five hundred libraries whose structures hold arbitrary numbers: each is accepted, or refused with
// an error that names it.
TEST(PluginDetector, SurvivesFiveHundredWrongLibraries) {
  std::mt19937 random(18);
  const auto pick = [&](const std::vector<std::string>& values) { return values[random() % values.size()]; };
  const std::vector<std::string> numbers{"0",     "1",          "2",   "3",    "-1",    "4",     "24",
                                         "40",    "1e-300",     "7.5", "1000", "-1000", "1e300", "4294967295",
                                         "65536", "2147483647", "nan", "inf",  "-inf"};
  const std::vector<std::string> counts{"0", "1", "2", "3", "4", "24", "40", "288", "4294967295", "65536"};
  int refused = 0;
  for (int i = 0; i < 500; ++i) {
    std::string wrong;
    const auto add = [&](const std::string& key, const std::string& value) {
      wrong += (wrong.empty() ? "" : ",") + key + "=" + value;
    };
    for (auto faults = 1 + random() % 3; faults > 0; --faults) {
      switch (random() % 8) {
        case 0: add("version", pick(counts)); break;
        case 1: add("size" + std::to_string(random() % 8), pick(counts)); break;
        case 2: add("rows", pick({"0", "2", "3", "4", "5", "6", "7", "9", "10"})); break;
        case 3: add("rate", pick(numbers)); break;
        case 4: add("state", pick({"-2147483648", "-1", "0", "1", "2", "3", "4", "2147483647"})); break;
        case 5: add("latency", pick(numbers)); break;
        case 6: add("stuck", pick(numbers)); break;
        default:
          add("make", std::to_string(random() % 3));
          add("crash", pick({"0", "7"}));
          add("in", std::to_string(2 + random() % 3));
      }
    }
    const std::string said = outcome_of(wrong);
    if (said != "accepted") ++refused;
    EXPECT_THAT(said, AnyOf("accepted", StartsWith("detector.library: IT "))) << wrong;
  }
  EXPECT_GT(refused, 250) << "most of them would have been right: this would test little";
}

}  // namespace
}  // namespace slipbench

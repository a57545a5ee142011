#include "detectors/detector_kinds.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "detectors/hd/hd_detector.h"
#include "rtl/verilated/rtl_engine.h"
#include "tests/detectors/frames.h"
#include "tests/detectors/hd/published.h"
#include "tests/expect.h"

namespace slipbench::hd {
namespace {

const FrameSource papillarray = vector_source({"force", "displacement"}, pillar_count, 1000.0);

Parameters published_parameters() {
  Parameters parameters = defaults_of(gst_hd_rtl_detector().about.parameters);
  parameters.set("memories", published_folder);
  return parameters;
}

// A pad pressed deeper and deeper and dragged to and fro: every class and every context occurs.
std::array<float, 6 * pillar_count> frame_at(std::size_t i) {
  std::array<float, 6 * pillar_count> values{};
  const double t = 1e-3 * static_cast<double>(i);
  for (std::size_t pillar = 0; pillar < pillar_count; ++pillar) {
    float* const displacement = values.data() + 3 * (pillar_count + pillar);
    displacement[0] = static_cast<float>(1e-3 * std::sin(9.0 * t + 0.1 * static_cast<double>(pillar)));
    displacement[2] = static_cast<float>(0.5e-3 * t);
  }
  return values;
}

class RtlDetector : public testing::TestWithParam<const char*> {};

TEST_P(RtlDetector, SaysWhatTheSoftwareSaysAfterTheCoresCycles) {
  const Parameters software = [] {
    Parameters parameters = defaults_of(gst_hd_detector().about.parameters);
    parameters.set("memories", published_folder);
    return parameters;
  }();
  Parameters hardware = published_parameters();
  hardware.set("unrolling", std::string(GetParam()));
  hardware.set("clock", 1e6);
  hardware.set("lockstep", true);
  const std::string name = GetParam();
  const unsigned cycles = core_latency(name == "fastest"  ? Unrolling::fastest
                                       : name == "middle" ? Unrolling::middle
                                                          : Unrolling::smallest);
  const auto expected = gst_hd_detector().create(software, papillarray);
  const auto actual = gst_hd_rtl_detector().create(hardware, papillarray);
  std::array<std::size_t, 4> seen{};
  for (std::size_t i = 0; i < 4000; ++i) {
    const auto values = frame_at(i);
    const SensorFrame frame{1e-3 * static_cast<double>(i), values};
    const SlipEstimate& estimate = actual->update(frame);
    ASSERT_EQ(estimate.state, expected->update(frame).state) << "frame " << i;
    ASSERT_DOUBLE_EQ(estimate.latency, 1e-6 * cycles);
    ++seen[static_cast<std::size_t>(estimate.state)];
  }
  for (const std::size_t count : seen) EXPECT_GT(count, 0U) << "the frames do not reach every class";
}

INSTANTIATE_TEST_SUITE_P(Unrollings, RtlDetector, testing::Values("fastest", "middle", "smallest"),
                         [](const auto& info) { return info.param; });

// The memory trained on scenes/learn, whose model.txt has an operating point.
TEST(RtlDetector, SaysWhatTheSoftwareSaysByItsAlarm) {
  Parameters software = defaults_of(gst_hd_detector().about.parameters), hardware = published_parameters();
  for (Parameters* parameters : {&software, &hardware}) parameters->set("memories", std::string("learn_gst_hd"));
  const auto expected = gst_hd_detector().create(software, papillarray);
  const auto actual = gst_hd_rtl_detector().create(hardware, papillarray);
  std::size_t slipping = 0;
  for (std::size_t i = 0; i < 4000; ++i) {
    const auto values = frame_at(i);
    const SensorFrame frame{1e-3 * static_cast<double>(i), values};
    const PadState state = actual->update(frame).state;
    ASSERT_EQ(state, expected->update(frame).state) << "frame " << i;
    slipping += slips(state) ? 1U : 0U;
  }
  EXPECT_GT(slipping, 0U);
  EXPECT_LT(slipping, 4000U);
}

TEST(RtlDetector, LatencyCanBeLeftOut) {
  Parameters parameters = published_parameters();
  parameters.set("latency", std::string("zero"));
  const auto values = frame_at(0);
  EXPECT_EQ(gst_hd_rtl_detector().create(parameters, papillarray)->update({0.0, values}).latency, 0.0);
}

TEST(RtlDetector, RefusesWhatTheCoreIsNotBuiltFor) {
  Parameters parameters = published_parameters();
  parameters.set("quantiser", std::string("exact"));
  EXPECT_THAT(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().create(parameters, papillarray); }),
              mentions({"detector.quantiser", "exact", "fixed_point"}));
  parameters = published_parameters();
  parameters.set("compat", std::string("published_core"));
  EXPECT_THAT(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().create(parameters, papillarray); }),
              HasSubstr("detector: "));
}

// At 100 Hz the frames at 0.20, 0.21, ... 0.30 s: eleven.
TEST(RtlDetector, WritesTheWaveformOfItsTrialAlone) {
  const std::string file = (std::filesystem::path(testing::TempDir()) / "rtl_detector.fst").string();
  std::filesystem::remove(file);
  Parameters parameters = published_parameters();
  parameters.set("waveform", file);
  parameters.set("waveform_from", 0.2);
  parameters.set("waveform_to", 0.3);
  const auto run = [&](std::uint64_t trial, std::size_t frames) {
    FrameSource source = papillarray;
    source.trial = trial;
    const auto detector = gst_hd_rtl_detector().create(parameters, source);
    for (std::size_t i = 0; i < frames; ++i) {
      const auto values = frame_at(i);
      detector->update({1e-3 * static_cast<double>(i), values});
    }
  };
  run(1, 400);
  EXPECT_FALSE(std::filesystem::exists(file)) << "another trial";
  run(0, 200);
  EXPECT_FALSE(std::filesystem::exists(file)) << "begun before the frame at 0.2 s";
  run(0, 201);
  EXPECT_TRUE(std::filesystem::exists(file));
  run(0, 310);
  const auto size = std::filesystem::file_size(file);
  EXPECT_GT(size, 0U);
  run(0, 4000);  // replaces its own file
  EXPECT_EQ(std::filesystem::file_size(file), size) << "goes on after 0.3 s";

  parameters.set("waveform_to", 0.199);
  EXPECT_THAT(refusal_of<SceneValueError>([&] { run(0, 1); }), mentions({"detector.waveform_to", "199 ms"}));
  parameters.set("waveform_to", 0.3);
  parameters.set("waveform", std::string("nowhere/core.fst"));
  EXPECT_THAT(refusal_of<SceneValueError>([&] { run(1, 1); }), mentions({"detector.waveform", "nowhere"}));
  parameters.set("waveform", file);
  std::ofstream(file) << "notes";
  EXPECT_THAT(refusal_of<SceneValueError>([&] { run(0, 1); }), mentions({"rtl_detector.fst", "waveform"}));
}

// The trial of 0.4 s has frames at 0.00, 0.01, ... 0.39 s: a waveform can begin with the last one,
// but not later.
TEST(RtlDetector, RefusesAWaveformBehindTheTrialsEnd) {
  Parameters parameters = published_parameters();
  parameters.set("waveform", (std::filesystem::path(testing::TempDir()) / "rtl_behind.fst").string());
  FrameSource source = papillarray;
  source.duration = 0.4;
  parameters.set("waveform_from", 0.39);
  EXPECT_EQ(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().create(parameters, source); }), "accepted");
  parameters.set("waveform_from", 0.391);
  EXPECT_THAT(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().create(parameters, source); }),
              mentions({"detector.waveform_from", "391 ms", "0.4 s"}));
  source.trial = 1;
  EXPECT_EQ(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().create(parameters, source); }), "accepted")
      << "another trial";
}

TEST(RtlDetector, RefusesAWaveformOfATrialThatIsNotRun) {
  Parameters parameters = published_parameters();
  parameters.set("waveform_trial", std::int64_t{3});
  EXPECT_EQ(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().check_run(parameters, 3); }), "accepted")
      << "there is no waveform";
  parameters.set("waveform", std::string("core.fst"));
  EXPECT_EQ(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().check_run(parameters, 4); }), "accepted");
  EXPECT_THAT(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().check_run(parameters, 3); }),
              mentions({"detector.waveform_trial", "3", "0", "2"}));
}

// At 100 Hz: 20 cycles per sample need 2 kHz, 4 need 400 Hz, 1 needs 100 Hz.
TEST(RtlDetector, RefusesAClockThatDoesNotKeepUp) {
  for (const auto& [unrolling, clock, least] :
       {std::tuple("smallest", 2000.0, "2 kHz"), std::tuple("middle", 400.0, "400 Hz"), std::tuple("fastest", 100.0, "100 Hz")}) {
    Parameters parameters = published_parameters();
    parameters.set("unrolling", std::string(unrolling));
    parameters.set("clock", clock);
    EXPECT_EQ(refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().create(parameters, papillarray); }), "accepted");
    parameters.set("clock", 0.99 * clock);
    const std::string message = refusal_of<SceneValueError>([&] { gst_hd_rtl_detector().create(parameters, papillarray); });
    EXPECT_THAT(message, mentions({"detector.clock", least}));
  }
}

}  // namespace
}  // namespace slipbench::hd

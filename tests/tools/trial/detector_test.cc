// Detectors in whole trials.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <span>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/scenes.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/reader.h"
#include "tools/files/output_file.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/warnings.h"

namespace slipbench::testing {
namespace {

using Json = nlohmann::json;

const std::string published = SLIPBENCH_SOURCE_DIR "/tests/detectors/hd/data/published";

Scene ratio_scene(const std::string& ratio) {
  return stage_scene({{"motion.acceleration", "1 m/s2"}, {"detector", "{type: force_ratio, ratio: " + ratio + "}"}});
}

// When a corner pillar, the least pressed, reaches f_t = ratio f_n: k_t v (t - 2 s - v / (2 a)) =
// ratio k_n (1 mm - height).
double time_of_ratio(const LabelRecord& labels, double ratio) {
  constexpr std::size_t corner = 0;
  const double f_n = labels.k_normal[corner] * (1e-3 - labels.unit_heights[corner]);
  return 2.0 + ratio * f_n / (labels.k_tangential[corner] * 4e-3) + 4e-3 / (2.0 * 1.0);
}

// The first tick of 1 ms at or after `time`.
double tick_after(double time) { return std::ceil(1e3 * time) * 1e-3; }

std::size_t sum(std::span<const std::size_t> counts) { return std::accumulate(counts.begin(), counts.end(), std::size_t{0}); }

// The detector warns before the slip and still does when slip begins: no delay follows from that.
TEST(DetectorInTrial, WarnsWhenTheRatioIsPassed) {
  const TrialRecord record = run_trial(ratio_scene("0.3"), 0, Recording::full).record;
  const LabelRecord& labels = record.sensors[0].labels;
  EXPECT_NEAR(record.outcome.false_alarm_time, tick_after(time_of_ratio(labels, 0.3)), 1e-9);
  // When slip begins it is detected at the next tick.
  EXPECT_NEAR(record.outcome.detection_time, tick_after(record.outcome.first_slip_time), 1e-9);
  EXPECT_EQ(record.outcome.judged_slip_time, record.outcome.first_slip_time);
  EXPECT_EQ(record.outcome.detection, Detection::early);
  EXPECT_TRUE(std::isnan(record.outcome.detection_delay));

  ASSERT_TRUE(record.control.has_value());
  const ControlRecord& control = *record.control;
  EXPECT_EQ(control.detector, "force_ratio");
  EXPECT_EQ(control.sensor, "pad");
  EXPECT_EQ(control.rate, 1000.0);
  EXPECT_EQ(control.time, record.sensors[0].time);
  ASSERT_EQ(control.detector_class.size(), 4000U);
  for (std::size_t row = 1000; row < 2000; ++row) EXPECT_EQ(control.detector_class[row], 1) << "pressed, and at rest";
  EXPECT_EQ(control.detector_class.front(), 0);
  EXPECT_EQ(control.detector_class.back(), 3);
  // Rows of the confusion are the labels' own counts.
  for (std::size_t truth = 0; truth < 4; ++truth) EXPECT_EQ(sum(control.confusion[truth]), labels.state_count[truth]);
}

// A share of 2 % of 1800 samples at rest is flipped to slip, some of them single: the first one
// decides, although the oracle detects the slip at once.
TEST(DetectorInTrial, ThatWithdrewItsAlarmIsEarlyToo) {
  const TrialRecord record = run_trial(stage_scene({{"detector", "{type: truth, flip: 0.02}"}}), 0, Recording::full).record;
  const ControlRecord& control = *record.control;
  std::size_t first = 0;
  while (control.detector_class[first] < 2) ++first;
  EXPECT_EQ(record.outcome.false_alarm_time, control.time[first]);
  EXPECT_LT(control.time[first], 2.0) << "the stage rests until 2 s";
  EXPECT_THAT(std::span(control.detector_class).subspan(first, 2000 - first), Contains(1)) << "withdrawn";
  EXPECT_FALSE(std::isnan(record.outcome.detection_time));
  EXPECT_EQ(record.outcome.detection, Detection::early);
  EXPECT_TRUE(std::isnan(record.outcome.detection_delay));
}

// The stage rests until 2 s.
TEST(DetectorInTrial, WithoutSlipIsQuietOrWrong) {
  const auto outcome = [](const std::string& detector) {
    return run_trial(stage_scene({{"duration", "1.9 s"}, {"detector", detector}}), 0, Recording::outcome).record.outcome;
  };
  EXPECT_EQ(outcome("{type: truth}").detection, Detection::quiet);
  EXPECT_EQ(outcome("{type: truth, flip: 0.02}").detection, Detection::false_alarm);
}

// A slipping pillar has f_t = mu_k f_n: a higher ratio never detects slip.
TEST(DetectorInTrial, ThatSeesNothingHasNoDetection) {
  const TrialRecord record = run_trial(ratio_scene("0.501"), 0, Recording::full).record;
  EXPECT_FALSE(std::isnan(record.outcome.first_slip_time));
  EXPECT_TRUE(std::isnan(record.outcome.false_alarm_time));
  EXPECT_TRUE(std::isnan(record.outcome.detection_time));
  EXPECT_TRUE(std::isnan(record.outcome.detection_delay));
  EXPECT_EQ(record.outcome.detection, Detection::missed);
  const Confusion& confusion = record.control->confusion;
  EXPECT_EQ(recall_of_slip(confusion), 0.0);
  EXPECT_LE(balanced_accuracy(confusion), 1.0 / 3.0) << "no more than a constant answer";
  EXPECT_EQ(confusion[2][1] + confusion[3][1], sum(confusion[2]) + sum(confusion[3]));
}

TEST(DetectorInTrial, OutcomeDoesNotDependOnTheRecording) {
  const Scene scene = ratio_scene("0.3");
  const TrialRecord full = run_trial(scene, 0, Recording::full).record;
  const TrialRecord brief = run_trial(scene, 0, Recording::outcome).record;
  EXPECT_EQ(outcome_json(full.outcome), outcome_json(brief.outcome));
  EXPECT_EQ(full.control->confusion, brief.control->confusion);
  EXPECT_TRUE(brief.control->detector_class.empty());
}

// The rest of the record is equal without a detector.
TEST(DetectorInTrial, ChangesNothingElse) {
  TrialRecord with = run_trial(ratio_scene("0.3"), 0, Recording::full).record;
  const TrialRecord without = run_trial(stage_scene({{"motion.acceleration", "1 m/s2"}}), 0, Recording::full).record;
  EXPECT_FALSE(without.control.has_value());
  EXPECT_TRUE(std::isnan(without.outcome.detection_time));
  EXPECT_FALSE(without.outcome.detection.has_value());
  EXPECT_NE(trial_digest(with), trial_digest(without));
  with.control.reset();
  with.outcome = without.outcome;
  EXPECT_EQ(hexadecimal(trial_digest(with)), hexadecimal(trial_digest(without)));
}

// Time (8 bytes) and class (1) for each of the 4000 samples.
TEST(DetectorInTrial, CountsInTheSizeOfTheRecord) {
  EXPECT_EQ(check_trial(ratio_scene("0.3"), 0) - check_trial(stage_scene({}), 0), 4000.0 * 9.0);
}

// Slip is reported when the rate over the window of 20 ms has fallen to half: in the first tick 10
// ms after it began.
TEST(DetectorInTrial, ThatGoesByRatesTellsASlipWhenItsLawSays) {
  const Scene scene = stage_scene({{"motion.acceleration", "1 m/s2"}, {"detector", "{type: shear_rate}"}});
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  EXPECT_NEAR(record.outcome.detection_time, tick_after(record.outcome.first_slip_time + 10e-3), 1e-9);
  EXPECT_TRUE(std::isnan(record.outcome.false_alarm_time));
  EXPECT_EQ(record.outcome.detection, Detection::seen);
  EXPECT_EQ(record.outcome.detection_delay, record.outcome.detection_time - record.outcome.first_slip_time);
  const std::vector<std::uint8_t>& classes = record.control->detector_class;
  const auto first = std::ranges::find(classes, 3) - classes.begin();
  ASSERT_LT(first, std::ssize(classes));
  EXPECT_NEAR(1e-3 * static_cast<double>(first), tick_after(record.outcome.gross_slip_time + 10e-3), 1e-9);
  EXPECT_EQ(std::count(classes.begin() + first, classes.end(), 3), std::ssize(classes) - first) << "and it stays";
}

TEST(DetectorInTrial, ReadsTheSensorThatTheSceneNames) {
  const Scene scene =
      stage_scene({{"sensors", "{slow: {type: papillarray, rate: 100 Hz}, fast: {type: papillarray, rate: 500 Hz}}"},
                   {"detector", "{type: force_ratio, sensor: slow}"}});
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  EXPECT_EQ(record.control->sensor, "slow");
  EXPECT_EQ(record.control->rate, 100.0);
  EXPECT_EQ(record.control->time.size(), 400U);
}

TEST(DetectorInTrial, WhatItRefusesHasThePathOfTheScene) {
  const auto path = [](const std::string& detector) {
    const std::string refusal = scene_refusal_of([&] {
      check_trial(stage_scene({{"sensors.pad.rate", "250 Hz"}, {"detector", detector}}), 0);
    });
    return refusal.substr(0, refusal.find(" | "));
  };
  EXPECT_EQ(path("{type: gst_hd, memories: " + published + "}"), "detector.rate");  // 100 Hz does not divide 250 Hz
  EXPECT_EQ(path("{type: gst_hd, rate: 125 Hz, memories: " + published + "}"), "accepted");
  EXPECT_EQ(path("{type: gst_hd, rate: 125 Hz, memories: nowhere}"), "detector.memories");
}

TEST(DetectorInTrial, RefusesAWaveformThatNobodyWouldSee) {
  const auto refusal = [](const std::string& about) -> std::string {
    return refusal_of([&] {
      check_trial(stage_scene({{"detector", "{type: gst_hd_rtl, waveform: core.fst, " + about + "}"}}), 0);
    });
  };
  EXPECT_EQ(refusal("waveform_from: 3.99 s"), "accepted");
  EXPECT_THAT(refusal("waveform_from: 4 s"), mentions({"frame", "4 s"}));
  EXPECT_THAT(refusal("waveform_from: 1e300 s"), mentions({"detector.waveform_from", "1e300 s", "86400 s"}));
  EXPECT_THAT(refusal("waveform_to: 1e300 s"), mentions({"detector.waveform_to", "1e300 s", "86400 s"}));
}

std::vector<std::uint8_t> classes_of(const std::string& detector) {
  const Scene scene =
      stage_scene({{"detector", "{" + detector + ", memories: " + published + "}"}, {"sensors.pad.electronics", "typical"}});
  return run_trial(scene, 0, Recording::full).record.control->detector_class;
}

// A minute with the shipped memories, slow enough for every class to occur.
TEST(DetectorInTrial, HardwareWithoutLatencyIsTheSoftwareTickForTick) {
  const auto classes = [](const std::string& detector) {
    const Scene scene = stage_scene(
        {{"detector", detector}, {"duration", "60 s"}, {"motion.speed", "0.1 mm/s"}, {"sensors.pad.electronics", "typical"}});
    return run_trial(scene, 0, Recording::full).record.control->detector_class;
  };
  const std::vector<std::uint8_t> software = classes("{type: gst_hd}");
  ASSERT_EQ(software.size(), 60'000U);
  for (const int state : {1, 2, 3}) EXPECT_THAT(software, Contains(state));
  EXPECT_TRUE(classes("{type: gst_hd_rtl, latency: zero}") == software);
}

// The core takes a fixed number of cycles for every frame: 10 in the fastest variant. At 100 MHz
// that is 0.1 us, so the loop sees a class one tick of 1 ms late; at 4 kHz 2.5 ms, three ticks.
TEST(DetectorInTrial, HardwareIsSeenAfterItsCycles) {
  const std::vector<std::uint8_t> at_once = classes_of("type: gst_hd");
  for (const auto& [clock, late] : {std::pair("100 MHz", std::ptrdiff_t{1}), std::pair("4 kHz", std::ptrdiff_t{3})}) {
    std::vector<std::uint8_t> expected(static_cast<std::size_t>(late), 0);
    expected.insert(expected.end(), at_once.begin(), at_once.end() - late);
    EXPECT_EQ(classes_of(std::string("type: gst_hd_rtl, clock: ") + clock), expected) << clock;
  }
}

struct DetectorSweep : FolderTest {
  SweepSummary run(const std::string& output, std::size_t jobs, const std::vector<Override>& overrides = {}) {
    std::ofstream(path("scene.yaml")) << R"(slipbench: 1
duration: 0.4 s
seed: 7
motion: {kind: stage, gap: 0 mm, approach_speed: 10 mm/s, start: 0.12 s, speed: 16 mm/s, acceleration: 1 m/s2}
sensors:
  pad: {type: papillarray, electronics: typical, bristles: 3}
detector: {type: gst_hd, compat: published_core, memories: )"
                                      << published << R"(}
sweep:
  motion.direction: {draw: uniform, min: 0 deg, max: 360 deg}
  trials: 6
)";
    SweepOptions options;
    options.scene_path = path("scene.yaml");
    options.output = path(output);
    options.jobs = jobs;
    options.overrides = overrides;
    return run_sweep(options, catalogues());
  }
};

TEST_F(DetectorSweep, ContentDoesNotDependOnTheJobs) {
  const SweepSummary one = run("one.h5", 1);
  const SweepSummary three = run("three.h5", 3);
  EXPECT_EQ(DatasetReader(path("one.h5")).content_sha256(), DatasetReader(path("three.h5")).content_sha256());
  ASSERT_EQ(one.trials.size(), three.trials.size());
  for (std::size_t k = 0; k < one.trials.size(); ++k)
    EXPECT_EQ(one.trials[k].detector->confusion, three.trials[k].detector->confusion);
}

TEST_F(DetectorSweep, RefusesAWaveformOfATrialThatIsNotRun) {
  const std::string detector = "{type: gst_hd_rtl, waveform: core.fst, waveform_trial: 6}";
  EXPECT_THAT(refusal_of([&] {
                run("out.h5", 1, {{"detector", detector}});
              }),
              mentions({"detector.waveform_trial", "6", "0", "5"}));
}

TEST_F(DetectorSweep, DatasetAndSummaryAgree) {
  const SweepSummary summary = run("out.h5", 2);
  const DatasetReader reader(path("out.h5"));
  for (const TrialSummary& trial : summary.trials) {
    const TrialRecord record = reader.read_trial(trial.trial);
    ASSERT_TRUE(record.control.has_value());
    EXPECT_EQ(record.control->confusion, trial.detector->confusion);
    EXPECT_EQ(outcome_json(record.outcome), outcome_json(trial.outcome));
    const Json json = Json::parse(trial_json(trial));
    const Json& said = json.at("detector");
    EXPECT_EQ(said.at("type"), "gst_hd");
    EXPECT_EQ(said.at("sensor"), "pad");
    EXPECT_EQ(said.at("confusion").get<Confusion>(), trial.detector->confusion);
    EXPECT_EQ(said.at("recall_of_slip"), recall_of_slip(trial.detector->confusion));
    EXPECT_EQ(said.at("balanced_accuracy"), balanced_accuracy(trial.detector->confusion));
    EXPECT_EQ(json.at("outcome").at("detection"), detection_word(trial.outcome.detection.value()));
    // 400 samples; the first 140 come before the window of 15 frames at 100 Hz is full.
    std::size_t silent = 0;
    for (const StateCounts& row : trial.detector->confusion) silent += row[0];
    EXPECT_EQ(silent, 140U);
  }
}

}  // namespace
}  // namespace slipbench::testing

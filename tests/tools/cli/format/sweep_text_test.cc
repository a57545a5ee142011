#include "tools/cli/format/sweep_text.h"

#include <cmath>
#include <limits>

#include "tests/expect.h"

namespace slipbench {
namespace {

using ::testing::ContainsRegex;

constexpr double never = std::numeric_limits<double>::quiet_NaN();

const std::vector<SensorAbout> sensors{{"twopad", 2.0, {"A", "B"}}};

// Two units over two samples: A slips at 1.25 s after a micro-slip at 1.2 s, B never touches.
TrialSummary small_trial() {
  SensorSummary sensor;
  sensor.name = "pad";
  // A slipping unit's margin has rounding.
  sensor.units = {{.touch_time = 0.25,
                   .micro_onset_time = 1.2,
                   .onset_time = 1.25,
                   .slip_distance = 0.00125F,
                   .load = 3.5F,
                   .margin = -1e-7F},
                  {}};
  sensor.state_count = {0, 1, 0, 1};
  sensor.state_micro_count = {0, 0, 1, 1};
  TrialSummary trial;
  trial.sensors = {sensor};
  trial.outcome.touch_time = 0.25;
  trial.outcome.first_micro_slip_time = 1.2;
  trial.outcome.first_slip_time = 1.25;
  trial.outcome.gross_slip_time = 1.25;
  return trial;
}

TEST(Summary, SharesAddUpToAHundredPercent) {
  EXPECT_EQ(shares_text({1, 0, 2, 1}), "no contact 25.0 %, non-slip 0.0 %, incipient 50.0 %, gross 25.0 %");
}

TEST(Summary, OnsetsAreShownToATenthOfAMillisecond) {
  EXPECT_EQ(onset_text(2.26756), "2.2676 s");
  EXPECT_EQ(onset_text(never), "-");
}

TEST(Summary, TrialShowsEveryUnit) {
  // By the columns: touch, first micro-slip, full slip, order, slipped, load and margin at the end.
  const std::string text = trial_text(small_trial(), sensors, Style(false));
  EXPECT_THAT(text, ContainsRegex(" A +0\\.2500 s +1\\.2000 s +1\\.2500 s +1 +1\\.25 mm +3\\.50 N +0\\.000\n"));
  EXPECT_THAT(text, ContainsRegex(" B +- +- +- +- +0\\.00 mm +0\\.00 N +-\n"));
  EXPECT_THAT(text, HasSubstr("gross slip at 1.2500 s, 50.0 ms after"));
}

// Up to 40 units have one row each. Of 41 units only the touching ones have a row, and the number
// of the others is stated.
TEST(Summary, OfManyUnitsThoseThatTouchAreShown) {
  for (const std::size_t units : {40U, 41U}) {
    TrialSummary trial = small_trial();
    SensorAbout about{"skin", 2.0, {}};
    trial.sensors[0].units.resize(units, trial.sensors[0].units[1]);
    for (std::size_t u = 0; u < units; ++u) about.unit_names.push_back("U" + std::to_string(u));
    const std::string text = trial_text(trial, {about}, Style(false));
    EXPECT_THAT(text, HasSubstr("\n  U0 "));
    EXPECT_EQ(text.find("\n  U39 ") == std::string::npos, units == 41U);
    EXPECT_EQ(text.find("\n  never in contact and not listed: 40 of 41 units\n") == std::string::npos, units == 40U);
    if (units == 40U) continue;
    // Without a touch there is no table at all.
    trial.sensors[0].units[0] = trial.sensors[0].units[1];
    EXPECT_THAT(trial_text(trial, {about}, Style(false)),
                HasSubstr("at 2 Hz\n  never in contact and not listed: 41 of 41 units\n"));
  }
}

// 20 samples in contact: recalls 3/4, 2/3 and 12/13; 2 + 1 + 12 of 16 slipping ones are detected.
DetectorSummary small_detector() { return {"ratio", "pad", {{{4, 1, 0, 0}, {0, 3, 1, 0}, {0, 1, 2, 0}, {0, 0, 1, 12}}}}; }

TEST(Summary, SaysWhoseConverterWasAtItsEnd) {
  TrialSummary trial = small_trial();
  EXPECT_THAT(trial_text(trial, sensors, Style(false)), Not(HasSubstr("saturated")));
  trial.outcome.saturated = {{"pad", 1}};
  EXPECT_THAT(trial_text(trial, sensors, Style(false)),
              HasSubstr("\n  saturated: pad: values beyond its range in 1 of 2 samples\n"));
  SweepSummary sweep;
  sweep.trials = {trial, small_trial(), trial};
  EXPECT_THAT(sweep_text(sweep, Style(false)),
              HasSubstr("\n  saturated: pad: values beyond its range in 2 of 3 trials, 2 samples\n"));
}

constexpr const char* small_figures = "; recall of slip 93.8 %, balanced accuracy 78.0 % (constant detector: 33.3 %)\n";

// A constant answer has a balanced accuracy of 1 in 3 states.
TEST(Summary, TrialSaysHowTheDetectorDid) {
  TrialSummary trial = small_trial();
  trial.detector = small_detector();
  const auto text = [&](Detection detection) {
    trial.outcome.detection = detection;
    return trial_text(trial, sensors, Style(false));
  };
  EXPECT_THAT(text(Detection::missed), HasSubstr(std::string("\n  ratio on pad: slip missed") + small_figures));
  trial.outcome.detection_time = 1.26;
  trial.outcome.detection_delay = 0.01;
  EXPECT_THAT(text(Detection::seen),
              HasSubstr(std::string("\n  ratio on pad: slip detected 10.0 ms after the onset, at 1.2600 s") + small_figures));
  trial.outcome.false_alarm_time = 0.5;
  EXPECT_THAT(text(Detection::early),
              AllOf(HasSubstr(std::string("\n  ratio on pad: early alarm at 0.5000 s, before the slip") + small_figures),
                    Not(HasSubstr("after the onset"))));
  trial.detector->confusion = {{{4, 0, 0, 0}, {0, 19, 1, 0}, {}, {}}};
  EXPECT_THAT(
      text(Detection::false_alarm),
      HasSubstr("\n  ratio on pad: false alarm at 0.5000 s; nothing slips; recall of slip -, balanced accuracy 95.0 % (constant "
                "detector: 100.0 %)\n"));
  trial.detector->confusion = {};
  EXPECT_THAT(text(Detection::quiet), HasSubstr("\n  ratio on pad: no slip and no alarm; no contact\n"));
}

TEST(Summary, CallsTheOracleWhatItIs) {
  SweepSummary summary;
  summary.trials.assign(1, small_trial());
  summary.trials[0].detector = small_detector();
  summary.trials[0].detector->type = "truth";
  summary.trials[0].outcome.detection = Detection::missed;
  EXPECT_THAT(trial_text(summary.trials[0], sensors, Style(false)), HasSubstr("\n  oracle (truth) on pad: slip missed"));
  EXPECT_THAT(sweep_text(summary, Style(false)), HasSubstr("\n  oracle (truth) "));
}

// Six trials with `ratio`: two detect their slip, after 10 and 30 ms, one alarms before it, one
// misses it; of two without slip one alarms. One trial with another detector.
SweepSummary detector_sweep() {
  SweepSummary summary;
  summary.trials.assign(7, small_trial());
  for (TrialSummary& trial : summary.trials) {
    trial.detector = small_detector();
    trial.outcome.detection = Detection::missed;
  }
  const auto see = [&summary](std::size_t trial, double delay) {
    summary.trials[trial].outcome.detection = Detection::seen;
    summary.trials[trial].outcome.detection_time = 1.25 + delay;
    summary.trials[trial].outcome.detection_delay = delay;
  };
  see(0, 0.01);
  see(2, 0.03);
  // An early alarm still on when slip begins, 0.4 ms after: no delay.
  summary.trials[1].outcome.false_alarm_time = 0.166;
  summary.trials[1].outcome.detection_time = 1.2504;
  summary.trials[1].outcome.detection = Detection::early;
  for (const std::size_t trial : {4U, 5U}) {
    summary.trials[trial].detector->confusion = {{{0, 0, 0, 0}, {0, 20, 0, 0}, {}, {}}};
    summary.trials[trial].outcome.detection = Detection::quiet;
  }
  summary.trials[5].outcome.detection = Detection::false_alarm;
  summary.trials[6].detector->type = "other";
  return summary;
}

// Recalls of ratio over its trials: (4 3 + 40)/(4 4 + 40), 2/3 and 12/13, with a mean of 0.8394; of
// slip 15/16.
TEST(Summary, SweepSaysHowEachDetectorDid) {
  // Recall, balanced accuracy, constant detector, median and worst delay, detected, early, missed, false alarms.
  const std::string text = sweep_text(detector_sweep(), Style(false));
  EXPECT_THAT(text, ContainsRegex("ratio +93\\.8 % +83\\.9 % +33\\.3 % +20\\.0 ms +30\\.0 ms +2 of 4 +1 of 4 +1 of 4 +1 of 2\n"));
  EXPECT_THAT(text, ContainsRegex("other +93\\.8 % +78\\.0 % +33\\.3 % +- +- +0 of 1 +0 of 1 +1 of 1 +-\n"));
}

TEST(Summary, JsonSaysTheSameOfEachDetector) {
  const nlohmann::ordered_json scores = detectors_json(detector_scores(detector_sweep().trials));
  ASSERT_EQ(scores.size(), 2U);
  const nlohmann::ordered_json& ratio = scores[0];
  EXPECT_EQ(ratio.at("type"), "ratio");
  EXPECT_FALSE(ratio.at("oracle").get<bool>());
  EXPECT_DOUBLE_EQ(ratio.at("recall_of_slip").get<double>(), 15.0 / 16.0);
  EXPECT_DOUBLE_EQ(ratio.at("balanced_accuracy").get<double>(), (52.0 / 56.0 + 2.0 / 3.0 + 12.0 / 13.0) / 3.0);
  EXPECT_DOUBLE_EQ(ratio.at("constant_balanced_accuracy").get<double>(), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(ratio.at("median_delay_s").get<double>(), 0.02);
  EXPECT_DOUBLE_EQ(ratio.at("worst_delay_s").get<double>(), 0.03);
  EXPECT_EQ(ratio.at("trials"), 6);
  EXPECT_EQ(ratio.at("slipping"), 4);
  EXPECT_EQ(ratio.at("seen"), 2);
  EXPECT_EQ(ratio.at("early"), 1);
  EXPECT_EQ(ratio.at("missed"), 1);
  EXPECT_EQ(ratio.at("false_alarms"), 1);
  EXPECT_DOUBLE_EQ(ratio.at("accuracy").get<double>(), (4.0 * 17.0 + 40.0) / 120.0);
  EXPECT_DOUBLE_EQ(ratio.at("constant_accuracy").get<double>(), 56.0 / 120.0);
  EXPECT_TRUE(nlohmann::ordered_json::parse(scores[1].dump()).at("median_delay_s").is_null());
}

// A grasp by `type` and step_on_slip, with an ideal force of 2 N.
TrialSummary small_grasp(const std::string& type, bool dropped, const std::string& params = "{}") {
  TrialSummary trial = small_trial();
  trial.params = params;
  trial.detector = small_detector();
  trial.detector->type = type;
  trial.outcome.detection = Detection::missed;
  trial.controller = "step_on_slip";
  trial.outcome.grasp.emplace();
  trial.outcome.grasp->dropped = dropped;
  trial.outcome.grasp->ideal_grip_force = 2.0;
  trial.outcome.grasp->max_grip_force = 3.0;
  if (dropped) {
    trial.outcome.grasp->drop_time = 2.5;
  } else {
    trial.outcome.grasp->slip_translation = 0.00125;
    trial.outcome.grasp->slip_rotation = 0.01745329252;  // 1 deg
  }
  return trial;
}

TEST(Summary, TrialSaysHowTheGraspEnded) {
  TrialSummary trial = small_grasp("ratio", false);
  EXPECT_THAT(trial_text(trial, sensors, Style(false)),
              HasSubstr("\n  held, slipped by 1.25 mm and 1.00 deg; grip force up to 3.00 N, 1.50 times the ideal 2.00 N\n"));
  trial = small_grasp("ratio", true);
  trial.outcome.grasp->ideal_grip_force = never;
  trial.outcome.grasp->reaction_time = 0.04;
  EXPECT_THAT(trial_text(trial, sensors, Style(false)),
              HasSubstr("\n  dropped at 2.5000 s; grip force up to 3.00 N; tightened 40 ms after the first slip in the lift\n"));
}

// Neither held nor dropped: one of three each.
TEST(Summary, BoxThatIsNotLiftedIsNotHeld) {
  SweepSummary summary;
  for (const bool dropped : {false, true, false}) summary.trials.push_back(small_grasp("ratio", dropped));
  GraspOutcome& grasp = *summary.trials[2].outcome.grasp;
  grasp.lifted = false;
  grasp.lift_height = 0.0;
  grasp.slip_translation = grasp.slip_rotation = never;
  EXPECT_THAT(trial_text(summary.trials[2], sensors, Style(false)),
              HasSubstr("\n  not lifted: the box stays on the table; grip force up to 3.00 N, 1.50 times the ideal 2.00 N\n"));
  EXPECT_THAT(sweep_text(summary, Style(false)), HasSubstr("1 of 3  0.8 to 90.6 %        1           1  1.25 mm"));
  const GraspRow row = grasp_rows(summary).at(0);
  EXPECT_EQ(row.held + row.dropped + row.not_lifted, 3U);
  summary.trials[0].outcome.grasp->lifted = true;
  summary.trials[0].outcome.grasp->lift_height = 0.0998;
  EXPECT_THAT(trial_text(summary.trials[0], sensors, Style(false)), HasSubstr("lifted by 99.8 mm; grip force up to"));
}

// Ten of ten with one detector, one of two with another; the bounds for all or none of n solve p^n
// = 0.025, for one of two 1 - (1 - p)^2 = 0.025.
TEST(Summary, SweepShowsTheGraspsByDetectorAndController) {
  SweepSummary summary;
  for (int i = 0; i < 10; ++i) summary.trials.push_back(small_grasp("truth", false, R"({"detector.ratio": null})"));
  summary.trials[3].outcome.grasp->reaction_time = 0.02;
  summary.trials[7].outcome.grasp->reaction_time = 0.06;
  summary.trials.push_back(small_grasp("ratio", true, R"({"detector.type": "ratio", "detector.ratio": 0.3})"));
  summary.trials.push_back(small_grasp("ratio", false, R"({"detector.type": "ratio", "detector.ratio": 0.3})"));
  summary.trials.back().outcome.grasp->max_grip_force = 4.0;
  // Held and its bounds, dropped, not lifted, slip, rotation, greatest force over the ideal one, reaction.
  EXPECT_THAT(sweep_text(summary, Style(false)),
              ContainsRegex("truth.* 10 of 10 +69\\.2 to 100\\.0 % +0 +0 +1\\.25 mm +1\\.00 deg +1\\.50 +40 ms\n"));
  const std::vector<GraspRow> rows = grasp_rows(summary);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR(rows[0].held_share.low, std::pow(0.025, 0.1), 1e-12);
  EXPECT_NEAR(rows[1].held_share.low, 1.0 - std::sqrt(0.975), 1e-12);
  const nlohmann::ordered_json json = grasp_json(rows);
  EXPECT_EQ(json.at(1).at("name"), "ratio (ratio 0.3), step_on_slip");
  EXPECT_EQ(json.at(1).at("held"), 1);
  EXPECT_EQ(json.at(1).at("dropped"), 1);
  EXPECT_EQ(json.at(1).at("not_lifted"), 0);
  EXPECT_EQ(json.at(1).at("median_force_ratio"), 1.75);
  EXPECT_EQ(json.at(1).at("median_reaction_time_s").dump(), "null");
}

// 30 thresholds, each drawn once: one row is more useful than 30 with one trial each.
TEST(Summary, ManySweptParametersShareARow) {
  SweepSummary summary;
  for (int i = 0; i < 30; ++i)
    summary.trials.push_back(small_grasp("ratio", false, R"({"detector.ratio": )" + std::to_string(i) + "}"));
  const std::vector<GraspRow> rows = grasp_rows(summary);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].name, "ratio, step_on_slip");
  EXPECT_EQ(rows[0].trials, 30U);
  EXPECT_TRUE(grasp_rows({}).empty());
}

TEST(Summary, TrialWithoutGrossSlipSaysSo) {
  TrialSummary trial = small_trial();
  trial.outcome.gross_slip_time = never;
  EXPECT_THAT(trial_text(trial, sensors, Style(false)), HasSubstr("first slip at 1.2000 s, no gross slip"));
  trial.outcome.first_micro_slip_time = never;
  EXPECT_THAT(trial_text(trial, sensors, Style(false)), HasSubstr("nothing slips"));
}

TEST(Summary, SweepShowsHowManyTrialsReachedEachStageAndWhen) {
  SweepSummary summary;
  summary.trials.resize(4);
  const double gross[] = {1.0, 3.0, never, 1.5};
  for (std::size_t i = 0; i < 4; ++i) {
    summary.trials[i].outcome.touch_time = 0.25;
    summary.trials[i].outcome.gross_slip_time = gross[i];
    summary.trials[i].sensors.resize(1);
    summary.trials[i].sensors[0].state_count = {1, 1, 0, 2};
    summary.trials[i].sensors[0].state_micro_count = {1, 0, 1, 2};
  }
  // Trials, earliest, median, latest.
  const std::string text = sweep_text(summary, Style(false));
  EXPECT_THAT(text, ContainsRegex("touch +4 +0\\.2500 s +0\\.2500 s +0\\.2500 s\n"));
  EXPECT_THAT(text, ContainsRegex("first full slip +0 +- +- +-\n"));
  EXPECT_THAT(text, ContainsRegex("gross slip +3 +1\\.0000 s +1\\.5000 s +3\\.0000 s\n"));
  EXPECT_THAT(text, HasSubstr(shares_text({1, 1, 0, 2})));
}

TEST(Summary, UnitsThatSlipTogetherShareARank) {
  TrialSummary trial = small_trial();
  trial.sensors[0].units[1].onset_time = 1.25 + 1e-12;  // the same instant up to rounding
  EXPECT_THAT(trial_text(trial, sensors, Style(false)),
              AllOf(HasSubstr("1.2500 s      1  1.25 mm"), HasSubstr("1.2500 s      1  0.00 mm")));
}

TEST(Summary, SceneShowsWhatIsMoved) {
  Catalogues catalogues;
  catalogues.motions = {{"stage",
                         "",
                         "",
                         "",
                         {number_spec("speed", Quantity::speed, "0 mm/s", any_value, "", ""),
                          number_spec("stop", Quantity::time, "inf", positive_or_infinite, "", "")}}};
  Scene scene;
  scene.description = "A test";
  scene.material = "glass";
  scene.surface.name = "plane";
  scene.friction = {0.5, 0.25};
  scene.motion.name = "stage";
  scene.motion.parameters.set("speed", 0.0040123456);
  scene.motion.parameters.set("stop", std::numeric_limits<double>::infinity());  // never, so not shown
  const std::string text = scene_text(scene, catalogues, Style(false), 100);
  EXPECT_THAT(text, mentions({"A test", "glass", "plane", "0.5", "0.25", "stage", "speed 4.012 mm/s"}));
  EXPECT_THAT(text, Not(HasSubstr("stop")));
}

TEST(Summary, SpeedIsSimulatedTimeOverRealTime) {
  SweepSummary summary;
  summary.trials.resize(100);
  summary.simulated = 400.0;
  summary.computed = 0.25;
  // 400/2 for the command, 400/0.25 for the steps.
  EXPECT_EQ(speed_text(summary, 2.0), "400 s simulated in 2 s, 200 times real time, 50 trials/s; 1.6k times real time per core");
  summary.trials.resize(1);
  EXPECT_EQ(speed_text(summary, 2.0), "400 s simulated in 2 s, 200 times real time; 1.6k times real time per core");
}

TEST(Summary, GraspsSayTheirStepAndWhatItIsGoodFor) {
  SweepSummary summary;
  summary.scene.fidelity = "field";
  summary.shortest_step = 5e-3 / 9.0;
  summary.longest_step = 2e-3 / 3.0;
  EXPECT_EQ(steps_text(summary), "") << "nothing is held";
  summary.scene.grasp.emplace();
  EXPECT_THAT(steps_text(summary), StartsWith("time step 0.5556 ms to 0.6667 ms (auto): onsets usually agree with"));
  summary.shortest_step = summary.longest_step;
  summary.scene.time_step = summary.longest_step;
  EXPECT_THAT(steps_text(summary), StartsWith("time step 0.6667 ms: onsets usually agree with"));
}

}  // namespace
}  // namespace slipbench

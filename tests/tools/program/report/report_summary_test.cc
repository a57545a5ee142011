#include "tools/program/report/report_parts.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include "sim/core/contact_frame.h"
#include "tests/expect.h"
#include "tests/tools/program/report/sample.h"

namespace slipbench::report {
namespace {

TEST(Summary, CountsSharesOfTime) {
  const Json summary = summarise(sample_trial(0, "{}").sensors[0]);
  // Of eight samples, by the table in sample.h.
  EXPECT_EQ(summary.at("shares").at("strict"), Json::parse("[0.125, 0.375, 0.25, 0.25]"));
  EXPECT_EQ(summary.at("shares").at("micro"), Json::parse("[0.125, 0.25, 0.25, 0.375]"));
  EXPECT_EQ(summary.at("shares").at("paper"), Json::parse("[0.125, 0.5, 0.125, 0.25]"));
}

TEST(Summary, TakesOnsetsFromInsideTheStep) {
  const Json summary = summarise(sample_trial(0, "{}").sensors[0]);
  EXPECT_EQ(summary.at("first_touch_s"), 0.5e-3);
  EXPECT_EQ(summary.at("first_micro_s"), 2.25e-3);
  EXPECT_EQ(summary.at("first_full_s"), 3.5e-3);
  EXPECT_EQ(summary.at("gross_s"), 5.75e-3);  // not 6 ms, the sample
  EXPECT_NEAR(summary.at("incipient_s").get<double>(), 3.5e-3, 1e-15);
}

TEST(Summary, GrossWithoutAnEventBeginsAtItsSample) {
  SensorRecord sensor = sample_trial(0, "{}").sensors[0];
  sensor.labels.event_kind.back() = 3;  // the other unit lets go by leaving the surface
  EXPECT_EQ(summarise(sensor).at("gross_s"), 6e-3);
}

TEST(Summary, ComparesRulesWhereEitherSeesContact) {
  const Json summary = summarise(sample_trial(0, "{}").sensors[0]);
  // Seven samples in contact; paper differs in sample 4, micro in samples 3 and 5.
  EXPECT_NEAR(summary.at("disagreement").at("paper").get<double>(), 1.0 / 7.0, 1e-15);
  EXPECT_NEAR(summary.at("disagreement").at("micro").get<double>(), 2.0 / 7.0, 1e-15);
}

TEST(Summary, SaysNeverForWhatDoesNotHappen) {
  SensorRecord sensor = sample_trial(0, "{}").sensors[0];
  sensor.labels.state.assign(8, 0);
  sensor.labels.state_paper.assign(8, 0);
  sensor.labels.micro_onset_time.assign(2, std::nan(""));
  const Json summary = summarise(sensor);
  EXPECT_TRUE(summary.at("gross_s").is_null());
  EXPECT_TRUE(summary.at("first_micro_s").is_null());
  EXPECT_TRUE(summary.at("incipient_s").is_null());
  EXPECT_TRUE(summary.at("disagreement").at("paper").is_null());
}

TEST(MotionStart, IgnoresThePressAndWhatCameBefore) {
  const TrialRecord trial = sample_trial(0, "{}");
  EXPECT_DOUBLE_EQ(motion_start(trial, 0.0), 2e-3);  // samples 0 and 1 only press
  EXPECT_DOUBLE_EQ(motion_start(trial, 4.5e-3), 5e-3);
  EXPECT_TRUE(std::isnan(motion_start(trial, 1.0)));
}

TEST(CheckLabels, RefusesWhatDoesNotExist) {
  const std::vector<std::pair<std::function<void(SensorRecord&)>, std::string>> cases = {
      {[](SensorRecord& s) { s.labels.unit_state[3] = 4; }, "x.h5: labels/pad holds state 4; allowed: 0 to 3"},
      {[](SensorRecord& s) { s.labels.state_paper[3] = 9; }, "holds state 9"},
      {[](SensorRecord& s) { s.labels.event_unit[0] = 2; }, "has an event of unit 2; there are 2"},
      {[](SensorRecord& s) { s.labels.event_kind[0] = 6; }, "has an event of kind 6; allowed: 0 to 5"},
      {[](SensorRecord& s) { s.time.clear(); }, "holds no sample"},
      {[](SensorRecord& s) { s.channel_names.pop_back(); }, "sensors/pad names 11 channels; its samples hold 12 values"},
  };
  SensorRecord sound = sample_trial(0, "{}").sensors[0];
  sound.labels.event_kind.back() = static_cast<std::uint8_t>(EventKind::part_sticks);
  EXPECT_NO_THROW(check_labels(sound, "x.h5"));
  for (const auto& [damage, message] : cases) {
    SensorRecord sensor = sample_trial(0, "{}").sensors[0];
    damage(sensor);
    EXPECT_THAT(refusal_of([&] { check_labels(sensor, "x.h5"); }), HasSubstr(message));
  }
}

}  // namespace
}  // namespace slipbench::report

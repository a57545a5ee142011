#include "tools/learning_data/label_rules.h"

#include "tests/expect.h"

namespace slipbench::label_rules_test {
namespace {

// Three samples of a skin: no contact, then a part of it slips, then all of it.
SensorRecord skin() {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "myrmex";
  sensor.time = {0.0, 0.1, 0.2};
  sensor.labels.state = {0, 1, 3};
  sensor.labels.state_micro = {0, 2, 3};
  sensor.labels.state_paper = {0, 1, 1};
  return sensor;
}

TEST(LabelRules, AreInTheOrderOfTheirValuesAndNamed) {
  for (std::size_t k = 0; k < label_rules().size(); ++k) {
    const LabelRuleInfo& rule = label_rules()[k];
    EXPECT_EQ(static_cast<std::size_t>(rule.value), k) << rule.name;
    EXPECT_EQ(parse_label_rule(label_rule_name(rule.value)), rule.value);
    EXPECT_NE(rule.stored == nullptr, rule.computed == nullptr) << rule.name << " has one source of states";
    EXPECT_EQ(about_rule(rule.evaluated_by).evaluated_by, rule.evaluated_by) << rule.name;
  }
}

// The lists of docs/concepts/labels.md.
TEST(LabelRules, EachUseTakesItsOwn) {
  EXPECT_THAT(label_rule_names(LabelUse::pillars), ElementsAre("strict", "micro", "paper", "has_slipped"));
  EXPECT_THAT(label_rule_names(LabelUse::training),
              ElementsAre("strict", "micro", "paper", "latched", "masked", "tightened", "moved", "slides", "recorded"));
  EXPECT_THAT(label_rule_names(LabelUse::evaluation),
              ElementsAre("strict", "micro", "paper", "latched", "masked", "has_slipped", "recorded"));
  EXPECT_THAT(refusal_of([] { parse_label_rule("tightend"); }), mentions({"tightend", "tightened"}));
  EXPECT_THAT(refusal_of([] { parse_label_rule("tightened", LabelUse::evaluation); }), mentions({"tightened", "strict"}));
}

TEST(LabelRules, ArraysAreThoseOfTheDataset) {
  std::vector<std::string> arrays;
  for (const LabelRuleInfo& rule : stored_rules()) arrays.push_back(array_of(rule));
  EXPECT_THAT(arrays, ElementsAre("state", "state_micro", "state_paper"));
  EXPECT_EQ(array_of(about_rule(LabelRule::recorded)), "state_paper");
  EXPECT_EQ(array_of(about_rule(LabelRule::latched)), "") << "latched changes states of state_micro";
  EXPECT_EQ(array_of(about_rule(LabelRule::has_slipped)), "");
}

TEST(LabelRules, HelpHasALineForEachRule) {
  EXPECT_THAT(label_rules_text(LabelUse::pillars),
              AllOf(HasSubstr("  strict       a unit counts as slipping when all of it slips\n"),
                    HasSubstr("  has_slipped  PapillArray"), Not(HasSubstr("latched"))));
}

// `eval` does not take moved, a rule of training.
TEST(LabelRules, ARuleOfAnotherUseIsNotCalledUnknown) {
  EXPECT_EQ(parse_label_rule("moved", LabelUse::training), LabelRule::moved);
  EXPECT_THAT(refusal_of([] { parse_label_rule("moved", LabelUse::evaluation); }),
              AllOf(mentions({"moved", "masked"}), Not(HasSubstr("unknown"))));
}

TEST(StatesBy, AreThoseOfTheArrayOfTheRule) {
  using enum PadState;
  EXPECT_THAT(states_by(skin(), LabelRule::strict, false, LabelUse::evaluation), ElementsAre(no_contact, non_slip, gross));
  EXPECT_THAT(states_by(skin(), LabelRule::latched, false, LabelUse::evaluation), ElementsAre(no_contact, incipient, gross));
  EXPECT_THAT(states_by(skin(), LabelRule::paper, false, LabelUse::evaluation), ElementsAre(no_contact, non_slip, non_slip));
}

// A unit that slips by the steps of `path`, sampled each 50 ms: over 0.1 s, two steps, 1 mm/s are 0.1 mm
// and 0.5 mm/s are 0.05 mm. The first samples have a shorter past. A step of a slow sensor is longer
// than 0.1 s.
TEST(StatesBy, SlidesByTheSpeedOfTheObject) {
  using enum PadState;
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "magnetic_skin";
  sensor.labels.k_normal = {1000.0};  // one unit
  const auto states = [&](double period, const std::vector<float>& path) {
    sensor.time.clear();
    for (std::size_t k = 0; k < path.size(); ++k) sensor.time.push_back(period * static_cast<double>(k));
    sensor.labels.slip_distance = path;
    sensor.labels.unit_state.assign(path.size(), 2);
    sensor.labels.state_micro.assign(path.size(), 2);
    return states_by(sensor, LabelRule::slides, false, LabelUse::training);
  };
  EXPECT_THAT(states(0.05, {0.0F, 0.04e-3F, 0.08e-3F, 0.15e-3F, 0.21e-3F, 0.21e-3F, 0.21e-3F}),
              ElementsAre(non_slip, non_slip, unknown_state, gross, gross, unknown_state, non_slip));
  EXPECT_THAT(states(0.2, {0.0F, 0.21e-3F, 0.35e-3F, 0.4e-3F}), ElementsAre(non_slip, gross, unknown_state, non_slip));
  sensor.labels.slip_distance.clear();
  EXPECT_THAT(refusal_of([&] { states_by(sensor, LabelRule::slides, false, LabelUse::training); }), mentions({"slip distance"}));
}

// Labels of a recording may be unknown, those of a simulation may not.
TEST(StatesBy, OfARecordingMayBeUnknown) {
  SensorRecord sensor = skin();
  sensor.labels.state_paper[1] = 4;
  EXPECT_THAT(refusal_of([&] { states_by(sensor, LabelRule::paper, false, LabelUse::evaluation); }),
              mentions({"state 4", "0 to 3"}));
  sensor.labels.truth = false;
  EXPECT_EQ(states_by(sensor, LabelRule::recorded, false, LabelUse::evaluation)[1], unknown_state);
}

TEST(StatesBy, RefuseWhatDoesNotFit) {
  const auto refusal = [](const SensorRecord& sensor, LabelRule rule) {
    return refusal_of([&] { states_by(sensor, rule, false, LabelUse::evaluation); });
  };
  EXPECT_THAT(refusal(skin(), LabelRule::has_slipped), mentions({"myrmex", "has_slipped", "papillarray", "masked"}));
  EXPECT_THAT(refusal(skin(), LabelRule::recorded), mentions({"simulated", "recorded", "strict, micro, paper"}));
  // `eval` does not take the rules that are for training only.
  EXPECT_THAT(refusal(skin(), LabelRule::recorded), Not(HasSubstr("moved")));
  SensorRecord damaged = skin();
  damaged.labels.state[2] = 7;
  EXPECT_THAT(refusal(damaged, LabelRule::strict), mentions({"labels/pad", "state 7", "0", "3"}));
  damaged.labels.state.clear();
  EXPECT_THAT(refusal(damaged, LabelRule::strict), mentions({"0 states", "strict", "3 samples"}));
  SensorRecord recording = skin();
  recording.labels.truth = false;
  EXPECT_THAT(refusal(recording, LabelRule::micro), mentions({"is recorded", "micro", "--labels recorded"}));
  recording.labels.state_paper.clear();
  EXPECT_THAT(refusal(recording, LabelRule::recorded), mentions({"no labels", "slipbench detect", "key state"}));
}

}  // namespace
}  // namespace slipbench::label_rules_test

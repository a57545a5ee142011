#include "tools/program/eval/metrics.h"

#include <cmath>

#include "sim/core/contact_frame.h"
#include "tests/expect.h"

namespace slipbench::eval::truth_test {
namespace {

constexpr PadState none = PadState::no_contact, stick = PadState::non_slip, some = PadState::incipient, all = PadState::gross;

// Eight samples at 10 Hz of a pad with two units, which slips in part, comes to rest, and is touched once more.
SensorRecord sensor() {
  SensorRecord record;
  record.name = "pad";
  record.type = "myrmex";
  record.rate = 10.0;
  for (int row = 0; row < 8; ++row) record.time.push_back(0.1 * row);
  record.labels.state = {0, 1, 1, 3, 1, 1, 0, 1};
  record.labels.state_micro = {0, 1, 2, 3, 2, 1, 0, 1};
  record.labels.state_paper = {0, 1, 1, 2, 1, 1, 0, 1};
  record.labels.k_normal = {1.0, 1.0};
  record.labels.event_time = {0.05, 0.16, 0.24, 0.41};
  record.labels.event_unit = {0, 1, 1, 0};
  record.labels.event_kind = {static_cast<std::uint8_t>(EventKind::touch), static_cast<std::uint8_t>(EventKind::micro),
                              static_cast<std::uint8_t>(EventKind::slip), static_cast<std::uint8_t>(EventKind::stick)};
  return record;
}

TEST(Labels, RulesOfTheDatasetStandAsTheyAre) {
  EXPECT_EQ(label_states(sensor(), TruthRule::strict, false), (std::vector{none, stick, stick, all, stick, stick, none, stick}));
  EXPECT_EQ(label_states(sensor(), TruthRule::micro, false), (std::vector{none, stick, some, all, some, stick, none, stick}));
  EXPECT_EQ(label_states(sensor(), TruthRule::paper, false), (std::vector{none, stick, stick, some, stick, stick, none, stick}));
}

// Gross at 0.3 s, it stays so when less and then nothing slips; at 0.6 s contact is lost, and at 0.7 s it sticks anew.
TEST(Labels, LatchedHoldsUntilContactIsLost) {
  EXPECT_EQ(label_states(sensor(), TruthRule::latched, false), (std::vector{none, stick, some, all, all, all, none, stick}));
}

// Slips from 0.2 s to 0.4 s: at 0.5 s it sticks under the shear of that slip, at 0.7 s in a new contact.
TEST(Labels, MaskedIsMicroWithoutWhatSticksAgain) {
  EXPECT_EQ(label_states(sensor(), TruthRule::masked, false), label_states(sensor(), TruthRule::micro, false));
  const auto masked = [](TruthRule rule) { return truth_of(nullptr, {}, sensor(), rule).masked; };
  EXPECT_EQ(masked(TruthRule::masked), (std::vector{false, false, false, false, false, true, false, false}));
  EXPECT_TRUE(masked(TruthRule::micro).empty());
}

TEST(Labels, RefuseWhatDoesNotFit) {
  const auto refusal = [](const SensorRecord& record, TruthRule rule) {
    return refusal_of([&] { label_states(record, rule, false); });
  };
  EXPECT_THAT(refusal(sensor(), TruthRule::has_slipped), HasSubstr("is a myrmex; the rule has_slipped is the PapillArray's"));
  SensorRecord damaged = sensor();
  damaged.labels.state[2] = 7;
  EXPECT_THAT(refusal(damaged, TruthRule::strict), HasSubstr("state 7; allowed: 0 to 3"));
  damaged.labels.state.clear();
  EXPECT_THAT(refusal(damaged, TruthRule::strict), HasSubstr("0 states of 8 samples"));
}

TEST(Labels, RulesAreNamed) {
  for (const std::string& name : label_rule_names()) EXPECT_EQ(label_rule_name(parse_label_rule(name)), name);
  EXPECT_THAT(refusal_of([&] { parse_label_rule("stricd"); }), HasSubstr("did you mean 'strict'"));
}

// A unit slips as a whole at 0.24 s, a part of it from 0.16 s on.
TEST(FirstSlip, IsResolvedInsideTheStep) {
  const SensorRecord record = sensor();
  const auto first = [&](TruthRule rule, double from) {
    return first_slip(record, rule, label_states(record, rule, false), from);
  };
  EXPECT_EQ(first(TruthRule::strict, 0.0), 0.24);
  EXPECT_EQ(first(TruthRule::micro, 0.0), 0.16);
  EXPECT_EQ(first(TruthRule::paper, 0.0), 0.16);
  EXPECT_EQ(first(TruthRule::micro, 0.2), 0.24) << "a whole unit is a part, too";
  EXPECT_TRUE(std::isnan(first(TruthRule::strict, 0.25)));
}

TEST(FirstSlip, OfASingleUnitIsThatOfAPart) {
  SensorRecord record = sensor();
  record.labels.k_normal = {1.0};
  EXPECT_EQ(first_slip(record, TruthRule::strict, label_states(record, TruthRule::strict, false), 0.0), 0.16);
}

// As in a real recording, whose labels a person wrote.
TEST(FirstSlip, WithoutEventsIsThatOfTheSamples) {
  SensorRecord record = sensor();
  record.labels.event_time.clear();
  EXPECT_EQ(first_slip(record, TruthRule::strict, label_states(record, TruthRule::strict, false), 0.0), record.time[3]);
}

// A recorded grasp does not say when it was lifted: its first sample counts as the others do.
TEST(Truth, AGraspWithoutASceneCountsFromItsBeginning) {
  TrialRecord record;
  record.outcome.grasp.emplace().dropped = true;
  SensorRecord finger = sensor();
  finger.labels.event_time.clear();
  finger.labels.state_paper = {3, 3, 3, 3, 3, 3, 3, 3};
  const Truth truth = truth_of(nullptr, record, finger, TruthRule::paper);
  EXPECT_EQ(truth.first_slip, 0.0);
  EXPECT_TRUE(truth.counts(0.0));
  EXPECT_TRUE(truth.counts(0.7));
}

// Slip of closing fingers from 1 s, lift at 2 s, drop at 4 s.
TEST(Truth, AlarmsOfClosingFingersAndAfterADropDoNotCount) {
  Truth grasp;
  grasp.any_slip = 1.0;
  grasp.judged_from = 2.0;
  grasp.judged_until = 4.0;
  EXPECT_TRUE(grasp.counts(0.5));
  EXPECT_FALSE(grasp.counts(1.0));
  EXPECT_FALSE(grasp.counts(1.9));
  EXPECT_TRUE(grasp.counts(2.0));
  EXPECT_FALSE(grasp.counts(4.0));
  EXPECT_TRUE(Truth{}.counts(1e9)) << "elsewhere all count";
}

}  // namespace
}  // namespace slipbench::eval::truth_test

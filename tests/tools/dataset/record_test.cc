#include <cmath>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/header.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/files/output_file.h"

namespace slipbench::testing {
namespace {

TEST(Outcome, ComesBackFromItsJson) {
  TrialOutcome outcome;
  outcome.first_slip_time = 2.1651602564102563;  // needs all 17 digits
  outcome.max_slip_distance = 0.1 + 0.2;
  const TrialOutcome back = parse_outcome(outcome_json(outcome));
  EXPECT_EQ(back.first_slip_time, outcome.first_slip_time);
  EXPECT_EQ(back.max_slip_distance, outcome.max_slip_distance);
  EXPECT_TRUE(std::isnan(back.gross_slip_time));
  EXPECT_TRUE(std::isnan(back.detection_time));
}

TEST(Outcome, KeepsWhatBecameOfTheDetector) {
  TrialOutcome outcome;
  outcome.false_alarm_time = 1.0 / 3.0;
  outcome.detection_time = 2.166;
  outcome.detection_delay = 2.166 - 2.1651602564102563;
  const TrialOutcome back = parse_outcome(outcome_json(outcome));
  EXPECT_EQ(back.false_alarm_time, outcome.false_alarm_time);
  EXPECT_EQ(back.detection_time, outcome.detection_time);
  EXPECT_EQ(back.detection_delay, outcome.detection_delay);
}

TEST(Outcome, SaysWhetherABodyWasHeldWhereTheSceneAsks) {
  TrialOutcome outcome;
  EXPECT_EQ(outcome_json(outcome).find("held"), std::string::npos);
  EXPECT_FALSE(parse_outcome(outcome_json(outcome)).hold.has_value());
  outcome.hold = {.held = true, .from = 1.3, .moved = 1.0 / 3.0};
  const TrialOutcome back = parse_outcome(outcome_json(outcome));
  EXPECT_TRUE(back.hold->held);
  EXPECT_EQ(back.hold->from, 1.3);
  EXPECT_EQ(back.hold->moved, 1.0 / 3.0);
}

// Scripts read the three times; the two other keys exist only with a detector.
TEST(Outcome, SaysHowTheDetectorDid) {
  TrialOutcome outcome;
  EXPECT_EQ(outcome_json(outcome).find("detection\""), std::string::npos);
  EXPECT_EQ(outcome_json(outcome).find("judged_slip_time_s"), std::string::npos);
  EXPECT_FALSE(parse_outcome(outcome_json(outcome)).detection.has_value());
  outcome.judged_slip_time = 2.1651602564102563;
  for (const Detection detection :
       {Detection::quiet, Detection::false_alarm, Detection::early, Detection::seen, Detection::missed}) {
    outcome.detection = detection;
    const TrialOutcome back = parse_outcome(outcome_json(outcome));
    EXPECT_EQ(back.detection, detection);
    EXPECT_EQ(back.judged_slip_time, outcome.judged_slip_time);
  }
  EXPECT_THAT(outcome_json(outcome), HasSubstr(R"("detection":"missed")"));
  std::string wrong = outcome_json(outcome);
  wrong.replace(wrong.find("missed"), 6, "mist");
  EXPECT_THAT(refusal_of([&] { parse_outcome(wrong); }), mentions({"detection", "mist"}));
}

// An outcome whose loop reacted 40 ms after a slip at 1 s.
TrialOutcome judged(double false_alarm, double detection, bool slips) {
  TrialOutcome outcome;
  outcome.grasp = GraspOutcome{.reaction_time = 0.04};
  outcome.false_alarm_time = false_alarm;
  outcome.detection_time = detection;
  if (slips) outcome.judged_slip_time = 1.0;
  outcome.detection_delay = outcome.detection_time - outcome.judged_slip_time;
  settle_detection(outcome, slips);
  return outcome;
}

TEST(Detection, IsDecidedByTheFirstAlarm) {
  constexpr double never = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(judged(never, never, false).detection, Detection::quiet);
  EXPECT_EQ(judged(0.5, never, false).detection, Detection::false_alarm);
  EXPECT_EQ(judged(never, never, true).detection, Detection::missed);
  const TrialOutcome seen = judged(never, 1.25, true);
  EXPECT_EQ(seen.detection, Detection::seen);
  EXPECT_EQ(seen.detection_delay, 0.25);
  EXPECT_EQ(seen.grasp->reaction_time, 0.04);
}

// Alarm at 0.166 s, and at 1.0004 s again or still: the 0.4 ms after the slip began are not a
// delay.
TEST(Detection, ThatIsEarlyHasNoDelay) {
  constexpr double never = std::numeric_limits<double>::quiet_NaN();
  for (const double later : {1.0004, never}) {
    const TrialOutcome early = judged(0.166, later, true);
    EXPECT_EQ(early.detection, Detection::early);
    EXPECT_TRUE(std::isnan(early.detection_delay));
    EXPECT_TRUE(std::isnan(early.grasp->reaction_time));
  }
  EXPECT_EQ(judged(0.166, 1.0004, true).detection_time, 1.0004);
}

TEST(Outcome, KeepsWhatBecameOfAGrasp) {
  TrialOutcome outcome;
  outcome.grasp = GraspOutcome{.lifted = true,
                               .lift_height = 0.1 / 3.0,
                               .slip_translation = 1e-3 / 3.0,
                               .slip_rotation = 0.1,
                               .max_grip_force = 7.5,
                               .reaction_time = 0.06};
  const GraspOutcome back = parse_outcome(outcome_json(outcome)).grasp.value();
  EXPECT_FALSE(back.dropped);
  EXPECT_TRUE(std::isnan(back.drop_time));
  EXPECT_EQ(back.lifted, true);
  EXPECT_EQ(back.lift_height, 0.1 / 3.0);
  EXPECT_EQ(back.slip_translation, 1e-3 / 3.0);
  EXPECT_EQ(back.slip_rotation, 0.1);
  EXPECT_EQ(back.max_grip_force, 7.5);
  EXPECT_EQ(back.final_grip_force, 0.0);
  EXPECT_TRUE(std::isnan(back.ideal_grip_force));
  EXPECT_EQ(back.reaction_time, 0.06);
}

// Held, dropped and not lifted are different outcomes. If nothing is stored about the lift, as in
// datasets of version 0.2.0, a box that is not dropped is held.
TEST(Outcome, IsHeldDroppedOrNotLifted) {
  const auto ended = [](bool dropped, std::optional<bool> lifted) {
    const GraspOutcome grasp{.dropped = dropped, .lifted = lifted};
    EXPECT_EQ(grasp.held() + grasp.dropped + grasp.not_lifted(), 1);
    return grasp.held() ? "held" : grasp.dropped ? "dropped" : "not lifted";
  };
  EXPECT_STREQ(ended(false, true), "held");
  EXPECT_STREQ(ended(true, true), "dropped");
  EXPECT_STREQ(ended(false, false), "not lifted");
  EXPECT_STREQ(ended(true, false), "dropped");
  EXPECT_STREQ(ended(false, std::nullopt), "held");
  EXPECT_STREQ(ended(true, std::nullopt), "dropped");
  TrialOutcome outcome;
  outcome.grasp.emplace();
  Json before = Json::parse(outcome_json(outcome));
  before.erase("lifted");
  before.erase("lift_height_m");
  const GraspOutcome old = parse_outcome(before.dump()).grasp.value();
  EXPECT_FALSE(old.lifted.has_value());
  EXPECT_TRUE(std::isnan(old.lift_height));
}

TEST(Outcome, TellsHowTheBoxStoodOnlyWhereTheArmIsGuided) {
  TrialOutcome outcome;
  outcome.grasp = GraspOutcome{};
  EXPECT_EQ(outcome_json(outcome).find("standing"), std::string::npos);
  EXPECT_FALSE(parse_outcome(outcome_json(outcome)).grasp->turn.has_value());
  outcome.grasp->turn = {.tilt = 0.1 / 3.0, .least_tilt = 1e-3, .standing = true};
  const TurnOutcome back = parse_outcome(outcome_json(outcome)).grasp->turn.value();
  EXPECT_EQ(back.tilt, 0.1 / 3.0);
  EXPECT_EQ(back.least_tilt, 1e-3);
  EXPECT_TRUE(back.standing);
}

TEST(Outcome, TellsOfAConverterOnlyWhereItCutValuesOff) {
  TrialOutcome outcome;
  EXPECT_EQ(outcome_json(outcome).find("saturated"), std::string::npos);
  EXPECT_TRUE(parse_outcome(outcome_json(outcome)).saturated.empty());
  outcome.saturated = {{"left", 12}, {"right", 1}};
  EXPECT_EQ(parse_outcome(outcome_json(outcome)).saturated, outcome.saturated);
}

// Datasets of versions without detectors.
TEST(Outcome, NeedsNoDetector) {
  const TrialOutcome outcome = parse_outcome(
      R"({"touch_time_s":0.5,"first_micro_slip_time_s":null,"first_slip_time_s":null,"gross_slip_time_s":null,"max_slip_distance_m":0})");
  EXPECT_EQ(outcome.touch_time, 0.5);
  EXPECT_TRUE(std::isnan(outcome.detection_delay));
}

TEST(Outcome, KeepsTheKeysOfAGraspAsNull) {
  const std::string json = outcome_json({});
  for (const char* key : {"dropped", "lifted", "drop_time_s", "lift_height_m", "slip_translation_m", "slip_rotation_rad",
                          "max_grip_force_N", "final_grip_force_N", "ideal_grip_force_N", "reaction_time_s"}) {
    EXPECT_THAT(json, HasSubstr('"' + std::string(key) + "\":null"));
  }
  EXPECT_FALSE(parse_outcome(json).grasp.has_value());
}

TEST(Outcome, RefusesOtherText) {
  EXPECT_THROW(parse_outcome("{"), InputError);
  EXPECT_THROW(parse_outcome("[]"), InputError);
  EXPECT_THROW(parse_outcome("{}"), InputError);
}

TEST(FileNames, NumberShardsBeforeTheExtension) {
  EXPECT_EQ(shard_path("a/out.h5", 0), "a/out.h5");
  EXPECT_EQ(shard_path("a/out.h5", 1), "a/out-0001.h5");
  EXPECT_EQ(shard_path("a/out.h5", 12345), "a/out-12345.h5");
  EXPECT_EQ(shard_path("out", 2), "out-0002");
  EXPECT_EQ(temporary_path("a/out.h5"), "a/out.h5.partial");
}

std::vector<std::pair<std::size_t, std::string>> trials_of(std::size_t count, const std::vector<std::string>& materials) {
  std::vector<std::pair<std::size_t, std::string>> trials;
  for (std::size_t i = 0; i < count; ++i) trials.emplace_back(i, materials[i % materials.size()]);
  return trials;
}

TEST(Masks, SplitOneMaterialByTrial) {
  const Masks masks = split_trials(trials_of(200, {"acrylic"}), 7);
  EXPECT_EQ(masks.split_by, "trial");
  // 15 % of 200 is 30, for each of two parts.
  EXPECT_EQ(masks.train.size(), 140U);
  EXPECT_EQ(masks.valid.size(), 30U);
  EXPECT_EQ(masks.test.size(), 30U);
  std::vector<std::size_t> all = masks.train;
  all.insert(all.end(), masks.valid.begin(), masks.valid.end());
  all.insert(all.end(), masks.test.begin(), masks.test.end());
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], i);
}

TEST(Masks, NeverCutAMaterialInTwo) {
  const std::vector<std::string> materials{"acrylic", "felt", "glass", "paper", "ptfe", "rubber"};
  const Masks masks = split_trials(trials_of(60, materials), 7);
  EXPECT_EQ(masks.split_by, "material");
  std::vector<int> parts_of_material(materials.size(), 0);
  int part = 1;
  for (const auto* members : {&masks.train, &masks.valid, &masks.test}) {
    for (const std::size_t trial : *members) parts_of_material[trial % materials.size()] |= part;
    part *= 2;
  }
  for (const int parts : parts_of_material) EXPECT_TRUE(parts == 1 || parts == 2 || parts == 4) << parts;
  // 15 % of 6 materials rounds to 1 material of 10 trials.
  EXPECT_EQ(masks.valid.size(), 10U);
  EXPECT_EQ(masks.test.size(), 10U);
}

// 10 groups: 20 % are 2, 0 % are 0.
TEST(Masks, FollowTheScenesRule) {
  const std::vector<std::string> speeds{"1", "2", "3", "4", "5", "6", "7", "8", "9", "10"};
  const Masks masks = split_trials(trials_of(30, speeds), 7, SplitRule{"speed", {0.8, 0.0, 0.2}});
  EXPECT_EQ(masks.split_by, "speed");
  EXPECT_EQ(masks.rule, "80/0/20 % of the speeds, shuffled by the seed, as the scene says; no speed is in two parts");
  EXPECT_EQ(masks.train.size(), 24U);
  EXPECT_EQ(masks.valid.size(), 0U);
  EXPECT_EQ(masks.test.size(), 6U);
  for (const std::size_t trial : masks.test) {
    EXPECT_EQ(std::ranges::count_if(masks.test, [&](std::size_t other) { return other % 10 == trial % 10; }), 3);
  }
  // Each trial by itself, whatever the name of its group.
  const Masks single = split_trials(trials_of(10, {"a", "b"}), 7, SplitRule{"trial", {0.5, 0.3, 0.2}});
  EXPECT_EQ(single.train.size(), 5U);
  EXPECT_EQ(single.valid.size(), 3U);
  EXPECT_EQ(single.test.size(), 2U);
  // A single group is for training.
  EXPECT_EQ(split_trials(trials_of(9, {"a"}), 7, SplitRule{"material", {0.7, 0.15, 0.15}}).train.size(), 9U);
}

// Files of scenes without a `split` stay bit-identical.
TEST(Masks, WithoutARuleAreAsEver) {
  const std::vector<std::string> materials{"acrylic", "felt", "glass", "paper", "ptfe", "rubber", "steel"};
  const Masks own = split_trials(trials_of(70, materials), 7),
              ruled = split_trials(trials_of(70, materials), 7, SplitRule{"material", {0.7, 0.15, 0.15}});
  EXPECT_EQ(own.rule, "70/15/15 % of the materials, shuffled by the seed; no material is in two parts");
  EXPECT_EQ(own.test, ruled.test);
  EXPECT_EQ(own.valid, ruled.valid);
  EXPECT_EQ(split_trials(trials_of(4, {"a"}), 7).rule,
            "70/15/15 % of the trials, shuffled by the seed, since all share one material");
}

// 12 experiments of 3 repeats, interleaved: 15 % of 12 rounds to 2 experiments, which are 6 trials.
TEST(Masks, KeepRepeatsOfOneExperimentTogether) {
  std::vector<std::pair<std::size_t, std::string>> trials;
  for (std::size_t i = 0; i < 36; ++i) trials.emplace_back(i, split_group_text("acrylic", {"speed " + std::to_string(i % 12)}));
  for (const auto& rule : {std::optional<SplitRule>{}, std::optional{SplitRule{"trial", {0.7, 0.15, 0.15}}}}) {
    const Masks masks = split_trials(trials, 7, rule);
    EXPECT_EQ(masks.split_by, "trial");
    EXPECT_EQ(masks.groups, 12U);
    EXPECT_THAT(masks.rule, ::testing::HasSubstr("repeats of one experiment are in one part"));
    EXPECT_EQ(masks.valid.size(), 6U);
    EXPECT_EQ(masks.test.size(), 6U);
    for (const auto* part : {&masks.train, &masks.valid, &masks.test}) {
      for (const std::size_t trial : *part) {
        EXPECT_EQ(std::ranges::count_if(*part, [&](std::size_t other) { return other % 12 == trial % 12; }), 3);
      }
    }
  }
}

// Trials 0 and 1 share a digest, 1 and 2 their swept values: one experiment, that of trial 0.
TEST(Masks, ExperimentsShareKeysByOtherTrials) {
  std::vector<std::pair<std::size_t, std::string>> trials = trials_of(20, {"acrylic"});
  trials[0].second = split_group_text("acrylic", {"truth a"});
  trials[1].second = split_group_text("acrylic", {"truth a", "speed 1"});
  trials[2].second = split_group_text("acrylic", {"truth b", "speed 1"});
  const Masks masks = split_trials(trials, 7);
  EXPECT_EQ(masks.groups, 18U);
  for (const auto* part : {&masks.train, &masks.valid, &masks.test}) {
    const auto held = std::ranges::count_if(*part, [](std::size_t trial) { return trial < 3; });
    EXPECT_TRUE(held == 0 || held == 3) << held;
  }
}

// Trials without repeats are divided as if they had no experiment: datasets of drawn trials keep
// their split.
TEST(Masks, ExperimentsOfOneTrialAreDividedAsTrials) {
  std::vector<std::pair<std::size_t, std::string>> trials;
  for (std::size_t i = 0; i < 40; ++i) trials.emplace_back(i, split_group_text("acrylic", {std::to_string((7 * i) % 40)}));
  const Masks masks = split_trials(trials, 7), plain = split_trials(trials_of(40, {"acrylic"}), 7);
  EXPECT_EQ(masks.test, plain.test);
  EXPECT_EQ(masks.valid, plain.valid);
  EXPECT_EQ(masks.rule, plain.rule);
}

// A material is in one part whatever its experiments are.
TEST(Masks, AMaterialHoldsItsExperiments) {
  std::vector<std::pair<std::size_t, std::string>> trials;
  for (std::size_t i = 0; i < 60; ++i)
    trials.emplace_back(i, split_group_text(std::string(1, static_cast<char>('a' + i % 6)), {std::to_string(i)}));
  const Masks masks = split_trials(trials, 7);
  EXPECT_EQ(masks.split_by, "material");
  EXPECT_EQ(masks.test.size(), 10U);  // one of six materials
}

TEST(Masks, AreShuffledByTheSeedAlone) {
  const auto trials = trials_of(200, {"acrylic"});
  EXPECT_EQ(split_trials(trials, 7).test, split_trials(trials, 7).test);
  EXPECT_NE(split_trials(trials, 7).test, split_trials(trials, 8).test);
}

TEST(Masks, ServeFewTrials) {
  EXPECT_EQ(split_trials({}, 7).train.size(), 0U);
  EXPECT_EQ(split_trials(trials_of(1, {"a"}), 7).train.size(), 1U);
  const Masks two = split_trials(trials_of(2, {"a"}), 7);
  EXPECT_EQ(two.train.size() + two.test.size(), 2U);
  EXPECT_EQ(two.test.size(), 1U);
  const Masks three = split_trials(trials_of(3, {"a"}), 7);
  EXPECT_EQ(three.train.size(), 1U);
  EXPECT_EQ(three.valid.size(), 1U);
}

}  // namespace
}  // namespace slipbench::testing

// Verdicts on a pad that is moved sideways: at a speed it slips from the start, without speed it
// never slips.

#include <filesystem>
#include <fstream>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"
#include "tools/check/check.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench {
namespace {

const std::string head =
    "slipbench: 1\n"
    "duration: 0.6 s\n"
    "motion: {compression: 1 mm, approach_speed: 50 mm/s, start: 0.3 s, speed: 20 mm/s, acceleration: inf}\n"
    "sensors: {pad: {type: papillarray}}\n";

struct CheckScene : testing::Test {
  SceneCheck check(const std::string& text, CheckOptions options = {}) const {
    static const Catalogues catalogues = program_catalogues();
    std::ofstream(folder_ / "s.yaml") << head << text;
    options.scene_path = folder_ / "s.yaml";
    return check_scene(options, catalogues);
  }

  std::string refusal(const std::string& text, const CheckOptions& options = {}) const {
    const std::string message = refusal_of([&] { check(text, options); });
    return message.substr(message.find_last_of('/') + 1);
  }

  TemporaryFolder folder_;
};

TEST_F(CheckScene, WithoutExpectationsIsNotChecked) {
  EXPECT_EQ(check("").verdict, Verdict::not_checked);
  EXPECT_EQ(check("expect: {}\n").verdict, Verdict::not_checked);
  EXPECT_EQ(check("expect: {confidence: 0.9}\n").verdict, Verdict::not_checked);
}

// The only trial runs and fails; the run that should save its dataset is interrupted.
TEST_F(CheckScene, InterruptedIsNoVerdict) {
  std::ofstream(folder_ / "s.yaml") << head << "expect: {gross_slip_by: 0.3 s}\n";
  std::atomic<bool> interrupt{false};
  CheckOptions options{.scene_path = folder_ / "s.yaml", .folder = folder_ / "left", .interrupt = &interrupt};
  EXPECT_THROW(check_scene(options, program_catalogues(), [&](const SweepProgress&) { interrupt = true; }), Interrupted);
}

TEST_F(CheckScene, PassesAndFailsByItsLimit) {
  // From 0.3 s on the pillar tips stick for mu f_n/(k_t v), far less than 0.3 s.
  EXPECT_EQ(check("expect: {gross_slip_by: 0.6 s, no_slip_before: 0.3 s, max_unit_slip: 6 mm}\n").verdict, Verdict::passed);
  const SceneCheck late = check("expect: {gross_slip_by: 0.3 s, no_slip_before: 0.3 s}\n");
  EXPECT_EQ(late.verdict, Verdict::failed);
  EXPECT_FALSE(late.expectations[0].passed());
  EXPECT_TRUE(late.expectations[1].passed());
  EXPECT_EQ(late.expectations[0].limit, "at most 0.3 s");
  EXPECT_THAT(late.files, IsEmpty());  // no folder was given
}

TEST_F(CheckScene, WhatNeverHappensFailsByItsRule) {
  const SceneCheck still =
      check("expect: {gross_slip_by: 0.6 s, no_slip_before: 0.6 s}\n", {.overrides = {{"motion.speed", "0"}}});
  EXPECT_EQ(still.expectations[0].worst_text, "never");
  EXPECT_FALSE(still.expectations[0].passed());
  EXPECT_TRUE(still.expectations[1].passed());
}

// The ratio of tangential to normal force grows from 0 to mu while the pad sticks, so it exceeds a
// tenth of mu long before slip, and the alarm is on when slip begins. The oracle detects slip at
// the next sample, within 1 ms.
TEST_F(CheckScene, AnEarlyAlarmHasNoDelayToKeep) {
  const std::string delay = "friction: {static: 0.5, kinetic: 0.5}\nexpect: {max_detection_delay: 1.5 ms}\n";
  const SceneCheck early = check("detector: {type: force_ratio, ratio: 0.05}\n" + delay);
  EXPECT_EQ(early.verdict, Verdict::failed);
  EXPECT_EQ(early.expectations[0].worst_text, "no delay");
  ASSERT_EQ(early.detectors.size(), 1U);
  EXPECT_EQ(early.detectors[0].early, 1U);
  EXPECT_THAT(early.detectors[0].delays, IsEmpty());
  const SceneCheck seen = check("detector: {type: truth}\n" + delay);
  EXPECT_EQ(seen.verdict, Verdict::passed);
  EXPECT_EQ(seen.detectors[0].seen(), 1U);
}

TEST_F(CheckScene, KOfN) {
  // 9 of 12 trials move.
  const std::string speeds = "sweep: {motion.speed: [20 mm/s, 0 mm/s, 21 mm/s, 22 mm/s], trials: 3}\n";
  const auto verdict = [&](const std::string& rule) {
    return check(speeds + "expect: {gross_slip_by: {limit: 0.6 s, " + rule + "}}\n");
  };
  const SceneCheck edge = verdict("pass: 0.75");
  EXPECT_EQ(edge.verdict, Verdict::passed);
  EXPECT_EQ(edge.expectations[0].kept, 9U);
  EXPECT_EQ(edge.expectations[0].needed, 9U);
  EXPECT_EQ(edge.expectations[0].trials, 12U);
  EXPECT_EQ(edge.expectations[0].worst.trial, 3U);  // the first of the second cell
  const SceneCheck beyond = verdict("pass: 0.751");
  EXPECT_EQ(beyond.verdict, Verdict::failed);
  EXPECT_EQ(beyond.expectations[0].needed, 10U);
  // 3 of 4 also with one draw: the share is the same, the count is not.
  EXPECT_EQ(check(speeds + "expect: {gross_slip_by: {limit: 0.6 s, pass: 0.75}}\n", {.trials = 1}).expectations[0].needed, 3U);
}

TEST_F(CheckScene, Reliability) {
  // All of 6 trials pass: the 80 % interval begins at 0.1^(1/6) = 0.6813.
  const std::string six = "sweep: {trials: 6}\nexpect:\n  confidence: 0.8\n";
  EXPECT_EQ(check(six + "  gross_slip_by: {limit: 0.6 s, reliability: 0.681}\n").verdict, Verdict::passed);
  EXPECT_THAT(refusal(six + "  gross_slip_by: {limit: 0.6 s, reliability: 0.682}\n"),
              refused_at("s.yaml:8", {"expect.gross_slip_by.reliability", "0.682", "6 trials", "80 %", "0.6813"}));
}

TEST_F(CheckScene, OutcomeDependsOnNeitherJobsNorOrder) {
  const std::string drawn =
      "sweep: {motion.speed: {draw: uniform, min: 1 mm/s, max: 30 mm/s}, trials: 12}\nexpect: {gross_slip_by: 0.4 s}\n";
  const SceneCheck one = check(drawn, {.jobs = 1});
  const SceneCheck three = check(drawn, {.jobs = 3});
  EXPECT_EQ(one.expectations[0].kept, three.expectations[0].kept);
  EXPECT_EQ(one.expectations[0].worst.trial, three.expectations[0].worst.trial);
  EXPECT_EQ(one.expectations[0].median, three.expectations[0].median);
}

// A start before the pad is down is refused when the trial is made: refusals by the bench count as
// failures.
TEST_F(CheckScene, TrialsThatCannotRunAreNotKept) {
  const std::string starts = "sweep: {motion.start: {draw: choice, values: [1 ms, 0.3 s]}, trials: 16}\nseed: 1\n";
  const SceneCheck check_of = check(starts + "expect: {no_slip_before: {limit: 0.3 s, pass: 0.01}, max_unit_slip: 1 m}\n");
  const std::size_t refused = check_of.failures.size();
  ASSERT_GT(refused, 0U);
  ASSERT_LT(refused, 16U);
  EXPECT_THAT(check_of.failures.front(), HasSubstr("motion.start"));
  for (const ExpectationResult& result : check_of.expectations) {
    EXPECT_EQ(result.kept, 16U - refused);
    EXPECT_EQ(result.worst_text, "failed to run");
  }
  EXPECT_TRUE(check_of.expectations[0].passed());
  EXPECT_FALSE(check_of.expectations[1].passed());
  EXPECT_EQ(check_of.verdict, Verdict::failed);
}

TEST_F(CheckScene, LeavesTheTrialThatFailsMost) {
  // No pad slips fully within 5 ms of the start: a pillar pressed 1 mm deep sticks for far more
  // than 5 ms at 40 mm/s. Only trial 2 is dragged by more than 8 mm: 12 mm; the others by less than
  // 6 mm.
  const SceneCheck failed =
      check("sweep: {motion.speed: [20 mm/s, 0 mm/s, 40 mm/s]}\nexpect: {gross_slip_by: 0.305 s, max_unit_slip: 8 mm}\n",
            {.folder = folder_ / "left"});
  EXPECT_EQ(failed.replayed, 2U);
  EXPECT_THAT(failed.files, ElementsAre(folder_ / "left/trial_2.h5", folder_ / "left/trial_2.html"));
  for (const std::string& file : failed.files) EXPECT_TRUE(std::filesystem::exists(file)) << file;
  EXPECT_EQ(failed.expectations[0].worst.trial, 1U);  // never
  EXPECT_EQ(failed.expectations[1].worst.trial, 2U);
}

TEST_F(CheckScene, Refusals) {
  EXPECT_THAT(refusal("expect: {max_slip: 3 mm}\n"), refused_at("s.yaml:5", {"max_slip", "gripper"}));
  EXPECT_THAT(refusal("expect: {false_alarm: false}\n"), refused_at("s.yaml:5", {"false_alarm", "detector"}));
  EXPECT_THAT(refusal("expect: {gross_slip_bye: 1 s}\n"), mentions({"s.yaml:5", "gross_slip_bye", "expect", "gross_slip_by"}));
  EXPECT_THAT(refusal("expect: {gross_slip_by: 1 mm}\n"), refused_at("s.yaml:5", {"expect.gross_slip_by", "1 mm", "time", "ms"}));
  EXPECT_THAT(refusal("expect: {gross_slip_by: {pass: 0.9}}\n"), refused_at("s.yaml:5", {"limit", "expect.gross_slip_by"}));
  EXPECT_THAT(refusal("expect: {gross_slip_by: {limit: 1 s, pass: 1.5}}\n"),
              refused_at("s.yaml:5", {"expect.gross_slip_by.pass", "1.5", "1"}));
  EXPECT_THAT(refusal("expect: {control: hold_preset}\n"), refused_at("s.yaml:5", {"expect.control", "controller"}));
  EXPECT_THAT(refusal("sweep: {expect.gross_slip_by: [1 s, 2 s]}\n"), refused_at("s.yaml:5", {"expect.gross_slip_by", "swept"}));
}

// A scene with an unusual name, a failed expectation and a passed one; and a second scene that
// tests nothing.
std::vector<SceneCheck> checks() {
  ExpectationResult failed;
  failed.name = "max_slip";
  failed.limit = "at most 3 mm";
  failed.kept = 18;
  failed.trials = failed.needed = 20;
  failed.worst = {7, 4.1e-3};
  failed.worst_text = "4.1 mm";
  failed.replay = "slipbench run 'a&b<\">.yaml' --set 'description=]]>' --seed 1 --trial 7";
  failed.control_kept = 0;
  ExpectationResult kept = failed;
  kept.name = "dropped";
  kept.kept = 20;
  SceneCheck first;
  first.scene_path = "a&b<\"'>\t\x01.yaml";
  first.control = "hold_preset";
  first.verdict = Verdict::failed;
  first.expectations = {failed, kept};
  first.failures = {"trial 3: <unstable>"};
  first.files = {"left/trial_7.h5"};
  SceneCheck second = first;
  second.scene_path = "second.yaml";
  second.verdict = Verdict::tests_nothing;
  second.expectations = {kept};
  SceneCheck third;
  third.scene_path = "third.yaml";
  return {first, second, third};
}

TEST(JUnit, IsReadAsItWasMeant) {
  const TemporaryFolder folder;
  std::ofstream(folder / "j.xml") << junit_xml(checks());
  std::ofstream(folder / "read.py") << R"(
import xml.etree.ElementTree as tree
root = tree.parse('j.xml').getroot()
print(root.tag, [root.get(key) for key in ('tests', 'failures', 'errors', 'skipped')])
for suite in root:
    print(suite.tag, repr(suite.get('name')), [suite.get(key) for key in ('tests', 'failures', 'errors', 'skipped')])
    for case in suite:
        print(' ', case.tag, case.get('name'), case.get('classname') == suite.get('name'))
        for part in case:
            print('   ', part.tag, part.get('type'), part.get('message'))
            print(part.text)
)";
  const ChildResult read = run_shell("python3 read.py", folder / "");
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_EQ(read.out, R"x(testsuites ['6', '2', '0', '1']
testsuite 'a&b<"\'>\t\\x01.yaml' ['3', '1', '0', '0']
  testcase max_slip True
    failure expectation max_slip: at most 3 mm in 18 of 20 trials, needed in 20; worst: 4.1 mm in trial 7
max_slip: at most 3 mm in 18 of 20 trials, needed in 20; worst: 4.1 mm in trial 7
replay: slipbench run 'a&b<">.yaml' --set 'description=]]>' --seed 1 --trial 7
trial 3: <unstable>
file: left/trial_7.h5
  testcase dropped True
  testcase negative_control True
testsuite 'second.yaml' ['2', '1', '0', '0']
  testcase dropped True
  testcase negative_control True
    failure expectation tests nothing
tests nothing: the negative control, controller hold_preset, also meets all expectations; use a heavier box, a smoother surface or a lower preset
testsuite 'third.yaml' ['1', '0', '0', '1']
  testcase expect True
    skipped None the scene has no expectations
None
)x");
}

}  // namespace

}  // namespace slipbench

// Grasps as whole trials: the recorded loop, and the trial's outcome.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/api/motion.h"
#include "sim/motion/motion_catalogue.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/run_trial.h"

namespace slipbench::testing {
namespace {

// Without scatter, so that a trial has its nominal values.
Scene grasp_scene(const std::string& more, const std::string& mass = "0.2 kg") {
  return parsed("slipbench: 1\nsurface: {material: ptfe}\nbox: {mass: " + mass +
                "}\nduration: 5 s\nsensors: {pad: {type: papillarray, rate: 100 Hz}}\n" + more);
}

constexpr const char* stepping = "detector: {type: force_ratio, ratio: 0.25}\ncontroller: {type: step_on_slip}\n";

TEST(Grasp, OutcomeDoesNotDependOnWhatIsRecorded) {
  const Scene scene = grasp_scene(stepping);
  const TrialRecord full = run_trial(scene, 0, Recording::full).record;
  EXPECT_EQ(outcome_json(full.outcome), outcome_json(run_trial(scene, 0, Recording::outcome).record.outcome));
}

TEST(Grasp, RecordsWhatWasWrittenReadAndPressed) {
  const TrialRecord record = run_trial(grasp_scene(stepping), 0, Recording::full).record;
  const ControlRecord& control = record.control.value();
  EXPECT_EQ(control.detector, "force_ratio");
  EXPECT_EQ(control.controller, "step_on_slip");
  EXPECT_EQ(control.sensor, "pad");
  const std::size_t rows = control.time.size();
  EXPECT_EQ(rows, 500U);
  ASSERT_EQ(control.grip.command.size(), 3 * rows);
  ASSERT_EQ(control.grip.measured_position.size(), rows);
  ASSERT_EQ(control.grip.grip_force.size(), rows);
  // The fingers rest before the first write, then close.
  EXPECT_EQ(control.grip.command[0], control.grip.measured_position[0]);
  EXPECT_GT(control.grip.measured_position.back(), control.grip.measured_position.front());
  // The measured position follows the written one at most the published three periods (60 ms)
  // later.
  for (std::size_t row = 6; row < rows; ++row) {
    std::uint8_t least = 255, most = 0;
    for (std::size_t back = 0; back <= 6; ++back) {
      least = std::min(least, control.grip.command[3 * (row - back)]);
      most = std::max(most, control.grip.command[3 * (row - back)]);
    }
    EXPECT_GE(control.grip.measured_position[row] + 1, least) << row;
    EXPECT_LE(control.grip.measured_position[row], most) << row;
  }
  // The true force of both pads against the ideal sensor's sum while the box hangs still: both pads
  // carry equal loads.
  const SensorColumn& force = record.sensors.front().channels.front();
  double felt = 0.0;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) felt += force.values[force.values.size() - 27 + 3 * pillar + 2];
  EXPECT_NEAR(control.grip.grip_force.back(), felt, 1e-3 * felt);
  const GraspOutcome& grasp = record.outcome.grasp.value();
  EXPECT_GE(grasp.max_grip_force, *std::ranges::max_element(control.grip.grip_force));
  EXPECT_NEAR(grasp.final_grip_force, control.grip.grip_force.back(), 1e-3 * felt);
  EXPECT_NEAR(grasp.ideal_grip_force, 0.2 * 9.81 / (2.0 * 0.35), 1e-9);  // m g/(2 mu_s), ptfe
}

TEST(Grasp, WithoutAControllerTheFingersStayAndTheBoxIsLeftBehind) {
  const Scene scene = grasp_scene("grip: {}\n");
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  EXPECT_FALSE(record.control.has_value());
  const GraspOutcome& grasp = record.outcome.grasp.value();
  EXPECT_EQ(grasp.lifted, false);
  EXPECT_EQ(grasp.lift_height, 0.0);
  EXPECT_TRUE(grasp.not_lifted());
  EXPECT_FALSE(grasp.dropped) << "it has never been higher";
  EXPECT_TRUE(std::isnan(grasp.drop_time));
  EXPECT_TRUE(std::isnan(grasp.slip_translation));
  EXPECT_EQ(grasp.max_grip_force, 0.0);
}

// 3 kg need m g/(2 mu_s) = 42 N, but the controller stays at 4 N: the arm rises, and the box stays.
TEST(Grasp, BoxThatIsTooHeavyIsNotLiftedAndKeepsNoExpectation) {
  const TrialOutcome outcome =
      run_trial(grasp_scene("controller: {type: hold_preset}\n", "3 kg"), 0, Recording::outcome).record.outcome;
  EXPECT_TRUE(outcome.grasp->not_lifted());
  EXPECT_FALSE(outcome.grasp->held());
  for (const ExpectationKind& kind : expectation_catalogue()) {
    if (kind.about.name == "lifted") {
      EXPECT_TRUE(kind.kept(kind.observed(outcome), 0.0));
      EXPECT_FALSE(kind.kept(kind.observed(outcome), 1.0));
    } else if (kind.about.name == "dropped") {
      for (const double dropped : {0.0, 1.0}) EXPECT_FALSE(kind.kept(kind.observed(outcome), dropped)) << dropped;
    } else if (kind.about.name == "max_slip" || kind.about.name == "max_rotation") {
      EXPECT_FALSE(kind.kept(kind.observed(outcome), 1e3)) << kind.about.name;
    }
  }
}

TEST(Grasp, HeldBoxWasLiftedAsFarAsTheArmLessTheGiveOfFingersAndPads) {
  const GraspOutcome grasp = run_trial(grasp_scene(stepping), 0, Recording::outcome).record.outcome.grasp.value();
  EXPECT_TRUE(grasp.held());
  EXPECT_EQ(grasp.lifted, true);
  // 100 mm, minus the slip, and minus the tilt of a box of 60 mm turned by slip_rotation: 30 mm
  // times its sine.
  EXPECT_LT(grasp.lift_height, 0.1);
  EXPECT_GT(grasp.lift_height, 0.1 - grasp.slip_translation - 0.045 * std::sin(grasp.slip_rotation) - 0.2e-3);
}

// 1.5 s, 300 mm at 43 mm/s, and half a ramp of 43/400 s at either end: 8.5842 s.
TEST(Grasp, LiftThatTheTrialDoesNotSeeEndIsRefused) {
  const std::string head = "slipbench: 1\nsensors: {pad: {type: papillarray}}\ngrip: {}\n";
  const auto refusal = [](const std::string& text, const std::vector<Override>& changes = {}) {
    return refusal_of([&] {
      SceneFile file = SceneFile::from_text(text, "scene.yaml");
      for (const Override& change : changes) file.apply(change);
      static_cast<void>(TrialPlan(file, catalogues(), 0, 1));
    });
  };
  const auto too_long = refused_at("scene.yaml:4", {"motion", "8.585 s", "5 s"});
  EXPECT_THAT(refusal(head + "motion: {distance: 300 mm}\n"), too_long);
  EXPECT_THAT(refusal(head + "motion: {kind: lift}\n", {{"motion.distance", "300 mm"}}), too_long);
  EXPECT_THAT(refusal(head + "motion: {}\nsweep: {motion.distance: [100 mm, 300 mm]}\n"), too_long);
  EXPECT_EQ(refusal(head + "sweep: {motion.distance: {draw: uniform, min: 299 mm, max: 300 mm}}\n"), "accepted")
      << "the trial's end judges what is drawn";
  EXPECT_THAT(refusal(head, {{"duration", "2 s"}}), mentions({"3.934 s", "2 s"}));
  EXPECT_EQ(refusal(head + "duration: 8.585 s\nmotion: {distance: 300 mm}\n"), "accepted");
}

TEST(Grasp, NeedsNoDetector) {
  const TrialRecord record = run_trial(grasp_scene("controller: {type: constant_force}\n"), 0, Recording::full).record;
  const ControlRecord& control = record.control.value();
  EXPECT_EQ(control.detector, "");
  EXPECT_EQ(control.controller, "constant_force");
  EXPECT_THAT(control.detector_class, Each(0));
  EXPECT_TRUE(std::isnan(record.outcome.detection_time));
  EXPECT_TRUE(std::isnan(accuracy(control.confusion)));
}

// Boxes that need 7 to 9 N, taken with 4 N. A count is worth at most 1.6 N, so a controller that
// stays at the preset drops them; one that uses the oracle, or a ratio below the true friction,
// does not.
TEST(Grasp, EveryControllerWithTheOracleOnThreeSurfaces) {
  struct Surface {
    std::string scene;
    double mu;  // upwards
    double mass;
  };
  const Surface surfaces[] = {
      {"surface: {material: ptfe}\nbox: {mass: 0.5 kg}\n", 0.35, 0.5},
      {"surface: {material: rubber}\nbox: {mass: 1.45 kg, table_friction: 0.1}\n", 1.0, 1.45},
      {"surface: {material: felt}\nbox: {mass: 0.5 kg}\neffects: [{anisotropic_friction: {ratio: 0.6}}]\n", 0.45 * 0.6, 0.5},
  };
  for (const Surface& surface : surfaces) {
    const auto held = [&](const std::string& controller) {
      const Scene scene = parsed("slipbench: 1\nsensors: {pad: {type: papillarray, rate: 100 Hz}}\n" + surface.scene +
                                 "detector: {type: truth}\ncontroller: {type: " + controller + "}\n");
      const GraspOutcome grasp = run_trial(scene, 0, Recording::outcome).record.outcome.grasp.value();
      EXPECT_NEAR(grasp.ideal_grip_force, surface.mass * 9.81 / (2.0 * surface.mu), 1e-9) << controller;
      if (grasp.held()) {
        EXPECT_GT(grasp.final_grip_force, 0.99 * grasp.ideal_grip_force) << controller;
      }
      return grasp.held();
    };
    for (const char* controller : {"constant_force", "hold_preset"}) {
      EXPECT_FALSE(held(controller)) << controller << " " << surface.scene;
    }
    for (const std::string& controller : {std::string("step_on_slip"), fmt::format("force_ratio, mu: {}", surface.mu)}) {
      EXPECT_TRUE(held(controller)) << controller << " " << surface.scene;
    }
  }
}

// Slip at t is sampled within 10 ms, read within 20 ms, written 10 ms later and acts after another
// 20 ms: at least 30 ms, at most 60 ms and a tick.
TEST(Grasp, OracleIsAnsweredAfterTheLoopsDelays) {
  for (const double phase : {0.0, 3e-3, 11e-3, 19e-3}) {
    const TrialRecord record =
        run_trial(
            grasp_scene(
                fmt::format("grip: {{phase: {} s}}\ndetector: {{type: truth}}\ncontroller: {{type: step_on_slip}}\n", phase),
                "0.5 kg"),
            0, Recording::outcome)
            .record;
    EXPECT_GE(record.outcome.grasp->reaction_time, 30e-3 - 1e-9) << phase;
    EXPECT_LE(record.outcome.grasp->reaction_time, 60e-3 + 3e-4) << phase;
  }
}

// The preset force does not hold this box (0.5 kg 9.81 m/s2/(2 0.35) = 7 N), so it slips.
// Controllers that keep a force close by a count now and then, because the pads' force falls as the
// lift loads them; the published loop does so, too, while its detector reports nothing. None of
// this answers the slip.
TEST(Grasp, WhatKeepsAForceDoesNotReact) {
  for (const char* loop : {"detector: {type: truth}\ncontroller: {type: hold_preset}\n",
                           "detector: {type: truth}\ncontroller: {type: constant_force}\n",
                           "detector: {type: truth, latency: 10 s}\ncontroller: {type: step_on_slip}\n"}) {
    const TrialOutcome outcome = run_trial(grasp_scene(loop, "0.5 kg"), 0, Recording::outcome).record.outcome;
    EXPECT_FALSE(std::isnan(outcome.judged_slip_time)) << loop;
    EXPECT_TRUE(std::isnan(outcome.grasp->reaction_time)) << loop << outcome.grasp->reaction_time;
  }
}

// m g/(2 mu_s) with the labels' mu_s, the trial's own: with 10 % scatter no two are alike.
TEST(Grasp, LabelsHoldTheTrialsOwnFriction) {
  const Scene scene = grasp_scene("scatter: {}\ncontroller: {type: constant_force}\n");
  double last = 0.35;  // ptfe's
  for (const std::uint64_t trial : {0U, 1U, 2U}) {
    const TrialRecord record = run_trial(scene, trial, Recording::outcome).record;
    const std::vector<double>& mu = record.sensors.front().labels.mu_static;
    EXPECT_THAT(mu, Each(mu.front()));
    EXPECT_NE(mu.front(), last);
    EXPECT_NEAR(record.outcome.grasp->ideal_grip_force, 0.2 * 9.81 / (2.0 * mu.front()), 1e-9);
    last = mu.front();
  }
}

// The fingers close and the box stands until the lift; the oracle is flipped in 2 % of some hundred
// samples. The loop closes at the first alarm, long before the lift, so neither the loop nor its
// detector has a delay, although the detector sees the slip of the lift.
TEST(Grasp, AnAlarmBeforeTheLiftIsEarly) {
  const Scene scene = grasp_scene("detector: {type: truth, flip: 0.02}\ncontroller: {type: step_on_slip}\n", "0.5 kg");
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  const ControlRecord& control = record.control.value();
  const std::vector<std::uint8_t>& truth = record.sensors.front().labels.state;
  std::size_t first = 0;
  while (control.detector_class[first] < 2) {
    ASSERT_LT(truth[first], 2) << "it slips before any alarm";
    ++first;
  }
  ASSERT_LT(control.time[first], lift_times(scene.motion.parameters).start);
  ASSERT_LT(control.detector_class[first + 1], 2) << "withdrawn";
  EXPECT_NEAR(record.outcome.false_alarm_time, control.time[first], 1e-9);
  EXPECT_FALSE(std::isnan(record.outcome.detection_time));
  EXPECT_EQ(record.outcome.detection, Detection::early);
  EXPECT_TRUE(std::isnan(record.outcome.detection_delay));
  EXPECT_TRUE(std::isnan(record.outcome.grasp->reaction_time));
}

// The box slips and is lost; later motion of the empty fingers is not a reaction, and later reports
// of the detector are not a detection.
TEST(Grasp, NothingIsJudgedAfterTheDrop) {
  // A little more friction holds the box, a little less leaves it on the table: here it rises,
  // slides and falls.
  const Scene scene =
      grasp_scene("friction: {scale: 0.57}\ndetector: {type: truth, latency: 3 s}\ncontroller: {type: hold_preset}\n");
  const TrialOutcome outcome = run_trial(scene, 0, Recording::outcome).record.outcome;
  ASSERT_EQ(outcome.grasp->lifted, true);
  ASSERT_TRUE(outcome.grasp->dropped);
  EXPECT_FALSE(std::isnan(outcome.first_slip_time));
  EXPECT_TRUE(std::isnan(outcome.detection_time)) << outcome.detection_time;
}

TEST(Grasp, RefusesALoopThatCannotBe) {
  const auto refusal = [](const std::string& text) {
    return refusal_of([&] { static_cast<void>(check_trial(grasp_scene(text), 0)); });
  };
  EXPECT_THAT(refusal("controller: {type: step_on_slip}\n"), mentions({"step_on_slip", "detector"}));
  EXPECT_THAT(refusal("grip: {open_at: 240}\n"), mentions({"240", "230"}));
  EXPECT_THAT(
      refusal_of([] { parsed("slipbench: 1\nsensors: {pad: {type: papillarray}}\ncontroller: {type: constant_force}\n"); }),
      mentions({"scene.yaml:3", "controller", "gripper"}));
}

}  // namespace
}  // namespace slipbench::testing

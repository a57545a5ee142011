// The lever bench of the nib pad (scenes/nib_pad) against its springs: checks the statements in the
// scenes' descriptions.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenes.h"
#include "tools/trial/run_trial.h"

namespace slipbench::lever_test {
namespace {

using Overrides = std::vector<Override>;

constexpr double pad_normal = 36 * 0.83e3, rig = 15e3, pad_tangential = 36 * 0.2e3, string = 20e3;  // N/m
constexpr double series = pad_normal * rig / (pad_normal + rig);

// Nibs of equal height on a plate of uniform friction.
const Overrides plain{{"sensors.pad.height_sd", "0 mm"}, {"effects", "[]"}, {"sensors.pad.electronics", "ideal"}};

TrialRecord run(const std::string& scene, const Overrides& changes) {
  SceneFile file = shipped("nib_pad/" + scene, plain);
  file.apply({"sweep", "{}"});
  for (const Override& change : changes) file.apply(change);
  return run_trial(parsed(file), 0, Recording::full).record;
}

std::size_t row_at(const TrialRecord& record, double time) {
  return static_cast<std::size_t>(std::ranges::lower_bound(record.sensors[0].time, time) - record.sensors[0].time.begin());
}

// Sum over all nibs of the true force along `axis` [N].
double force(const TrialRecord& record, double time, std::size_t axis) {
  const LabelRecord& labels = record.sensors[0].labels;
  double sum = 0.0;
  for (std::size_t nib = 0; nib < 36; ++nib) sum += double{labels.force[3 * (row_at(record, time) * 36 + nib) + axis]};
  return sum;
}

double place(const TrialRecord& record, const std::string& body, double time, std::size_t axis) {
  return double{std::ranges::find(record.bodies, body, &BodyRecord::name)->pose[7 * row_at(record, time) + axis]};
}

// The stage's travel is shared by pad and rig: F = c k_pad k_rig/(k_pad + k_rig), 9.99 N/mm; the
// scenes state 10.
TEST(LeverStage, PressesAsHardAsItsScenesSay) {
  for (const auto& [scene, compression, newtons] :
       {std::tuple{"linear.yaml", "0.2 mm", 2.0}, {"linear.yaml", "0.8 mm", 8.0}, {"rotational.yaml", "1.2 mm", 12.0}}) {
    const TrialRecord record = run(scene, {{"motion.compression", compression}, {"duration", "3 s"}});
    EXPECT_NEAR(force(record, 2.99, 2), newtons, 5e-3 * newtons) << scene;
    EXPECT_NEAR(force(record, 2.99, 2), newtons * series / 10e3, 1e-5 * newtons) << scene;
    EXPECT_NEAR(place(record, "plate", 2.99, 2), -newtons / 10e3 * series / rig, 1e-8) << scene;
  }
}

// At rest the pad carries the pull; the plate has moved by pull/(36 k_t), the lever by the string's
// stretch more.
TEST(LeverStage, StuckPadBearsThePullOnItsSprings) {
  const TrialRecord record =
      run("linear.yaml", {{"motion.compression", "0.8 mm"}, {"controls.pull", "[[3 s, 0 N], [4 s, 2 N]]"}, {"duration", "6 s"}});
  EXPECT_NEAR(force(record, 5.99, 1), 2.0, 1e-4);
  EXPECT_NEAR(force(record, 5.99, 0), 0.0, 1e-6);
  const double plate = place(record, "plate", 5.99, 1) - place(record, "plate", 2.99, 1);
  const double lever = place(record, "lever", 5.99, 1) - place(record, "lever", 2.99, 1);
  EXPECT_NEAR(plate, 2.0 / pad_tangential, 1e-7);
  EXPECT_NEAR(lever - plate, 2.0 / string, 1e-7);
  EXPECT_TRUE(std::isnan(record.outcome.gross_slip_time));
}

// The plate slips at mu_s N. On a ramp of 1 N/s under 0.4 mm, 4 N, with mu_s 0.5 it sticks until 2
// s after the ramp began, later by the lever's damping, 2 N s/m of (1/7.2 + 1/20) mm/s: 0.4 mN.
TEST(LeverStage, PlateLetsGoAtMuTimesTheNormalForce) {
  const TrialRecord record = run("linear.yaml", {{"motion.compression", "0.4 mm"},
                                                 {"friction", "{static: 0.5, kinetic: 0.5}"},
                                                 {"controls.pull", "[[3 s, 0 N], [7 s, 4 N]]"},
                                                 {"duration", "6 s"}});
  EXPECT_NEAR(record.outcome.gross_slip_time, 3.0 + 0.5 * 4.0 * series / 10e3, 5e-3);
}

// Off the axis a pull F turns the plate by t against the nibs' stiffness K = sum k_t r^2 = 36 k_t 2
// (3.8 mm)^2 35/12. The eye, d = 60 mm up the plate, moves sideways by d t and slants the string of
// L = 100 mm, which shortens its arm of 31.75 mm by d t (1 + d/L):
//   t = F 31.75 mm/(K + F d (1 + d/L))
double turn_by(double pull) {
  constexpr double stiffness = pad_tangential * 2.0 * 3.8e-3 * 3.8e-3 * 35.0 / 12.0, d = 0.06, length = 0.1;
  return pull * 31.75e-3 / (stiffness + pull * d * (1.0 + d / length));
}

TEST(LeverStage, PullBesideTheAxisTurnsThePlate) {
  const auto pulled = [&](const std::string& pull) {
    return run("rotational.yaml", {{"motion.compression", "1 mm"},
                                   {"duration", "6 s"},
                                   {"friction", "{static: 0.65, kinetic: 0.65}"},
                                   {"controls.pull", pull}});
  };
  const TrialRecord held = pulled("[[3 s, 0 N], [4 s, 0.5 N]]");
  const BodyRecord& plate = *std::ranges::find(held.bodies, "plate", &BodyRecord::name);
  const std::size_t row = row_at(held, 5.99);
  const double turn = 2.0 * std::atan2(double{plate.pose[7 * row + 6]}, double{plate.pose[7 * row + 3]});
  EXPECT_NEAR(turn, -turn_by(0.5), 5e-3 * turn_by(0.5));  // of the second order in 24 mrad, and the string's shorter arm

  // The corner towards the pull's line has most shear: 9.5 mm t across, and as much plus F/(36 k_t)
  // along. The first nib slips there, at mu_s f_n/k_t, and the ramp is 1 N/s.
  const double shear = 0.65 * 1e-3 * series / pad_tangential;
  double low = 0.0, high = 3.0;
  for (int k = 0; k < 50; ++k) {
    const double pull = 0.5 * (low + high), across = 9.5e-3 * turn_by(pull);
    (std::hypot(across, across + pull / pad_tangential) < shear ? low : high) = pull;
  }
  EXPECT_NEAR(pulled("[[3 s, 0 N], [6 s, 3 N]]").outcome.first_slip_time, 3.0 + low, 0.01 * low);
}

// 0.03 mm/s on 9.99 N/mm reduce the force by 0.2997 N/s.
TEST(LeverStage, RetreatTakesTheForceOff) {
  const TrialRecord record =
      run("release.yaml", {{"motion.compression", "0.8 mm"}, {"controls.pull", "0 N"}, {"duration", "12 s"}});
  EXPECT_NEAR((force(record, 11.0, 2) - force(record, 7.0, 2)) /
                  (record.sensors[0].time[row_at(record, 11.0)] - record.sensors[0].time[row_at(record, 7.0)]),
              -0.03e-3 * series, 1e-4);
}

TEST(LeverStage, SweepsHaveThePublishedRanges) {
  const auto plan = [](const std::string& scene) { return TrialPlan(shipped("nib_pad/" + scene), catalogues(), 0, 1); };
  const TrialPlan release = plan("release.yaml");
  EXPECT_GE(release.size(), 261u);
  for (std::size_t cell = 0; cell < release.size(); cell += release.draws()) {
    const Scene scene = release.trial(cell).scene;
    const double pull = scene.controls.front().points.back().value, held = scene.motion.parameters.number("compression") * 10e3;
    EXPECT_NEAR(held - pull / scene.friction.static_coefficient, 2.0, 0.01) << cell;
    EXPECT_EQ(scene.motion.parameters.number("retreat_speed"), 0.03e-3);
  }
  for (const auto& [name, least, most, offset] :
       {std::tuple{"linear.yaml", 0.2e-3, 0.8e-3, 0.0}, {"rotational.yaml", 0.5e-3, 1.2e-3, 31.75e-3}}) {
    const TrialPlan kind = plan(name);
    EXPECT_EQ(kind.size(), 3u * 4u * 8u);
    double low = 1.0, high = 0.0;
    for (std::size_t k = 0; k < kind.size(); ++k) {
      const Parameters motion = kind.trial(k).scene.motion.parameters;
      low = std::min(low, motion.number("compression"));
      high = std::max(high, motion.number("compression"));
      EXPECT_NEAR(motion.vector("offset")[0], offset, 5e-3);
    }
    EXPECT_DOUBLE_EQ(low, least);
    EXPECT_DOUBLE_EQ(high, most);
  }
}

}  // namespace
}  // namespace slipbench::lever_test

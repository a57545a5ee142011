// Impacts, grazing contacts, falls, edges and corners, spin and shaking, all askew.
#include <numbers>
#include <tuple>

#include "tests/stability/hard_case.h"

namespace slipbench::hard {
namespace {

double kinetic_of(CaseRun& run) {
  mjData* d = run->data();
  std::vector<double> moved(static_cast<std::size_t>(run->model()->nv));
  mj_mulM(run->model(), d, moved.data(), d->qvel);
  return 0.5 * mju_dot(moved.data(), d->qvel, static_cast<int>(run->model()->nv));
}

// Returned share of the kinetic energy of an impact at 0.5 m/s, without dashpots and weight, at
// `part` of the longest step. `askew`: spread of the elements' touches, relative to the depth.
struct Blow {
  double returned;
  double phase;  // h omega
};
Blow blow(double mass, double stiffer, double mu, double across, double askew, double part) {
  BoxOnPad box{.mass = mass, .mu = mu, .pad = flat_square(3, pitch, stiffer * k_n, stiffer * k_t), .gravity = 0.0};
  const double omega = std::sqrt(9.0 * stiffer * k_n / mass), deep = 0.5 / omega;
  box.turn = {askew * deep / pitch, 0.6 * askew * deep / pitch, 0.004};
  box.position.z() = 1.6 * askew * deep + 1e-6;
  box.velocity = {across, 0.0, -0.5};
  const double fastest = modes_of(box).fastest;
  const double step = longest_sample / std::ceil(longest_sample * fastest / (0.75 * part));
  box.time_step = exact(step) + " s";
  box.duration = (2.0 * std::numbers::pi + 4.0 * askew) / omega + 0.002;
  CaseRun run(box);
  const double before = kinetic_of(run);
  run.to_end();
  EXPECT_EQ(run.force(), Eigen::Vector3d(0.0, 0.0, 0.0)) << "it has left";
  return {kinetic_of(run) / before, step * fastest};
}

// One spring, stepped velocity first, conserves Q = v^2 + y^2 - z v y, y = omega x, z = h omega. It
// enters at y = f z v, with the share f of a step inside, with Q = v^2 (1 - f (1 - f) z^2), and
// leaves in the same way with another f. So the returned energy is between 1 - z^2/4 and 1/(1 -
// z^2/4) of the initial one: at most 16 % too much at the longest allowed step, a quarter of that
// at half the step. This is a limitation of explicit springs, and the test shows its size; the
// bound uses the fastest mode for all springs. With friction (the box also moves sideways at 0.1
// m/s) less is returned, and its amount converges as fast.
class Impact : public ::testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(Impact, AtHalfAMetreASecondReturnsItsEnergyWithinTheBoundOfTheStep) {
  const auto [mass, stiffer] = GetParam();
  for (const double askew : {0.0, 0.3}) {
    const Blow fine = blow(mass, stiffer, 0.5, 0.1, askew, 0.125);
    for (const double part : {1.0, 0.5, 0.25, 0.125}) {
      const Blow free = blow(mass, stiffer, 0.0, 0.0, askew, part), rough = blow(mass, stiffer, 0.5, 0.1, askew, part);
      const double lost = free.phase * free.phase / 4.0, gained = lost / (1.0 - lost);
      RecordProperty("gain_" + std::to_string(askew) + "_" + std::to_string(part), std::to_string(free.returned - 1.0));
      EXPECT_LT(free.returned, 1.0 + gained) << part;
      EXPECT_GT(free.returned, 1.0 - lost) << part;
      EXPECT_LT(rough.returned, 1.0 + gained) << part;
      EXPECT_NEAR(rough.returned, fine.returned, gained + fine.phase * fine.phase / 4.0) << part;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Stability, Impact,
                         ::testing::Combine(::testing::Values(0.005, 0.1, 5.0), ::testing::Values(0.1, 1.0, 10.0, 100.0)));

// A box that passes at 100 mm/s touches at 1 mm/s, rebounds at 1 mm/s, and slips all the time:
// friction takes mu times the impact from its speed, mu 2 mm/s. Afterwards no force is left. The
// box touches askew by a twentieth of its depth, and some of the impact goes into rotation.
TEST(Stability, GrazingTouchTakesMuTimesTheBlow) {
  for (const double mass : {0.005, 0.1, 5.0}) {
    BoxOnPad box;
    box.mass = mass;
    box.gravity = 0.0;
    const double omega = std::sqrt(9.0 * k_n / mass), deep = 1e-3 / omega;
    box.turn = {0.05 * deep / pitch, 0.03 * deep / pitch, 4e-3};
    box.position.z() = 0.3 * deep;
    box.velocity = {0.1, 0.0, -1e-3};
    box.duration = 5.0 / omega;
    box.time_step = exact(longest_sample / std::ceil(longest_sample / (0.05 / omega))) + " s";
    CaseRun run(box);
    run.to_end();
    const Eigen::Vector3d speed = run.momentum() / mass;
    EXPECT_EQ(run->contact(0).state, PadState::no_contact);
    EXPECT_EQ(run.force(), Eigen::Vector3d(0.0, 0.0, 0.0));
    EXPECT_NEAR(speed.z(), 1e-3, 1e-5);
    EXPECT_NEAR(0.1 - speed.x(), box.mu * (1e-3 + speed.z()), 1e-3 * box.mu * 2e-3);
  }
}

// A box that falls on the pad from 2 mm, leaning by 3 and 2 degrees and tumbling at 5 rad/s,
// bounces and comes to rest; then its weight is carried, and its face is as deep as that of a box
// that was put down.
TEST(Stability, LeaningTumblingBoxComesToRest) {
  for (const double mass : {0.005, 0.1, 5.0}) {
    BoxOnPad box{.mass = mass, .turn = {3.0 * std::numbers::pi / 180.0, 2.0 * std::numbers::pi / 180.0, 0.1}};
    box.position.z() = 2e-3 + pitch * (box.turn.x() + box.turn.y());
    box.spin = {5.0, -3.0, 2.0};
    const Modes modes = modes_of(box);
    box.damping = 0.4 / modes.fastest;
    box.duration = 1.0 + 14.0 / (0.5 * box.damping * modes.slowest * modes.slowest);
    CaseRun run(box);
    run.to_end();
    EXPECT_LT((run.force() - Eigen::Vector3d(0.0, 0.0, mass * g)).norm(), 1e-3 * mass * g) << mass;
    const Eigen::Vector3d at = run.body("box").pose.position, up = run.body("box").pose.rotation.col(2);
    EXPECT_NEAR(-at.dot(up) / up.z(), sag_of(box), 2e-3 * sag_of(box)) << mass;
  }
}

// A box spinning on its pad at 100 rad/s: every element slips, f_n = m g/9 each, and the torque mu
// f_n sum sqrt(r^2 - e^2), with e = mu f_n/k_t = 14 um hardly less than r, slows it down by
// torque/I per second.
TEST(Stability, SpinningBoxSlowsDownByTheTorqueOfFriction) {
  BoxOnPad box;
  box.position.z() = -sag_of(box);
  box.turn = {0.2 * sag_of(box) / pitch, 0.13 * sag_of(box) / pitch, 0.0};
  box.damping = 0.4 / modes_of(box).fastest;
  box.spin = {0.0, 0.0, 100.0};
  box.duration = 0.3;
  const double levers = pitch * (4.0 + 4.0 * std::sqrt(2.0));
  const double slower = box.mu * box.mass * g / 9.0 * levers / inertia_of(box.mass).z();
  for (const std::string step : {"auto", "100 us"}) {
    box.time_step = step;
    CaseRun run(box);
    run.to(0.1);
    const double before = run.body("box").angular_velocity.z();
    run.to(0.3);
    const double rate = (before - run.body("box").angular_velocity.z()) / 0.2;
    EXPECT_NEAR(rate, slower, 2e-3 * slower);
    EXPECT_NEAR(run.force().z(), box.mass * g, 1e-3 * box.mass * g);
  }
}

// Pushed to and fro at 50 Hz in triangles of amplitude F. At each reversal the force overshoots the
// peak by at most 0.69 s/omega_t, s = 200 F/s (x = F - s t + 2 s/omega_t sin omega_t t): 0.5 % at
// the 26 krad/s of 5 g on a pad of stiffness x100. So it slips above mu m g, and not 2 % below.
TEST(Stability, ShakenAt50HzSlipsAboveMuTimesTheLoad) {
  for (const double part : {0.98, 1.02}) {
    BoxOnPad box{.mass = 0.005, .pad = flat_square(3, pitch, 100.0 * k_n, 100.0 * k_t)};
    box.position.z() = -sag_of(box);
    box.turn = {0.01 * sag_of(box) / pitch, 0.006 * sag_of(box) / pitch, 4e-3};
    box.damping = 0.4 / modes_of(box).fastest;
    const double peak = part * box.mu * box.mass * g;
    box.push = {{0.01, 0.0}};
    for (int k = 0; k < 30; ++k) box.push.emplace_back(0.015 + 0.01 * k, k % 2 == 0 ? peak : -peak);
    box.duration = 0.31;
    CaseRun run(box);
    run.to_end();
    const double slipped = run->contact(0).slip_distance.maxCoeff();
    if (part < 1.0) {
      EXPECT_EQ(slipped, 0.0);
    } else {
      EXPECT_GT(slipped, 1e-9);
    }
  }
}

// A pad under a finger of 1 kg on guides, over a fixed box: on its edge with six and with three of
// nine elements, and on its corner with one. These carry everything: depth m g/(n k_n). Pushed with
// 0.98 of mu m g it stays, with 1.02 it accelerates with 0.02 mu g.
TEST(Stability, EdgeAndCornerCarryWhatTheWholePadCarries) {
  struct Place {
    double x, y;
    int touching;
  };
  for (const Place& place : {Place{0.01, 0.0, 6}, Place{-0.01, 0.0, 3}, Place{-0.01, -0.01, 1}, Place{0.01, 0.01, 4}}) {
    for (const double part : {0.98, 1.02}) {
      const double push = part * 0.5 * g;
      // The box's corner is at x, y from the pad's middle; 0.1 mm and 4 mrad off.
      const std::string model =
          "<mujoco><compiler angle='radian'/><worldbody><geom name='box' type='box' size='0.1 0.1 0.02' euler='0 0 0.004' pos='" +
          exact({place.x - 0.1 + 1e-4, (place.touching % 3 == 0 ? 0.0 : place.y - 0.1) + 1e-4, -0.02}) +
          "'/><body name='finger'><joint name='height' type='slide' axis='0 0 1'/><joint name='travel' type='slide' axis='0 -1 0'/><geom type='box' pos='0 0 0.03' size='0.01 0.01 0.01' mass='1'/><site name='pad'/></body></worldbody><actuator><motor name='push' joint='travel'/></actuator></mujoco>";
      const std::string scene =
          "slipbench: 1\nmodel: finger.xml\nduration: 2.2 s\ntime_step: auto\nfriction: {static: 0.5, kinetic: 0.5}\ncontrols: {push: [[0.5 s, 0 N], [1.5 s, " +
          exact(push) + " N]]}\nsensors: {pad: {type: papillarray, site: pad, touches: [box], damping: 5 ms}}\n";
      const PadLayout pad = flat_square(3, pitch, 10.0 * k_n, 10.0 * k_t);
      CaseRun run(scene, "finger.xml", model, {&pad});
      run.to(2.0);
      const double before = run->data()->qvel[1];
      int touching = 0;
      for (const UnitState state : run->contact(0).unit_state) touching += state != UnitState::detached ? 1 : 0;
      EXPECT_EQ(touching, place.touching);
      EXPECT_NEAR(run.force().z(), -g, 1e-4 * g);
      EXPECT_NEAR(-run->data()->qpos[0], g / (place.touching * 10.0 * k_n), 1e-4 * g / (place.touching * 10.0 * k_n));
      run.to(2.1);
      const double gained = (run->data()->qvel[1] - before) / 0.1;
      EXPECT_NEAR(gained, part < 1.0 ? 0.0 : 0.02 * 0.5 * g, 0.01 * 0.02 * 0.5 * g);
    }
  }
}

}  // namespace
}  // namespace slipbench::hard

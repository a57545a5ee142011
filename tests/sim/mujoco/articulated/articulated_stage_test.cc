// A pad of articulated pillars with prescribed motion, against closed forms.
//
// The recipe (sim/mujoco/articulated/articulated.h) determines the expected deviations:
// - trailing: a sticking tip keeps 1/(1 + 2/(0.8 x 0.5)) = 1/6 of its velocity from step to step,
//   so it follows a drive that jumps to its speed 1/6 + 1/36 + ... = 0.2 steps late
// - damping: ratio 0.3 with a tip of 0.01 g adds c v to a sticking pillar's force, c = 0.6 sqrt(k_t
//   m). Slip comes c/k_t early, 85 us at 500 N/m, and the ringing after it decays by e^-10 in
//   10/(0.3 sqrt(k_t/m)) = 5 ms
// - recruiting: slip in the main solve presses slightly harder, 0.3 % at 100 mm/s and proportional
//   to the speed (measured)
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>

#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/articulated/articulated_stage.h"
#include "tests/expect.h"
#include "tests/oracle/pads.h"

namespace slipbench::articulated_stage_test {
namespace {

constexpr double mu = 0.5, depth = 1.5e-3, early = 85e-6, ringing = 5e-3, late = 0.3;

struct Stiffness {
  double k_n, k_t;
};
constexpr Stiffness soft{3000.0, 500.0}, real{7100.0, 3900.0};

double normal_force(const PadLayout& pad, std::size_t u, double k_n) { return k_n * (depth - pad.elements[u].tip.z()); }

// Steps a bench through `pose(t)` for t = 0, dt, ..., duration and passes every frame to `look`.
void drive(ArticulatedStage& simulation, double dt, double duration, const std::function<Pose(double)>& pose,
           const std::function<void(const ContactFrame&)>& look) {
  const auto ticks = static_cast<std::size_t>(std::lround(duration / dt));
  for (std::size_t tick = 0; tick <= ticks; ++tick) {
    const double time = static_cast<double>(tick) * dt;
    look(simulation.step(pose(time), time));
  }
}

Pose at(double x, double z) {
  Pose pose;
  pose.position = {x, 0.0, z};
  return pose;
}

struct Slide {
  Stiffness stiffness;
  double speed, dt;
};

class ArticulatedSlide : public testing::TestWithParam<Slide> {};

TEST_P(ArticulatedSlide, EveryPillarSlipsAtTheClosedFormsTimeAndGoesOnAtCoulombsForce) {
  // A pillar pressed by f_n whose root moves at v slips at mu f_n/(k_t v); from then on f_t = mu
  // f_n and its tip moves at v. Limit: 2 %.
  const auto [stiffness, v, dt] = GetParam();
  const double recruited = 3e-3 * v / 0.1 + 1e-4;
  const PadLayout pad = oracle::nine_pillars(1, stiffness.k_n, stiffness.k_t);
  const auto onset = [&](std::size_t u) { return mu * normal_force(pad, u, stiffness.k_n) / (stiffness.k_t * v); };
  ArticulatedStage simulation(pad, Plane{}, {mu, mu}, dt);
  oracle::FirstTimes slips(9, EventKind::slip);
  std::size_t changes = 0;
  drive(
      simulation, dt, 1.5 * onset(4), [&](double t) { return at(v * t, -depth); },
      [&](const ContactFrame& frame) {
        slips(frame);
        changes += frame.events.size();
        for (std::size_t u = 0; u < 9; ++u) {
          const auto c = static_cast<Eigen::Index>(u);
          const double f_n = normal_force(pad, u, stiffness.k_n);
          ASSERT_NEAR(frame.contact_force(2, c), f_n, recruited * f_n) << frame.time;
          if (frame.time < onset(u) + ringing + 8.0 * dt) continue;  // the tip accelerates to the pad's speed
          ASSERT_EQ(frame.unit_state[u], UnitState::slip) << frame.time;
          ASSERT_NEAR(frame.contact_force(0, c), -mu * f_n, recruited * mu * f_n) << frame.time;
          ASSERT_NEAR(frame.contact_force(1, c), 0.0, 1e-6 * f_n) << frame.time;
          ASSERT_NEAR(frame.slip_velocity(0, c), v, 2e-3 * v) << frame.time;
          ASSERT_NEAR(frame.margin[c], 0.0, 1e-9) << frame.time;
        }
      });
  for (std::size_t u = 0; u < 9; ++u) {
    EXPECT_NEAR(slips.times()[u], onset(u), early + late * dt) << u;
    EXPECT_NEAR(slips.times()[u], onset(u), 0.02 * onset(u)) << u;
    // Distance slipped since.
    const auto c = static_cast<Eigen::Index>(u);
    EXPECT_NEAR(simulation.frame().slip_distance[c], v * (simulation.frame().time - onset(u)), v * (2.0 * early + late * dt))
        << u;
  }
  EXPECT_EQ(changes, 27U) << "touch, micro and slip of each pillar once, and nothing flickers";
  EXPECT_EQ(simulation.frame().state, PadState::gross);
  EXPECT_EQ(simulation.frame().stuck_fraction, 0.0);
  EXPECT_NEAR(simulation.frame().slip_direction, 0.0, 1e-6);
}

// 4 ms is split into two substeps.
INSTANTIATE_TEST_SUITE_P(Speeds, ArticulatedSlide,
                         testing::Values(Slide{soft, 4e-3, 1e-3}, Slide{soft, 20e-3, 1e-3}, Slide{soft, 100e-3, 1e-3},
                                         Slide{soft, 4e-3, 2e-3}, Slide{soft, 4e-3, 4e-3}, Slide{soft, 20e-3, 2e-4},
                                         Slide{real, 4e-3, 1e-3}, Slide{real, 20e-3, 1e-3}));

TEST(ArticulatedStage, AFastSlideIsDividedIntoStepsOfATenthOfAMillimetre) {
  // At 200 mm/s in steps of 10 ms: 20 parts of 0.5 ms. In parts of 2 ms tips bounce, and the slide
  // loses half of its path. A tip slips the path of the pad less the stretch mu f_n/k_t.
  const PadLayout pad = oracle::nine_pillars(1, soft.k_n, soft.k_t);
  constexpr double v = 0.2, dt = 10e-3, duration = 0.4;
  ArticulatedStage simulation(pad, Plane{}, {mu, mu}, dt, v);
  drive(
      simulation, dt, duration, [](double t) { return at(v * t, -depth); },
      [](const ContactFrame& frame) {
        if (frame.time < 0.03) return;
        ASSERT_EQ(frame.state, PadState::gross) << frame.time;
      });
  for (std::size_t u = 0; u < 9; ++u) {
    const double slip = v * duration - mu * normal_force(pad, u, soft.k_n) / soft.k_t;
    EXPECT_NEAR(simulation.frame().slip_distance[static_cast<Eigen::Index>(u)], slip, 0.01 * slip) << u;
  }
}

TEST(ArticulatedStage, APadHeldUnderShearDoesNotCreep) {
  // Drawn to 60 % of the corners' distance to slip and held: the tips' deflection equals the
  // distance, and stays. Limit: 0.5 um/s.
  const PadLayout pad = oracle::nine_pillars(1, soft.k_n, soft.k_t);
  const double dt = 1e-3, v = 4e-3, way = 0.6 * mu * normal_force(pad, 0, soft.k_n) / soft.k_t, arrived = way / v;
  ArticulatedStage simulation(pad, Plane{}, {mu, mu}, dt);
  Eigen::ArrayXd before;
  drive(
      simulation, dt, arrived + 2.1, [&](double t) { return at(v * std::min(t, arrived), -depth); },
      [&](const ContactFrame& frame) {
        ASSERT_EQ(frame.state, PadState::non_slip) << frame.time;
        ASSERT_EQ(frame.state_micro, PadState::non_slip) << frame.time;
        if (std::abs(frame.time - arrived - 0.1) < 0.5 * dt) before = frame.displacement.row(0);
      });
  const Eigen::ArrayXd after = simulation.frame().displacement.row(0);
  EXPECT_LT((after - before).abs().maxCoeff() / 2.0, 0.05e-6) << "m/s";
  EXPECT_NEAR(after[0], -way, 1e-3 * way);
  EXPECT_TRUE((simulation.frame().slip_distance == 0.0).all());
}

TEST(ArticulatedStage, ASlideThatStopsStopsSlipping) {
  // Stopped when the corners slip and the others do not: from then on the corners stick, at their
  // sliding force.
  const PadLayout pad = oracle::nine_pillars(1, soft.k_n, soft.k_t);
  const double dt = 1e-3, v = 4e-3;
  const double corner = mu * normal_force(pad, 0, soft.k_n) / (soft.k_t * v),
               edge = mu * normal_force(pad, 1, soft.k_n) / (soft.k_t * v);
  const double stop = std::round(0.5 * (corner + edge) / dt) * dt;
  ArticulatedStage simulation(pad, Plane{}, {mu, mu}, dt);
  oracle::FirstTimes sticks(9, EventKind::stick), slips(9, EventKind::slip);
  drive(
      simulation, dt, stop + 1.0, [&](double t) { return at(v * std::min(t, stop), -depth); },
      [&](const ContactFrame& frame) {
        sticks(frame);
        slips(frame);
        if (frame.time > stop + 2.0 * dt) {
          ASSERT_EQ(frame.state_micro, PadState::non_slip) << frame.time;
          ASSERT_TRUE(frame.events.empty()) << frame.time;
        }
      });
  for (std::size_t u = 0; u < 9; ++u) {
    const bool at_corner = u == 0 || u == 2 || u == 6 || u == 8;
    EXPECT_EQ(std::isnan(slips.times()[u]), !at_corner) << u;
    if (!at_corner) continue;
    EXPECT_NEAR(sticks.times()[u], stop, 2.0 * dt) << u;
    const double f_n = normal_force(pad, u, soft.k_n);
    // When the tip stops, the damping force c v vanishes (0.1 mN); the spring's does not change.
    EXPECT_NEAR(simulation.frame().contact_force(0, static_cast<Eigen::Index>(u)), -mu * f_n, 1e-3 * mu * f_n) << u;
  }
}

TEST(ArticulatedStage, ATurnLetsGoByRadius) {
  // When the pad has turned by `angle`, a tip at radius r has stretched by 2 r sin(angle/2), so it
  // slips at 2 asin(mu f_n/(2 k_t r)). All heights are equal here: the corners (r = 7 sqrt(2) mm)
  // slip first, then the edges (7 mm), the centre never. A tip's chord in a step of rate dt is off
  // by less than (rate dt)^2: 1e-6. Once slipping, the pad turns about its middle at `rate`.
  PadLayout pad = oracle::nine_pillars(1, soft.k_n, soft.k_t);
  for (Element& element : pad.elements) element.tip.z() = 0.0;
  const double dt = 1e-3, rate = 1.0, compression = 1e-3, friction = 0.3;
  const double reach = friction * soft.k_n * compression / soft.k_t;
  const auto onset = [&](double r) { return 2.0 * std::asin(reach / (2.0 * r)) / rate; };
  ArticulatedStage simulation(pad, Plane{}, {friction, friction}, dt);
  oracle::FirstTimes slips(9, EventKind::slip);
  double angle_before = 0.0;
  drive(
      simulation, dt, 1.0,
      [&](double t) {
        return oracle::turned(rate * t, {0.0, 0.0, -compression});
      },
      [&](const ContactFrame& frame) {
        slips(frame);
        if (std::abs(frame.time - 0.9) < 0.5 * dt) angle_before = frame.slip_angle;
      });
  for (std::size_t u = 0; u < 9; ++u) {
    const double r = pad.elements[u].tip.head<2>().norm();
    if (r == 0.0) {
      EXPECT_TRUE(std::isnan(slips.times()[u]));
      EXPECT_EQ(simulation.frame().unit_state[u], UnitState::stick);
    } else {
      EXPECT_NEAR(slips.times()[u], onset(r), early + late * dt) << u;
    }
  }
  EXPECT_EQ(simulation.frame().state, PadState::incipient);
  EXPECT_NEAR(simulation.frame().stuck_fraction, 1.0 / 9.0, 1e-12);
  EXPECT_NEAR(simulation.frame().slip_angle - angle_before, 0.1 * rate, 2e-3 * 0.1 * rate);
  EXPECT_NEAR(simulation.frame().slip_centre.matrix().norm(), 0.0, 2e-3 * 7e-3);
}

TEST(ArticulatedStage, TouchAndLiftOffHappenAtTheirTimesAndLeaveNoForceBehind) {
  // The pad goes down and up at w = 20 mm/s from 0.1 mm above its middle pillar's touch to 0.8 mm
  // below, sliding a little: pillar u, with height h above the middle one, touches (0.1 mm + h)/w
  // after the start of each cycle, and detaches the same time before its end. The contact's damper
  // over its spring, 2/sqrt(3) = 1.2 steps, is the time by which it detaches early. Contacts begin
  // and end at steps.
  const PadLayout pad = oracle::nine_pillars(1, soft.k_n, soft.k_t);
  const double dt = 1e-3, w = 20e-3, above = 1e-4, below = 0.8e-3, cycle = 2.0 * (above + below) / w;
  ArticulatedStage simulation(pad, Plane{}, {mu, mu}, dt);
  constexpr int cycles = 20;
  // The first touch and the last detach of each cycle: a detaching tip may bounce once.
  const std::vector<double> never(cycles, std::nan(""));
  std::vector<std::vector<double>> touches(9, never), detaches(9, never);
  drive(
      simulation, dt, cycles * cycle,
      [&](double t) {
        const double phase = std::fmod(t + 1e-12, cycle);
        return at(0.5e-3 * std::sin(20.0 * t), above - w * std::min(phase, cycle - phase));
      },
      [&](const ContactFrame& frame) {
        for (const ContactEvent& event : frame.events) {
          const auto k = static_cast<std::size_t>(event.time / cycle);
          if (event.kind == EventKind::touch && std::isnan(touches[event.unit].at(k))) touches[event.unit].at(k) = event.time;
          if (event.kind == EventKind::detach) detaches[event.unit].at(k) = event.time;
        }
      });
  for (std::size_t u = 0; u < 9; ++u) {
    const double way = (above + pad.elements[u].tip.z()) / w;
    for (int k = 0; k < cycles; ++k) {
      EXPECT_NEAR(touches[u][static_cast<std::size_t>(k)], k * cycle + way, dt) << u << ' ' << k;
      EXPECT_NEAR(detaches[u][static_cast<std::size_t>(k)], (k + 1) * cycle - way, 3.0 * dt) << u << ' ' << k;
    }
  }
  EXPECT_EQ(simulation.frame().state, PadState::no_contact);
  EXPECT_TRUE((simulation.frame().force == 0.0).all());
  EXPECT_TRUE((simulation.frame().contact_force == 0.0).all());
  EXPECT_TRUE(simulation.frame().margin.isNaN().all());
}

// A step of 4 ms has several of MuJoCo's: in some of them a pillar still slips that has lifted off
// at the step's end. slip_velocity is 0 unless the pillar slips at the end.
TEST(ArticulatedStage, SlipThatEndsWithinAStepLeavesNoVelocity) {
  const double dt = 4e-3, cycle = 0.1;
  ArticulatedStage simulation(oracle::nine_pillars(1, soft.k_n, soft.k_t), Plane{}, {mu, mu}, dt);
  std::vector<UnitState> before(9, UnitState::detached);
  int ended = 0;
  drive(
      simulation, dt, 10 * cycle, [&](double t) { return at(50e-3 * t, -0.4e-3 + 0.8e-3 * std::cos(2.0 * M_PI * t / cycle)); },
      [&](const ContactFrame& frame) {
        for (std::size_t u = 0; u < 9; ++u) {
          if (frame.unit_state[u] == UnitState::slip) continue;
          ended += before[u] == UnitState::slip ? 1 : 0;
          ASSERT_TRUE((frame.slip_velocity.col(static_cast<Eigen::Index>(u)) == 0.0).all()) << frame.time << ' ' << u;
        }
        before = frame.unit_state;
      });
  EXPECT_GT(ended, 20);
}

TEST(ArticulatedStage, AUnitOfTwoBristlesSlipsInParts) {
  // Bristles of weights 1.6 and 0.4 share a pillar: the light one slips at 0.4 times the mean's
  // time, the heavy one at 1.6 times.
  const PadLayout pad = oracle::nine_pillars(2, soft.k_n, soft.k_t);
  const double dt = 1e-3, v = 20e-3;
  const double mean = mu * soft.k_n * depth / (soft.k_t * v);
  ArticulatedStage simulation(pad, Plane{}, {mu, mu}, dt);
  oracle::FirstTimes micro(9, EventKind::micro), slips(9, EventKind::slip);
  drive(
      simulation, dt, 1.7 * mean, [&](double t) { return at(v * t, -depth); },
      [&](const ContactFrame& frame) {
        micro(frame);
        slips(frame);
        if (frame.time > 0.5 * mean && frame.time < 1.5 * mean) {
          ASSERT_EQ(frame.unit_state[4], UnitState::partial) << frame.time;
        }
      });
  EXPECT_NEAR(micro.times()[4], 0.4 * mean, early + late * dt);
  EXPECT_NEAR(slips.times()[4], 1.6 * mean, early + late * dt);
}

class ArticulatedTilt : public testing::TestWithParam<double> {};

TEST_P(ArticulatedTilt, ASlideOfATiltedPillarObeysCoulombAndHooke) {
  // Pressed by d along the surface's normal and drawn by s along X, a pillar whose axis is turned
  // by a about Y has the spring forces
  //   N = d (k_t + D cos^2 a) - s D sin a cos a,  T = s (k_t + D sin^2 a) - d D sin a cos a,  D = k_n - k_t,
  // and slips at T = mu N. The recipe's error grows with the tilt: 1.5 % up to 3 degrees.
  const double a = GetParam() * 3.14159265358979 / 180.0, k_n = soft.k_n, k_t = soft.k_t, v = 4e-3, dt = 1e-3;
  const double difference = k_n - k_t, coupling = difference * std::sin(a) * std::cos(a);
  const double along = k_t + difference * std::pow(std::sin(a), 2), across = k_t + difference * std::pow(std::cos(a), 2);
  const double way = depth * (mu * across + coupling) / (along + mu * coupling), f_n = depth * across - way * coupling;
  PadLayout pad;
  pad.elements.resize(1);
  pad.units.resize(1);
  pad.elements[0].k_normal = k_n;
  pad.elements[0].k_tangential = k_t;
  ArticulatedStage simulation(pad, Plane{}, {mu, mu}, dt);
  oracle::FirstTimes slips(1, EventKind::slip);
  // Pressed first: the placing leaves the pillar unstrained along its own axis, not the surface's.
  const double pressed = 0.1, start = 0.2;
  drive(
      simulation, dt, start + 1.5 * way / v,
      [&](double t) {
        Pose pose = at(v * std::max(0.0, t - start), 1e-4 - (depth + 1e-4) * std::min(1.0, t / pressed));
        pose.rotation = Eigen::AngleAxisd(a, Eigen::Vector3d::UnitY()).toRotationMatrix();
        return pose;
      },
      std::ref(slips));
  EXPECT_NEAR((slips.times()[0] - start) * v, way, 0.02 * way);
  EXPECT_NEAR(simulation.frame().contact_force(2, 0), f_n, 0.015 * f_n);
  EXPECT_NEAR(simulation.frame().contact_force.col(0).head<2>().matrix().norm(), mu * f_n, 0.015 * mu * f_n);
  EXPECT_EQ(simulation.frame().state, PadState::gross);
}

INSTANTIATE_TEST_SUITE_P(Degrees, ArticulatedTilt, testing::Values(-3.0, -1.0, 0.0, 1.0, 3.0));

TEST(ArticulatedStage, WhatTipsDoWhileTheySettleIsNotInTheLabels) {
  // Pushed along axes turned by 10 degrees, tan 10 degrees = 0.18, over a surface of mu 0.05, tips
  // slip while they settle.
  const PadLayout pad = oracle::nine_pillars(1, soft.k_n, soft.k_t);
  ArticulatedStage simulation(pad, Plane{}, {0.05, 0.05}, 1e-3);
  Pose pose = at(0.0, -3e-3);
  pose.rotation = Eigen::AngleAxisd(10.0 * 3.14159265358979 / 180.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const ContactFrame& frame = simulation.step(pose, 0.25);
  EXPECT_GT(frame.contact_force.topRows<2>().abs().maxCoeff(), 0.0) << "they have moved";
  EXPECT_EQ(frame.time, 0.25);
  EXPECT_TRUE((frame.slip_distance == 0.0).all());
  EXPECT_EQ(frame.slip_angle, 0.0);
  ASSERT_EQ(frame.events.size(), 9U);
  for (std::size_t u = 0; u < 9; ++u) {
    EXPECT_EQ(frame.events[u].unit, u);
    EXPECT_EQ(frame.events[u].kind, EventKind::touch);
    EXPECT_EQ(frame.events[u].time, 0.25);
  }
}

TEST(ArticulatedStage, RefusesWhatItCannotModel) {
  const PadLayout pad = oracle::nine_pillars();
  EXPECT_THROW(ArticulatedStage(pad, Plane{}, {0.6, 0.5}, 1e-3), std::invalid_argument) << "MuJoCo has one coefficient";
  EXPECT_THROW(ArticulatedStage(pad, Plane{}, {mu, mu}, 0.0), std::invalid_argument);
  EXPECT_THROW(ArticulatedStage(PadLayout{}, Plane{}, {mu, mu}, 1e-3), std::invalid_argument);
  PadLayout between_units = pad;
  between_units.element_truth = true;
  EXPECT_THROW(ArticulatedStage(between_units, Plane{}, {mu, mu}, 1e-3), SceneValueError);
  PadLayout bad = pad;
  bad.elements[3].k_tangential = 0.0;
  EXPECT_THROW(ArticulatedStage(bad, Plane{}, {mu, mu}, 1e-3), std::invalid_argument);
  bad = pad;
  bad.elements[3].axis = {0.0, 0.0, -2.0};
  EXPECT_THROW(ArticulatedStage(bad, Plane{}, {mu, mu}, 1e-3), std::invalid_argument);

  EXPECT_THROW(articulated_pillars(ArticulatedSettings{}, 2.1e-3), std::invalid_argument);
}

TEST(ArticulatedStage, AWarningOfMuJoCoEndsTheRunWithItsTextTimeAndBody) {
  ArticulatedStage simulation(oracle::nine_pillars(), Plane{}, {mu, mu}, 1e-3);
  simulation.step(at(0.0, -depth), 0.0);
  const std::string said =
      refusal_of<std::runtime_error>([&] { simulation.step(at(std::numeric_limits<double>::quiet_NaN(), -depth), 0.25); });
  EXPECT_THAT(said, HasSubstr("MuJoCo warns: Nan, Inf or huge value in Q"));
  EXPECT_THAT(said, HasSubstr("0.25"));
  EXPECT_THAT(said, HasSubstr("body 'carrier'"));
}

}  // namespace
}  // namespace slipbench::articulated_stage_test

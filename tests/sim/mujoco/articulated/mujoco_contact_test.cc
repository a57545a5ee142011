// MuJoCo's own contact friction with a scene's `contact` settings, on pads with prescribed motion,
// against its regularisation's closed form.
//
// With solref (t_c, 1) and a constant impedance d a contact's friction is a damper within the cone
// (MuJoCo's documentation, "Computation", constraint model): for a tip at rest f_t = b s/R_t at a
// creep speed s, with b = 2/(d t_c), R_t = (1 - d)/(d m impratio), and m the tip's mass, because
// the drive and the surface are far heavier. So the contact's damping is c = b/R_t = 2 m
// impratio/(t_c (1 - d)) [N s/m]. A spring k_t whose root is drawn at v then has
//   f_t(t) = c v (1 - exp(-t/tau)),  creep s(t) = v (1 - exp(-t/tau)),  tau = c/k_t,
// and a held one relaxes as exp(-t/tau). It reaches the cone, mu f_n, only if c v > mu f_n, and
// never before mu f_n/(k_t v).
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/articulated/articulated_stage.h"
#include "sim/scene/scene_values.h"
#include "tests/expect.h"
#include "tests/oracle/pads.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench::mujoco_contact_test {
namespace {

constexpr double mu = 0.5, depth = 1.5e-3, k_n = 3000.0, k_t = 500.0, dt = 1e-3, speed = 4e-3;
constexpr double pressed = 0.1, start = 0.4;  // s: pressed in by then, and drawn from then on

// MuJoCo's defaults with `changes`.
Parameters contact(const std::vector<std::pair<std::string, Parameters::Value>>& changes) {
  Parameters result = defaults_of(contact_entry.parameters);
  for (const auto& [name, value] : changes) result.set(name, value);
  return result;
}

// Tips of 10 g in MuJoCo's stiffest safe contact at 1 ms, t_c = 2 ms, with constant impedance 0.9.
constexpr double tip_mass = 10e-3, time_constant = 2e-3, impedance = 0.9;
Parameters plain(const std::string& integrator, const std::string& cone, double impratio, std::int64_t noslip,
                 double mass = tip_mass) {
  return contact({{"integrator", integrator},
                  {"cone", cone},
                  {"impratio", impratio},
                  {"noslip", noslip},
                  {"solref", std::vector<double>{time_constant, 1.0}},
                  {"solimp", std::vector<double>{impedance, impedance, 1e-3}},
                  {"tip_mass", mass}});
}
double holds(double mass, double impratio) { return 2.0 * mass * impratio / (time_constant * (1.0 - impedance)); }

// Presses the pad in, draws it at `drive` [m/s] from `start` until `stop` [s] and passes every
// frame from `start` on to `look`.
void run(const Parameters& contact, double stop, double end, const std::function<void(const ContactFrame&)>& look,
         double drive = speed) {
  ArticulatedStage simulation(oracle::nine_pillars(1, k_n, k_t), Plane{}, {mu, mu}, user_pillars(contact, dt));
  const auto ticks = static_cast<std::size_t>(std::lround(end / dt));
  for (std::size_t tick = 0; tick <= ticks; ++tick) {
    const double time = static_cast<double>(tick) * dt;
    Pose pose;
    pose.position = {drive * (std::clamp(time, start, stop) - start), 0.0, 1e-4 - (depth + 1e-4) * std::min(1.0, time / pressed)};
    const ContactFrame& frame = simulation.step(pose, time);
    if (time > start) look(frame);
  }
}

double drawn(const ContactFrame& frame, Eigen::Index u) { return frame.contact_force.col(u).head<2>().matrix().norm(); }

// Returns when the mean of a creep v (1 - exp(-t/tau)), exponential over T = 10 ms, reaches 1 mm/s.
// The mean is v (1 - (tau e^(-t/tau) - T e^(-t/T))/(tau - T)); the creep itself reaches it long
// before.
double creep_is_slip(double tau) {
  const double T = 1e-2;
  double low = 0.0, high = 1.0;
  while (high - low > 1e-9) {
    const double t = 0.5 * (low + high);
    const double mean = speed * (1.0 - (tau * std::exp(-t / tau) - T * std::exp(-t / T)) / (tau - T));
    (mean < 1e-3 ? low : high) = t;
  }
  return high;
}

// c = 100 N s/m gives 0.4 N at 4 mm/s for any press, and the cones are mu f_n = 1.4 N to 2 N (the
// contact yields to a ninth of the press): friction stops at a quarter of the cone. The tips slide
// inside the cone at the pad's speed, long before the expected slip at 0.8 to 1.1 s.
TEST(MujocoContact, FrictionAtImpratioOneNeverComesNearTheCone) {
  const double most = holds(tip_mass, 1.0) * speed, tau = holds(tip_mass, 1.0) / k_t;
  ASSERT_NEAR(most, 0.4, 1e-12);
  oracle::FirstTimes slips(9, EventKind::slip);
  ContactFrame last;
  run(plain("implicitfast", "elliptic", 1.0, 0), 10.0, start + 1.5, [&](const ContactFrame& frame) {
    slips(frame);
    for (Eigen::Index u = 0; u < 9; ++u) ASSERT_LT(drawn(frame, u), 0.3 * mu * frame.contact_force(2, u)) << frame.time;
    last = frame;
  });
  for (std::size_t u = 0; u < 9; ++u) {
    const auto c = static_cast<Eigen::Index>(u);
    EXPECT_NEAR(drawn(last, c), most, 0.01 * most) << u;
    EXPECT_NEAR(last.slip_velocity.col(c).matrix().norm(), speed, 0.01 * speed) << u;
    EXPECT_EQ(last.unit_state[u], UnitState::slip) << u;
    EXPECT_NEAR(slips.times()[u] - start, creep_is_slip(tau), 2.0 * dt) << u;
  }
}

// A slide too slow to count as slip still has its distance: the pad's distance minus the bending of
// the tips. c = 100 N s/m at 0.4 mm/s bends them by 0.04 N/k_t = 80 um. Limit: 1e-3 of the
// distance.
TEST(MujocoContact, SlideThatReadsAsStickHasItsDistance) {
  const double slow = 0.1 * speed, duration = 1.5;
  ContactFrame last;
  run(
      plain("implicitfast", "elliptic", 1.0, 0), 10.0, start + duration,
      [&](const ContactFrame& frame) {
        for (const UnitState state : frame.unit_state) ASSERT_EQ(state, UnitState::stick) << frame.time;
        last = frame;
      },
      slow);
  for (Eigen::Index u = 0; u < 9; ++u) {
    EXPECT_NEAR(-last.displacement(0, u), 80e-6, 1e-6) << u;
    EXPECT_NEAR(last.slip_distance[u], slow * duration + last.displacement(0, u), 1e-3 * slow * duration) << u;
    EXPECT_EQ(last.slip_velocity.col(u).matrix().norm(), 0.0) << u << ": of tips that slip";
  }
}

// A pyramidal contact has other rows but gives the same readings: the pad's speed, once all slip.
TEST(MujocoContact, PyramidalContactIsReadByItsEdges) {
  ContactFrame last;
  run(plain("implicitfast", "pyramidal", 1.0, 0), 10.0, start + 1.5, [&](const ContactFrame& frame) { last = frame; });
  for (Eigen::Index u = 0; u < 9; ++u) {
    EXPECT_NEAR(last.slip_velocity(0, u), speed, 0.01 * speed) << u;
    EXPECT_NEAR(last.slip_velocity(1, u), 0.0, 1e-3 * speed) << u;
    EXPECT_LT(last.contact_force.col(u).head<2>().abs().sum(), mu * last.contact_force(2, u)) << u;
  }
}

// With noslip a tip sticks until f_t = mu f_n for the reduced press of the yielding contact: t = mu
// f_n/(k_t v), early by the damping of a stuck tip, c/k_t = 0.6 sqrt(m/k_t) = 2.7 ms, and then
// keeps that force. Limit: 3 %; within a step.
class NoslipOnset : public testing::TestWithParam<std::pair<std::string, std::int64_t>> {};
TEST_P(NoslipOnset, IsThatOfThePress) {
  const auto& [integrator, noslip] = GetParam();
  const double early = 0.6 * std::sqrt(tip_mass / k_t);
  oracle::FirstTimes slips(9, EventKind::slip);
  Eigen::ArrayXd normal_force;
  ContactFrame last;
  run(plain(integrator, "elliptic", 1.0, noslip), 10.0, start + 1.5, [&](const ContactFrame& frame) {
    slips(frame);
    if (normal_force.size() == 0) normal_force = frame.contact_force.row(2);
    last = frame;
  });
  for (std::size_t u = 0; u < 9; ++u) {
    const auto c = static_cast<Eigen::Index>(u);
    const double onset = mu * normal_force[c] / (k_t * speed);
    EXPECT_NEAR(slips.times()[u] - start, onset - early, 2.0 * dt) << u;
    EXPECT_NEAR(slips.times()[u] - start, onset, 0.03 * onset) << u;
    EXPECT_NEAR(drawn(last, c), mu * last.contact_force(2, c), 1e-6 * normal_force[c]) << u;
    EXPECT_EQ(last.unit_state[u], UnitState::slip) << u;
  }
}
INSTANTIATE_TEST_SUITE_P(Iterations, NoslipOnset,
                         testing::Values(std::pair{"implicitfast", 1}, std::pair{"implicitfast", 3}, std::pair{"discrete", 3},
                                         std::pair{"Euler", 3}, std::pair{"implicit", 3}));

// Held under shear, tips of 100 g (c = 1 kN s/m, tau = 2 s) lose 22 % of their force in half a
// second with every integrator that solves contacts with the inertia alone, and their slip equals
// that loss; with noslip they do not move.
class HoldCreep : public testing::TestWithParam<std::string> {};
TEST_P(HoldCreep, IsTheDampersAndNoneWithNoslip) {
  const double tau = holds(0.1, 1.0) / k_t, stop = start + 0.2, settled = stop + 0.1, end = settled + 0.5;
  const auto left = [&](std::int64_t noslip) {
    double before = 0.0, after = 0.0, distance_before = 0.0, distance = 0.0;
    run(plain(GetParam(), "elliptic", 1.0, noslip, 0.1), stop, end, [&](const ContactFrame& frame) {
      EXPECT_NE(frame.unit_state[0], UnitState::slip) << frame.time;
      distance = frame.slip_distance[0];
      after = frame.displacement(0, 0);
      if (std::abs(frame.time - settled) > 0.5 * dt) return;
      before = after;
      distance_before = distance;
    });
    EXPECT_NEAR(distance - distance_before, std::abs(after - before), 1e-4 * std::abs(before));
    return after / before;
  };
  EXPECT_NEAR(left(0), std::exp(-0.5 / tau), 0.005);
  EXPECT_NEAR(left(3), 1.0, 1e-4);
}
INSTANTIATE_TEST_SUITE_P(Integrators, HoldCreep, testing::Values("Euler", "implicit", "implicitfast", "RK4"));

class ContactScene : public testing::Test {
 protected:
  static constexpr const char* stage =
      "slipbench: 1\nfidelity: mujoco_contact\nduration: 1 s\ntime_step: 1 ms\nfriction: {static: 0.5, kinetic: 0.5}\n"
      "motion: {kind: stage, compression: 0.8 mm, speed: 8 mm/s, start: 0.5 s}\nsensors: {pad: {type: papillarray}}\n";

  static std::unique_ptr<Simulation> bench_of(const std::string& more) {
    const Scene scene = parsed(stage + more);
    const std::unique_ptr<Sensor> sensor = make_sensor(scene.sensors.front(), 0, 0);
    const PadLayout* layout = &sensor->layout();
    const double rate = 1000.0;
    return articulated_simulation(scene, {&layout, 1}, {&rate, 1}, 0);
  }
};

TEST_F(ContactScene, StageRunsToItsEndWithASetting) {
  const auto simulation = bench_of("contact: {cone: elliptic, noslip: 3, solref: [0.002, 1], tip_mass: 10 g}\n");
  for (std::size_t tick = 0; tick < simulation->ticks(0); ++tick) simulation->step();
  EXPECT_EQ(simulation->contact(0).state, PadState::gross);
}

// 10 time constants, of at least two steps; of any length if nothing is pressed in. A minute's
// steps are refused if something is.
TEST(MujocoContact, SettlesForTenTimeConstants) {
  const auto steps = [](double time_constant, double step, bool indented) {
    return steps_to_settle(user_pillars(contact({{"solref", std::vector<double>{time_constant, 1.0}}}), step), indented);
  };
  EXPECT_EQ(steps(0.02, 1e-3, true), 200);
  EXPECT_EQ(steps(0.02, 0.1, true), 20);
  EXPECT_EQ(steps(0.02, 2e-6, true), 100'000);
  EXPECT_THROW(steps(0.02, 1.99e-6, true), SceneValueError);
  EXPECT_EQ(steps(0.02, 1e-3, false), 200) << "as where tips are pressed in: labels do not hang on rounding";
  EXPECT_EQ(steps(300.0, 1e-3, false), 1);
  EXPECT_EQ(steps(1e9, 1e-3, false), 1) << "more than an int holds";
  const PillarSettings direct = user_pillars(contact({{"solref", std::vector<double>{-1e4, -200.0}}}), 1e-3);
  EXPECT_EQ(steps_to_settle(direct, true), 100) << "2/(200 /s) = 10 ms";
}

// MuJoCo needs an inertia of more than 1e-15 kg m2: a tip is a ball of radius 0.1 mm, with 2/5 m r^2
// for m above 2.5e-7 kg.
TEST(MujocoContact, TipsTooLightForMuJoCoAreRefused) {
  EXPECT_THAT(refusal_of<SceneValueError>([] {
                user_pillars(contact({{"tip_mass", 2.4e-7}}), 1e-3);
              }),
              refused_at("contact.tip_mass", {"2.4e-07 kg", "2.5e-07 kg"}));
  EXPECT_NO_THROW(
      ArticulatedStage(oracle::nine_pillars(1, k_n, k_t), Plane{}, {mu, mu}, user_pillars(contact({{"tip_mass", 2.6e-7}}), dt)));
}

// Tips of 0.1 g on 7.1 kN/m vibrate at 8,400 rad/s; explicit springs are stable up to 2/8,400 s =
// 0.24 ms.
TEST_F(ContactScene, ARunThatDivergesEndsWithMuJoCosWarning) {
  const auto simulation = bench_of("contact: {tip_mass: 0.1 g}\n");
  const std::string said = refusal_of([&] {
    for (std::size_t tick = 0; tick < simulation->ticks(0); ++tick) simulation->step();
  });
  EXPECT_THAT(said, StartsWith("the simulation has diverged: MuJoCo warns: Nan, Inf or huge value in Q"));
  EXPECT_THAT(said, HasSubstr(" (at 0."));
  // 2 sqrt(1e-4/7100) s = 0.23736 ms
  EXPECT_THAT(said, HasSubstr("at most 0.2373 ms"));
}

}  // namespace
}  // namespace slipbench::mujoco_contact_test

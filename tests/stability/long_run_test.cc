// Long runs without drift: 10,000 cycles of stick and slip, 1,000 touch-downs. (Ten minutes of
// hold: tests/sim/mujoco.)
#include <limits>
#include <numbers>

#include "sim/mujoco/articulated/articulated_stage.h"
#include "tests/oracle/effect_field.h"
#include "tests/sim/contact/random_case.h"
#include "tests/stability/hard_case.h"

namespace slipbench::hard {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int cycles = 1000, touches = 100;  // enough for the sanitisers
#else
constexpr int cycles = 10000, touches = 1000;
#endif

// A tip of mass m on k_t, w = sqrt(k_t/m), dragged at v (closed form 5; derived in
// tests/oracle/inertia_test.cc): from sticking until mu_s N the force falls to (2 mu_k - mu_s) N
// within a slip of 2 (pi - atan(D w/v))/w, D = (mu_s - mu_k) N/k_t, and takes 2 D/v to recover.
//
// Bounds. Positions are exact to epsilon X, with X the distance so far, which is epsilon X/v in the
// time of a change; a cycle has two changes, each computed from a few differences of positions. So
// a period is off by at most 10 epsilon X/v anywhere in the run, a thousand of them together by at
// most a thousand times that, and a force by 10 epsilon k_t X.
TEST(LongRun, TenThousandCyclesOfStickAndSlipKeepPeriodAndDrop) {
  constexpr double k_normal = 1000.0, k_tangential = 300.0, depth = 1e-3, load = k_normal * depth, frequency = 180.0, v = 33e-3;
  const Friction friction{0.6, 0.4};
  const PadLayout pad = testing_field::one_element(k_normal, k_tangential);
  const double omega = 2.0 * std::numbers::pi * frequency, gap = (friction.mu_static - friction.mu_kinetic) * load / k_tangential;
  const double period = 2.0 * (std::numbers::pi - std::atan(gap * omega / v)) / omega + 2.0 * gap / v;
  const double drop = 2.0 * (friction.mu_static - friction.mu_kinetic) * load;
  for (const double dt : {1e-3, 3.3e-3}) {
    Field field =
        oracle::field_with_effect(pad, friction, "inertia", {{"frequency", frequency}, {"damping", 0.0}, {"scatter", 0.0}});
    const Eigen::Vector2d along = v * Eigen::Vector2d(std::cos(0.7), std::sin(0.7));  // askew
    std::vector<double> slips, drops;
    for (int tick = 0; static_cast<int>(drops.size()) < cycles; ++tick) {
      const double time = tick * dt;
      Pose pose;
      pose.position << time * along, -depth;
      field.step(pose, dt);
      for (const ElementEvent& event : field.events()) {
        if (tick == 0) continue;
        const double after = (1.0 - event.fraction) * dt;
        if (event.to == ElementState::slip) slips.push_back(time - after);
        // Since the tip stopped the force has grown by k v; it fell from mu_s N.
        if (event.to == ElementState::stick && !slips.empty()) {
          const double now = field.tangential_force(0).head<2>().dot(along) / v;
          drops.push_back(friction.mu_static * load - (now - k_tangential * v * after));
        }
      }
    }
    const double way = v * period * cycles, bound = 10.0 * epsilon * way / v;
    double worst_period = 0.0, worst_drop = 0.0;
    for (std::size_t n = 1; n < slips.size(); ++n)
      worst_period = std::max(worst_period, std::abs(slips[n] - slips[n - 1] - period));
    for (const double fallen : drops) worst_drop = std::max(worst_drop, std::abs(fallen - drop));
    RecordProperty("period_off_" + std::to_string(dt), std::to_string(worst_period / period * 1e12) + "e-12");
    RecordProperty("drop_off_" + std::to_string(dt), std::to_string(worst_drop / drop * 1e12) + "e-12");
    EXPECT_LT(worst_period, bound);
    EXPECT_LT(worst_drop, 10.0 * epsilon * k_tangential * way);
    // Compares the first and the last tenth of the run.
    const std::size_t part = static_cast<std::size_t>(cycles) / 10;
    const double first = (slips[part] - slips[0]) / static_cast<double>(part),
                 last = (slips[slips.size() - 1] - slips[slips.size() - 1 - part]) / static_cast<double>(part);
    EXPECT_NEAR(last, first, bound);
    EXPECT_LT(bound, 1e-10 * period);
  }
}

// Down, sideways and up, repeatedly along the same poses: a pad of nine elements, askew, which
// sticks, slips and separates. A touch-down keeps nothing of the one before, so all have
// bit-identical forces.
Pose pressing(int tick) {  // 40 ticks per touch-down
  const double phase = 2.0 * std::numbers::pi * tick / 40.0;
  Pose pose;
  pose.rotation = (Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.013, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(0.05 * std::sin(phase), Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.position = {2e-3 * std::sin(phase), 1e-3 * std::cos(2.0 * phase), 1e-3 * std::cos(phase)};
  return pose;
}

TEST(LongRun, AThousandTouchDownsOfAFieldAreTheSameToTheBit) {
  Field field(flat_square(3, 7e-3, k_n, k_t), Plane{}, {0.5, 0.4});
  std::vector<double> first;
  for (int touch = 0; touch < touches; ++touch) {
    std::vector<double> forces;
    bool slips = false, sticks = false;
    for (int tick = 0; tick < 40; ++tick) {
      field.step(pressing(tick), 1e-3);
      const Wrench wrench = field.wrench_on_pad();
      for (const double value : wrench.force) forces.push_back(value);
      for (const double value : wrench.torque) forces.push_back(value);
      for (std::size_t i = 0; i < field.size(); ++i) {
        slips = slips || field.state(i) == ElementState::slip;
        sticks = sticks || field.state(i) == ElementState::stick;
      }
      if (tick == 0) {
        ASSERT_EQ(field.touching(), 0U) << "it has let go of all";
      }
    }
    ASSERT_TRUE(slips && sticks);
    if (touch == 0) first = forces;
    ASSERT_EQ(forces, first) << touch;
  }
}

// An articulated pad is solved iteratively, starting from the step before: its touch-downs are
// equal within the solver's tolerance of 1e-10. (Measured: bit-identical.)
TEST(LongRun, AThousandTouchDownsOfArticulatedPillarsAreAlike) {
  ArticulatedStage simulation(flat_square(3, 7e-3, k_n, k_t), Plane{}, {0.5, 0.5}, 1e-3);
  std::vector<double> first;
  double worst = 0.0, largest = 0.0;
  for (int touch = -1; touch < touches; ++touch) {  // before the first one it has not moved
    std::vector<double> forces;
    for (int tick = 0; tick < 40; ++tick) {
      const ContactFrame& frame = simulation.step(pressing(tick), 1e-3 * (40 * (touch + 1) + tick));
      for (const double value : frame.force.reshaped()) forces.push_back(value);
    }
    if (touch < 0) continue;
    if (touch == 0) first = forces;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      worst = std::max(worst, std::abs(forces[i] - first[i]));
      largest = std::max(largest, std::abs(first[i]));
    }
  }
  RecordProperty("worst", exact(worst / largest));
  EXPECT_LT(worst, 1e-10 * largest);
}

// A box of 100 g on a guide bounces on a pad without dashpots, touching askew. Stepped velocity
// first, in flight and in contact the invariant is
//   Q = v^2/2 + g x + k x^2/(2 m) - (h v/2) (g + k x/m)                                 (x < 0 in the pad, else without k)
// A step that ends inside with x = f h v has the share f in the pad: Q changes by -(z v)^2 f (1 -
// f)/2, z = h omega, and with the opposite sign where the box leaves. So a bounce changes the
// energy by z^2 (f' (1 - f') - f (1 - f)), at most z^2/4 either way: zero mean, and a standard
// deviation of z^2 sqrt(2/180) if f and f' are practically random. After n bounces: 0.105 z^2
// sqrt(n), of which five are allowed.
TEST(LongRun, AThousandBouncesNeitherGainNorLose) {
  const double mass = 0.1, omega = std::sqrt(9.0 * k_n / mass), high = 0.2e-3, speed = std::sqrt(2.0 * g * high);
  for (const char* integrator : {"Euler", "implicitfast", "discrete"}) {
    for (const double phase : {0.1, 0.05}) {
      const double step = longest_sample / std::ceil(longest_sample * omega / phase), z = step * omega;
      const double bounce = 2.0 * speed / g + 1.2 * std::numbers::pi / omega;
      const std::string model =
          "<mujoco><compiler angle='radian'/><option integrator='" + std::string(integrator) + "' gravity='0 0 " + exact(-g) +
          "'/><worldbody><site name='pad' zaxis='0 0 -1'/><body name='box' pos='0 0 " + exact(high) +
          "'><joint type='slide' axis='0 0 1'/><geom name='box' type='box' pos='0 0 0.02' axisangle='0.5 0.7 0 0.001' size='0.04 0.04 0.02' mass='" +
          exact(mass) + "'/></body></worldbody></mujoco>";
      const std::string scene =
          "slipbench: 1\nmodel: box.xml\nduration: " +
          exact(longest_sample * std::ceil(touches * bounce * 1.1 / longest_sample)) + " s\ntime_step: " + exact(step) +
          " s\nfriction: {static: 0.5}\nsensors: {pad: {type: papillarray, site: pad, touches: [box], damping: 0 s}}\n";
      const PadLayout pad = flat_square(3, 7e-3, k_n, k_t);
      CaseRun run(scene, "box.xml", model, {&pad});
      int bounces = 0;
      bool flying = true, begun = false;
      double worst = 0.0, start = 0.0;
      while (bounces < touches) {
        run.step();
        const bool flies = run->contact(0).state == PadState::no_contact;
        if (flies && (!flying || !begun)) {  // it has just left, or been released
          // Position and velocity are those of the step's end; the box flew during the step.
          const double v = run->data()->qvel[0], energy = 0.5 * v * v + g * run->data()->qpos[0] - 0.5 * g * step * v;
          if (!begun) start = energy;
          bounces += begun ? 1 : 0;
          begun = true;
          worst = std::max(worst, std::abs(energy - start) / (g * high));
        }
        flying = flies;
      }
      RecordProperty(std::string(integrator) + "_" + std::to_string(phase), exact(worst / (z * z)));
      EXPECT_LT(worst, 5.0 * std::sqrt(2.0 / 180.0) * z * z * std::sqrt(static_cast<double>(touches)))
          << integrator << ", z " << z;
    }
  }
}

}  // namespace
}  // namespace slipbench::hard

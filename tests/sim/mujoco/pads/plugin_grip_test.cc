// Two pads of the plugin hold, drop, slide and shake a free box, under MuJoCo's own integrators.
#include <gtest/gtest.h>

#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

// The box hangs on 18 tangential springs of 500 N/m: it sinks by m g/(18 k_t) = 0.109 mm and stays
// there.
constexpr double sag = 0.1 * g / (18.0 * 500.0);

class PluginGrip : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Integrators, PluginGrip, testing::Values("Euler", "implicit", "implicitfast", "discrete", "RK4"));

TEST_P(PluginGrip, HeldBoxDoesNotCreep) {
  GripRun run({.integrator = GetParam()});
  run.hold(1.2);
  run.wait(0.5);
  const double begin = run.height();
  run.wait(10.0);
  const double creep = (run.height() - begin) / 10.0;
  RecordProperty("creep_um_per_s", figure(creep * 1e6));
  EXPECT_LT(std::abs(creep), 0.01e-6);
  // A second after the last change the box is at rest: the pads carry its weight, up to rounding.
  const double carried = force_of_pad(run.m(), run.d(), 0).z() + force_of_pad(run.m(), run.d(), 1).z();
  RecordProperty("weight_error", figure(carried / (0.1 * g) - 1.0));
  EXPECT_NEAR(carried, 0.1 * g, 1e-8 * 0.1 * g);
}

TEST_P(PluginGrip, SlidesAtTheDifferenceOfWeightAndFriction) {
  // Half the threshold: m a = m g - 2 mu F = m g/2, because friction is the same at every element
  // and speed.
  GripRun run({.integrator = GetParam(), .perturbed = false});
  // The grip is reduced smoothly, over 0.1 s: a box released at once rings on its springs while it
  // slides.
  run.hold(1.2 * run.threshold());
  for (int i = 1; i <= 100; ++i) {
    run.d()->ctrl[0] = run.threshold() * (0.85 + 0.35 * std::cos(std::numbers::pi * i / 100));
    mj_step(run.m(), run.d());
  }
  run.wait(0.04);
  const double before = run.d()->qvel[2];
  run.wait(0.02);
  EXPECT_GT(run.height(), -0.05) << "it has left the pads, its half length being 60 mm";
  RecordProperty("acceleration_error", figure((before - run.d()->qvel[2]) / (0.02 * 0.5 * g) - 1.0));
  EXPECT_NEAR((run.d()->qvel[2] - before) / 0.02, -0.5 * g, 3e-4 * 0.5 * g);
}

// The weight slips when it reaches the friction limit; loaded smoothly, nothing else pulls. A box
// that is 0.1 % too heavy falls with 0.1 % of g, 4.9 mm in a second; one that holds hangs on its
// springs.
void expect_threshold(const Grip& grip, double within, double hangs_by) {
  const std::string name = grip.integrator + ", mu " + std::to_string(grip.mu);
  GripRun under(grip);
  under.hold((1.0 - within) * under.threshold());
  under.wait(1.0);
  EXPECT_LT(under.height(), -10.0 * hangs_by) << name << ", under the threshold";
  GripRun over(grip);
  over.hold((1.0 + within) * over.threshold());
  over.wait(3.0);  // a tilted box turns about the pads' axis at w = 66 rad/s, damped by tau w^2/2 = 2.2/s
  const double begin = over.height();
  over.wait(1.0);
  EXPECT_NEAR(over.height(), begin, 0.01e-6) << name << ", over the threshold";
  EXPECT_GT(over.height(), -1.5 * hangs_by - 0.2e-3) << name << ", over the threshold";
}

TEST_P(PluginGrip, DropsJustUnderTheThresholdAndHoldsJustOverIt) {
  for (const double mu : {0.2, 0.5, 1.0}) {
    expect_threshold({.mu = mu, .integrator = GetParam(), .perturbed = false}, 0.001, sag);
    // With a turn by some mrad, an element may slip before the others and leave them its share.
    expect_threshold({.mu = mu, .integrator = GetParam(), .perturbed = true}, 0.003, sag);
  }
}

TEST_P(PluginGrip, RealPillarsHaveTheSameThreshold) {
  // 2 pads of up to nine pillars of 7.1 and 3.9 kN/m on 0.1 kg: w = sqrt(18*7100/0.1) = 1130 rad/s,
  // and 0.75/w = 0.66 ms. At the lightest grip only the centre pillars touch: the box hangs by m
  // g/(2 k_t) = 0.126 mm.
  for (const double mu : {0.2, 0.5, 1.0}) {
    expect_threshold(
        {.mu = mu, .dt = 5e-4, .integrator = GetParam(), .left = real_pillars(), .right = real_pillars(), .perturbed = false},
        0.001, 0.126e-3);
  }
}

TEST(PluginGrip, MujocosOwnContactCreepsInTheSameScene) {
  // The same box, fingers, friction and grip, held by MuJoCo's contact with its defaults:
  // regularised friction creeps (measured between boxes: 1.7 mm/s), at least 10,000 times the
  // plugin's limit.
  GripRun run({.left = "", .right = ""});
  run.hold(1.2);
  const double begin = run.height();
  run.wait(2.0);
  const double creep = (begin - run.height()) / 2.0;
  RecordProperty("creep_um_per_s", figure(creep * 1e6));
  EXPECT_GT(creep, 100e-6);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double long_hold = 30.0;  // s; enough for the sanitizers
#else
constexpr double long_hold = 600.0;
#endif

TEST(PluginGrip, HoldsForTenMinutes) {
  GripRun run({});
  run.hold(1.2);
  run.wait(0.5);
  const double begin = run.height();
  run.wait(long_hold);
  RecordProperty("moved_um", figure((run.height() - begin) * 1e6));
  EXPECT_NEAR(run.height(), begin, 1e-6);
}

// Bit-identical to pads of the same elements in a table.
TEST(PluginGrip, LayoutsAreHandedOverInMemory) {
  PadLayout layout;
  for (int i = 0; i < 9; ++i) {
    Element& element = layout.elements.emplace_back();
    element.tip = {0.007 * (i / 3 - 1), 0.007 * (i % 3 - 1), 0.0};
    element.k_normal = 3000.0;
    element.k_tangential = 500.0;
    layout.units.push_back({layout.units.size(), 1});
  }
  LayoutsInMemory layouts_in_memory;
  GripRun table({}), memory({.left = config("elements", layouts_in_memory.add(layout)),
                             .right = config("elements", layouts_in_memory.add(layout))});
  for (GripRun* run : {&table, &memory}) {
    run->hold(1.2);
    run->wait(0.5);
  }
  EXPECT_LT(table.height(), 0.13e-3 - 0.9 * sag);  // it hangs on the pads
  EXPECT_EQ(memory.height(), table.height());
}

TEST(PluginGrip, ShakenAt50HzSlipsAtTheAmplitudeOfMassTimesAcceleration) {
  // Shaken along z with the acceleration a sin(w t), in the frame of the hand, the box strains its
  // springs, z'' + (c/m) z' + (k/m) z = -a sin, with k = 18*3900 N/m and c = tau k: the pads' force
  // has the amplitude m a |1 + i w tau|/|1 - (w/w0)^2 + i w tau|, 1.16 m a here. The box slips when
  // this reaches 2 mu F. tau is short, so that springs plus dashpots (held on the cone) equal the
  // springs to 0.05 %.
  const double mass = 0.1, mu = 0.5, force = 8.0, w = 2.0 * std::numbers::pi * 50.0, tau = 1e-4,
               w0_squared = 18.0 * 3900.0 / mass;
  const double gain = std::hypot(1.0, w * tau) / std::hypot(1.0 - w * w / w0_squared, w * tau);
  const double exact = 2.0 * mu * force / (mass * gain);
  const std::string pad = config("elements", square(3, 0.007, 7100.0, 3900.0)) + config("damping", "0.1 ms");
  for (const double part : {0.99, 1.01}) {
    GripRun run({.mass = mass, .mu = mu, .dt = 1e-4, .left = pad, .right = pad, .perturbed = false});
    run.close(force);
    for (int i = 0; i < 15000; ++i) {
      const double t = 1e-4 * i, grown = std::min(1.0, t);  // grown over 50 periods; ringing decays with tau w0^2/2 = 35/s
      run.m()->opt.gravity[2] = part * exact * grown * std::sin(w * t);
      mj_step(run.m(), run.d());
    }
    const double slipped = pad_of(run.m(), run.d(), 0)->truth(FramePart::all).slip_distance.maxCoeff();
    if (part < 1.0) {
      EXPECT_EQ(slipped, 0.0);
    } else {
      EXPECT_GT(slipped, 1e-6);
    }
  }
}

}  // namespace
}  // namespace slipbench::testing_plugin

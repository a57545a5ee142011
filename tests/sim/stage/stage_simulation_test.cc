// The bench: time steps, refusals, and the combination of pads, motion and surface.

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/motion/motion_catalogue.h"
#include "sim/scene/catalogues.h"
#include "tests/expect.h"
#include "tests/sim/stage/simulation_rig.h"

namespace slipbench::testing_bench {
namespace {

const PadLayout pillars = oracle::nine_pillars();

std::string refusal(const Scene& scene, const std::vector<double>& rates) {
  return refusal_of([&] { simulation(scene, std::vector<const PadLayout*>(rates.size(), &pillars), rates); });
}

TEST(StageSimulation, TicksCoverTheDurationFromZero) {
  const Scene asked = scene();
  StageSimulation b = simulation(asked, {&pillars}, {1000.0});
  EXPECT_EQ(b.ticks(0), 4000U);
  EXPECT_EQ(b.time_step(0), 1e-3);
  EXPECT_EQ(b.stride(0), 1U);
  b.step();
  EXPECT_EQ(b.contact(0).time, 0.0);
  EXPECT_EQ(b.bodies()[0].state.pose.position.z(), 0.5e-3) << "the gap";
  for (std::size_t tick = 1; tick < b.ticks(0); ++tick) b.step();
  EXPECT_DOUBLE_EQ(b.contact(0).time, 3.999);
}

TEST(StageSimulation, PressesAndSlidesAsTheSceneSays) {
  // Touch: 0.5 mm below the start at 4 mm/s after a ramp of 0.16 mm in 0.08 s: 0.08 + 0.34/4 =
  // 0.165 s. The centre slips when s(t) = mu k_n d/k_t = 0.910 mm: 2 + 0.04 + 0.910/4.
  const Scene asked = scene();
  StageSimulation b = simulation(asked, {&pillars}, {1000.0});
  double touch = 0.0, slip = 0.0;
  for (std::size_t tick = 0; tick < b.ticks(0); ++tick) {
    b.step();
    for (const ContactEvent& event : b.contact(0).events) {
      if (event.unit != 4) continue;
      if (event.kind == EventKind::touch) touch = event.time;
      if (event.kind == EventKind::slip) slip = event.time;
    }
  }
  EXPECT_NEAR(touch, 0.165, 1e-12);
  EXPECT_NEAR(slip, 2.04 + 0.5 * 7100.0 * 1e-3 / (3900.0 * 4e-3), 1e-9);
  EXPECT_EQ(b.contact(0).state, PadState::gross);
  EXPECT_NEAR(b.contact(0).force(2, 4), 7.1, 1e-12);
  EXPECT_NEAR(b.contact(0).force(0, 4), -3.55, 1e-12);
  EXPECT_FALSE(b.rotating());
}

TEST(StageSimulation, BodiesAreThePadAndTheSurface) {
  Scene asked = scene(1, {{"rotation", 0.3}});
  asked.surface = named(surface_catalogue(), "box", {{"position", std::vector<double>{1e-3, 2e-3}}});
  StageSimulation b = simulation(asked, {&pillars}, {1000.0});
  EXPECT_TRUE(b.rotating());
  for (int tick = 0; tick <= 3000; ++tick) b.step();
  ASSERT_EQ(b.bodies().size(), 2U);
  EXPECT_EQ(b.bodies()[0].name, "pad");
  EXPECT_EQ(b.bodies()[1].name, "surface");
  const auto motion = motion_catalogue().front().create(asked.motion.parameters, {});
  const BodyState expected = motion->pad_at(3.0);
  EXPECT_NEAR((b.bodies()[0].state.pose.position - expected.pose.position).norm(), 0.0, 1e-15);
  EXPECT_NEAR((b.bodies()[0].state.pose.rotation - expected.pose.rotation).norm(), 0.0, 1e-14);
  EXPECT_NEAR((b.bodies()[0].state.velocity - expected.velocity).norm(), 0.0, 1e-15);
  EXPECT_NEAR((b.bodies()[0].state.angular_velocity - expected.angular_velocity).norm(), 0.0, 1e-15);
  EXPECT_EQ(b.bodies()[1].state.pose.position, Eigen::Vector3d(1e-3, 2e-3, -50e-3));  // a box of 100 mm
  EXPECT_EQ(b.bodies()[1].state.velocity.norm(), 0.0);
}

TEST(StageSimulation, SensorsOfDifferentRatesRideOnTheSameStage) {
  const PadLayout bristles = oracle::nine_pillars(6);
  const Scene asked = scene(2);
  StageSimulation b = simulation(asked, {&pillars, &bristles}, {1000.0, 250.0});
  EXPECT_EQ(b.stride(0), 1U);
  EXPECT_EQ(b.stride(1), 4U);
  for (int tick = 0; tick <= 2100; ++tick) b.step();
  EXPECT_EQ(b.contact(0).time, b.contact(1).time);
  for (Eigen::Index p = 0; p < 9; ++p)
    EXPECT_NEAR(b.contact(0).force(2, p), b.contact(1).force(2, p), 1e-12) << "same stiffness in all";
  // After 2.1 s the pad has moved by 4 mm/s (0.1 - 0.04) s = 0.24 mm: the lightest bristles have
  // slipped (0.4 of 0.50 mm), but no pillar has.
  EXPECT_EQ(b.contact(0).state, PadState::non_slip);
  EXPECT_EQ(b.contact(1).state_micro, PadState::incipient);
}

TEST(StageSimulation, AutomaticStepIsEachSensorsOwnSamplingTime) {
  Scene asked = scene(2);
  asked.time_step.reset();
  const StageSimulation b = simulation(asked, {&pillars, &pillars}, {250.0, 1000.0});
  EXPECT_DOUBLE_EQ(b.time_step(0), 4e-3);
  EXPECT_DOUBLE_EQ(b.time_step(1), 1e-3);
  EXPECT_EQ(b.stride(0), 1U);
  EXPECT_EQ(b.ticks(0), 1000U);
  EXPECT_EQ(b.ticks(1), 4000U);
}

TEST(StageSimulation, StepMustResolveTheTexture) {
  // Ridges of 0.2 mm under 4 mm/s down and 16 mm/s sideways: 0.2 mm/(16 x 20 mm/s) = 0.625 ms.
  Scene asked = scene(1, {{"speed", 16e-3}});
  asked.effects = {named(effect_catalogue(), "texture", {{"wavelength", 0.2e-3}})};
  EXPECT_THAT(refusal(asked, {1000.0}), refused_at("time_step", {"1 ms", "0.625 ms"}));
  asked.time_step = 0.5e-3;
  EXPECT_EQ(refusal(asked, {1000.0}), "accepted");
  asked.time_step.reset();  // the longest step that divides 1 ms: one half
  const StageSimulation b = simulation(asked, {&pillars}, {1000.0});
  EXPECT_DOUBLE_EQ(b.time_step(0), 0.5e-3);
  EXPECT_EQ(b.stride(0), 2U);
  EXPECT_EQ(b.ticks(0), 8000U);
}

// A tip at r that carries mu k_n d/k_t = q trails its root on the circle rho^2 = r^2 - q^2, so it
// slips omega rho t. In steps of the angle a the slip is shorter by a^2/24 + (q/rho) a/2
// (sim/motion/README.md): with a up to 3 deg and q/rho = 0.5/8 by up to 0.18 %.
TEST(StageSimulation, AutomaticStepResolvesTheRotation) {
  constexpr double r = 8e-3, q = 0.5e-3, deg = std::numbers::pi / 180.0;
  PadLayout taxel;
  taxel.units.push_back({0, 1});
  taxel.elements.push_back({.tip = {r, 0.0, 0.0}, .k_normal = 1000.0, .k_tangential = 1000.0});
  for (const double rate : {360.0 * deg, 1800.0 * deg, 5625.0 * deg}) {
    Scene asked = scene(1, {{"speed", 0.0}, {"rotation", rate}, {"angular_acceleration", 1e9}});
    asked.time_step.reset();
    StageSimulation stage = simulation(asked, {&taxel}, {25.0});
    EXPECT_LE(stage.time_step(0) * rate, 3.0 * deg * (1.0 + 1e-12));
    EXPECT_EQ(stage.ticks(0), 100 * stage.stride(0));
    double from = 0.0, slipped = 0.0, to = 0.0;
    for (std::size_t tick = 0; tick < stage.ticks(0); ++tick) {
      stage.step();
      const ContactFrame& frame = stage.contact(0);
      if (frame.time < 3.0) continue;
      if (from == 0.0) {
        from = frame.time;
        slipped = frame.slip_distance[0];
      }
      to = frame.time;
    }
    const double exact = rate * std::sqrt(r * r - q * q) * (to - from);
    EXPECT_NEAR(stage.contact(0).slip_distance[0] - slipped, exact, 2e-3 * exact) << rate;
    EXPECT_LT(stage.contact(0).slip_distance[0] - slipped, exact * (1.0 - 1e-4)) << "the bound is in use";
  }
}

// A slide of w after a press slips w less the stretch mu k_n d/k_t. Automatic steps lose at most
// 1 % of w where the press ends, whatever the sensor's rate.
TEST(StageSimulation, AutomaticStepSeparatesPressSlideAndLift) {
  constexpr double stretch = 0.05e-3, inf = std::numeric_limits<double>::infinity();
  PadLayout taxel;
  taxel.units.push_back({0, 1});
  taxel.elements.push_back({.tip = {0.0, 0.0, 0.0}, .k_normal = 1000.0, .k_tangential = 10'000.0});
  const auto slipped = [&](const Changes& times) {
    Changes motion{{"acceleration", inf}, {"gap", 1e-3}, {"compression", 1e-3}, {"approach_speed", 0.1}, {"speed", 0.1}};
    motion.insert(motion.end(), times.begin(), times.end());
    Scene asked = scene(1, motion);
    asked.time_step.reset();
    StageSimulation stage = simulation(asked, {&taxel}, {1.0});
    double before_lift = 0.0;
    for (std::size_t tick = 0; tick < stage.ticks(0); ++tick) {
      stage.step();
      if (stage.contact(0).unit_state[0] != UnitState::detached) before_lift = stage.contact(0).slip_distance[0];
    }
    return before_lift;
  };
  // Pressed at 20 ms, when the slide of 2 mm starts at once, or of 20 mm after 10 ms, before a lift.
  EXPECT_NEAR(slipped({{"start", 0.02}, {"stop", 0.02}}), 2e-3 - stretch, 0.01 * 2e-3);
  EXPECT_NEAR(slipped({{"start", 0.03}, {"travel", 20e-3}, {"retract", 0.3}}), 20e-3 - stretch, 0.01 * 20e-3 + stretch);
}

TEST(StageSimulation, StepMustResolveTheMotion) {
  // 3 deg at 360 deg/s are 8.333 ms; the longest step that divides 20 ms is a third of it.
  const double turn = 2.0 * std::numbers::pi;
  Scene asked = scene(1, {{"speed", 0.0}, {"rotation", turn}});
  asked.time_step = 20e-3;
  EXPECT_THAT(refusal(asked, {50.0}), refused_at("time_step", {"20 ms", "motion", "8.333"}));
  asked.time_step.reset();
  EXPECT_DOUBLE_EQ(simulation(asked, {&pillars}, {50.0}).time_step(0), 20e-3 / 3.0);
  // An exactly representable turn: 3 deg/10 ms = 300 deg/s needs no division of 10 ms.
  asked = scene(1, {{"speed", 0.0}, {"rotation", 299.0 * turn / 360.0}});
  asked.time_step.reset();
  EXPECT_DOUBLE_EQ(simulation(asked, {&pillars}, {100.0}).time_step(0), 10e-3);
}

TEST(StageSimulation, AutomaticStepsAreLimitedInNumber) {
  // 10^8 steps last 10,000 s at 10 kHz.
  Scene asked = scene();
  asked.time_step.reset();
  asked.duration = 20000.0;
  EXPECT_THAT(refusal(asked, {10e3}), refused_at("sensors.pad0.rate", {"10 kHz", "100,000,000", "5000 Hz", "10000 s"}));
  EXPECT_EQ(refusal(asked, {5e3}), "accepted");
  // Ridges of 0.2 um at up to 8 mm/s need steps of 0.2 um/(16 x 8 mm/s) = 1.5625 us; 1 ms holds 640
  // of them: 6.4e8 in 1,000 s.
  asked = scene();
  asked.time_step.reset();
  asked.duration = 1000.0;
  asked.effects = {named(effect_catalogue(), "patchy_friction", {{"shortest", 0.2e-6}, {"longest", 0.2e-6}})};
  EXPECT_THAT(refusal(asked, {1000.0}), refused_at("duration", {"1000 s", "1.562 us", "effects", "156.25 s"}));
}

// The bench is chosen before, so other scenes arriving here are a bug.
TEST(StageSimulation, ScenesOfOtherBenchesAreABug) {
  Scene articulated = scene(), dynamic = scene();
  articulated.fidelity = "articulated";
  dynamic.model = "robot.xml";
  EXPECT_THROW(simulation(articulated, {&pillars}, {1000.0}), std::logic_error);
  EXPECT_THROW(simulation(dynamic, {&pillars}, {1000.0}), std::logic_error);
}

TEST(StageSimulation, RefusesWhatItCannotDo) {
  Scene asked = scene();
  asked.duration = 3.9995;
  EXPECT_THAT(refusal(asked, {1000.0}), refused_at("duration", {"3.9995 s", "1 ms"}));
  asked.duration = 0.4e-3;
  EXPECT_THAT(refusal(asked, {1000.0}), refused_at("duration", {"0.4 ms", "1 ms"}));
  asked = scene(2);
  asked.time_step.reset();
  asked.duration = 0.015;
  EXPECT_THAT(refusal(asked, {1000.0, 100.0}), refused_at("duration", {"15 ms", "10 ms", "pad1"}));

  asked = scene();
  asked.time_step = 2e-3;
  EXPECT_THAT(refusal(asked, {1000.0}), refused_at("time_step", {"2 ms", "1 ms", "pad0"}));
  asked = scene(2);
  asked.time_step = 4e-3;
  EXPECT_THAT(refusal(asked, {250.0, 100.0}), refused_at("time_step", {"4 ms", "10 ms", "pad1"}));

  // Tilted about X by 0.3 rad, the tips at y = -7 mm are 7 mm sin(0.3) = 2.07 mm lower, and those
  // 0.2 or 0.45 mm shorter are closer by cos(0.3): the edge at 0.5 - 2.07 + 0.19 = -1.38 mm is
  // deepest.
  asked = scene();
  asked.motion.parameters.set("tilt", std::vector{0.3, 0.0});
  EXPECT_EQ(refusal(asked, {1000.0}).find("motion.gap: the pad starts 1.37"), 0U) << refusal(asked, {1000.0});

  // A crest of 5 mm is 7 mm from the middle (a quarter of the wavelength), under an edge pillar
  // that is 0.5 + 0.2 mm above the plane.
  asked = scene();
  asked.effects = {named(effect_catalogue(), "texture", {{"height", 5e-3}, {"wavelength", 28e-3}})};
  EXPECT_THAT(refusal(asked, {1000.0}), refused_at("motion.gap", {"4.3 mm", "gap"}));

  // Patches of 40 um under 4 mm/s down and 4 mm/s sideways: 40 um/(16 x 8 mm/s) = 312.5 us.
  asked = scene();
  asked.effects = {named(effect_catalogue(), "patchy_friction", {{"shortest", 40e-6}, {"longest", 40e-6}})};
  EXPECT_THAT(refusal(asked, {1000.0}), refused_at("time_step", {"1 ms", "0.3125 ms"}));

  asked = scene(1, {{"start", 0.1}});
  EXPECT_NE(refusal(asked, {1000.0}).find("motion.start"), std::string::npos);
  asked = scene();
  asked.surface = named(surface_catalogue(), "sphere");
  asked.effects = {named(effect_catalogue(), "patchy_friction")};
  EXPECT_NE(refusal(asked, {1000.0}).find("needs a flat surface"), std::string::npos);
}

TEST(StageSimulation, RefusesToPressThroughARoundShape) {
  // The dome of the pad reaches at least 0.8 mm below the first touch of its lowest pillars: beyond
  // the middle of a rod of 0.7 mm.
  Scene asked = scene();
  asked.surface = named(surface_catalogue(), "cylinder", {{"radius", 0.7e-3}});
  StageSimulation thin = simulation(asked, {&pillars}, {1000.0});
  EXPECT_THAT(refusal_of([&] {
                for (std::size_t tick = 0; tick < thin.ticks(0); ++tick) thin.step();
              }),
              AllOf(HasSubstr("passed through the shape, which is 1.4 mm thick"), HasSubstr("less motion.compression")));
}

TEST(StageSimulation, PressesOnAThinPlateByDepthTimesStiffness) {
  // 1 mm into a plate, deeper than half of it and deeper than all of it: as on a plate of 20 mm.
  PadLayout high = pillars;
  high.unit_height = 5e-3;
  const auto force_on = [&](double thickness) {
    Scene asked = scene();
    asked.surface = named(surface_catalogue(), "box", {{"size", std::vector{60e-3, 60e-3, thickness}}});
    StageSimulation stage = simulation(asked, {&high}, {1000.0});
    for (std::size_t tick = 0; tick < stage.ticks(0); ++tick) stage.step();
    return Eigen::Array3Xd(stage.contact(0).force);
  };
  const Eigen::Array3Xd thick = force_on(20e-3);
  EXPECT_GT(thick.row(2).maxCoeff(), 0.1);
  for (const double thickness : {1.5e-3, 0.5e-3}) EXPECT_LT((force_on(thickness) - thick).abs().maxCoeff(), 1e-9) << thickness;
}

TEST(StageSimulation, TrialAndSeedKeyTheEffectsDraws) {
  Scene asked = scene();
  asked.effects = {named(effect_catalogue(), "patchy_friction")};
  asked.seed = 3;
  const auto margin = [&](std::uint64_t seed, std::uint64_t trial) {
    asked.seed = seed;
    StageSimulation b = simulation(asked, {&pillars}, {1000.0}, trial);
    for (int tick = 0; tick <= 2030; ++tick) b.step();
    return b.contact(0).margin[4];
  };
  EXPECT_EQ(margin(3, 1), margin(3, 1));
  EXPECT_NE(margin(3, 1), margin(3, 2));
  EXPECT_NE(margin(3, 1), margin(4, 1));
}

TEST(StageSimulation, MovedBenchGoesOn) {
  const Scene asked = scene();
  StageSimulation first = simulation(asked, {&pillars}, {1000.0}), stayed = simulation(asked, {&pillars}, {1000.0});
  for (int tick = 0; tick < 1000; ++tick) first.step(), stayed.step();
  StageSimulation second(std::move(first));
  for (int tick = 0; tick < 1500; ++tick) second.step(), stayed.step();
  EXPECT_EQ(second.contact(0).time, stayed.contact(0).time);
  EXPECT_TRUE((second.contact(0).force == stayed.contact(0).force).all());
}

TEST(StageSimulation, CataloguesNameWhatTheBenchCanRun) {
  Catalogues catalogues;
  add_sim_catalogues(catalogues);
  EXPECT_EQ(catalogues.surfaces.size(), surface_catalogue().size());
  EXPECT_EQ(catalogues.motions.size(), motion_catalogue().size());
  EXPECT_EQ(catalogues.effects.size(), effect_catalogue().size());
  EXPECT_FALSE(catalogues.materials.empty());
}

}  // namespace
}  // namespace slipbench::testing_bench

// `fidelity: articulated` in scenes whose bodies move by forces: results and refusals.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/mujoco/articulated/articulated_stage.h"
#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"
#include "tests/sim/mujoco/bodies/dynamic_scenes.h"

namespace slipbench {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

const std::string held = held_box("fidelity: articulated\ntime_step: 1 ms\nduration: 1 s\ncontrols: {left: 4 N, right: 4 N}\n");

// Runs the scene to `time` [s].
std::string answer(const std::string& scene, const std::string& model = two_fingers(""), double time = 0.0) {
  const ModelFolder folder;
  folder.write("fingers.xml", model);
  return refusal_of([&] {
    DynamicRig rig(scene, folder.file("scene.yaml"));
    rig.run_to(time);
  });
}

// The stage over a fixed floor, once as a surface and once as a body.
TEST(ArticulatedScene, StageOverAFixedBodyIsThePrescribedBench) {
  const std::string motion =
      "fidelity: articulated\nduration: 1 s\ntime_step: 1 ms\nfriction: {static: 0.5, kinetic: 0.5}\n"
      "motion: {kind: stage, compression: 0.8 mm, speed: 8 mm/s, rotation: 20 deg/s, start: 0.5 s}\n";
  DynamicRig rig(motion +
                 "bodies: {floor: {shape: plane}}\n"
                 "sensors: {pad: {type: papillarray, touches: [floor], damping: 0 s}}\n");
  const Scene prescribed = parsed("slipbench: 1\n" + motion + "sensors: {pad: {type: papillarray}}\n");
  const std::unique_ptr<Sensor> sensor = make_sensor(prescribed.sensors.front(), 0, 0);
  const PadLayout* layout = &sensor->layout();
  const double rate = 1000.0;
  const auto simulation = articulated_simulation(prescribed, {&layout, 1}, {&rate, 1}, 0);
  ASSERT_EQ(rig->ticks(0), simulation->ticks(0));
  std::size_t slipping = 0;
  for (std::size_t tick = 0; tick < simulation->ticks(0); ++tick) {
    rig->step();
    simulation->step();
    const ContactFrame &one = rig->contact(0), &other = simulation->contact(0);
    ASSERT_EQ(one.time, other.time);
    ASSERT_EQ(one.unit_state, other.unit_state) << tick;
    // The solver stops at another digit, because its tolerance is relative to the model's inertia.
    ASSERT_LT((one.force - other.force).abs().maxCoeff(), 1e-6) << tick;
    for (const UnitState state : one.unit_state) slipping += state == UnitState::slip ? 1 : 0;
    const Pose &pad = rig.body("pad").pose, &reported = simulation->bodies().front().state.pose;
    ASSERT_LT((pad.position - reported.position).norm() + (pad.rotation - reported.rotation).norm(), 1e-15) << tick;
  }
  EXPECT_GT(slipping, 1000U) << "the comparison has seen a slide";
}

// A free box under unequal presses of the fingers starts at the scene's pose, not in equilibrium: a
// pillar whose tip lies z behind its pad's origin is 0.27 mm - z deep in the box's face, 0.1 mm
// less on the left if the box is 0.1 mm to the right, and as much more on the right.
TEST(ArticulatedScene, RunBeginsWithThePressesOfTheScenesPoses) {
  const ModelFolder folder;
  folder.write("fingers.xml", two_fingers(""));
  const double aside = 0.1e-3;
  for (const std::string mass : {"100 g", "5 g"}) {
    DynamicRig rig(replaced(replaced(held, "position: [0, 0, 0.1]", "position: [0.1 mm, 0, 0.1]"), "100 g", mass),
                   folder.file("scene.yaml"));
    rig.run_to(0.0);
    const std::unique_ptr<Sensor> sensor = make_sensor(rig.scene().sensors.front(), 0, 0);
    const PadLayout& layout = sensor->layout();
    ASSERT_EQ(layout.elements.size(), layout.units.size());
    for (const std::size_t pad : {0U, 1U}) {
      std::vector<std::uint32_t> touching;
      for (std::size_t u = 0; u < layout.units.size(); ++u) {
        const Element& pillar = layout.elements[u];
        const double depth = 0.27e-3 - pillar.tip.z() + (pad == 0 ? -aside : aside);
        EXPECT_NEAR(rig->contact(pad).contact_force(2, static_cast<Eigen::Index>(u)), pillar.k_normal * std::max(0.0, depth),
                    1e-6)
            << mass << ' ' << pad << ' ' << u;
        if (depth > 0.0) touching.push_back(static_cast<std::uint32_t>(u));
      }
      // As with fields, contacts present at the start begin at 0 s.
      std::vector<std::uint32_t> touched;
      for (const ContactEvent& event : rig->contact(pad).events) {
        EXPECT_EQ(event.time, 0.0);
        EXPECT_EQ(event.kind, EventKind::touch);
        touched.push_back(event.unit);
      }
      EXPECT_EQ(touched, touching);
      EXPECT_TRUE((rig->contact(pad).slip_distance == 0.0).all());
    }
    EXPECT_EQ(rig.body("box").pose.position.x(), aside);
  }
}

// A fixed pad under a box of 100 g, 0.2 mm inside it, without other contacts: the springs throw the
// box up with their energy, sum k_n delta^2/2 over m g, minus the dashpots' loss.
TEST(ArticulatedScene, ABoxPressedFromOneSideIsThrownByTheSpringsAlone) {
  const ModelFolder folder;
  folder.write("fingers.xml", "<mujoco><worldbody><site name='up' euler='180 0 0'/></worldbody></mujoco>");
  DynamicRig rig(
      "fidelity: articulated\nduration: 0.2 s\nfriction: {static: 0.5, kinetic: 0.5}\nmodel: fingers.xml\n"
      "bodies: {box: {shape: box, size: [40 mm, 40 mm, 20 mm], mass: 100 g, position: [0, 0, 9.8 mm]}}\n"
      "sensors: {pad: {type: papillarray, site: up, touches: [box]}}\n",
      folder.file("scene.yaml"));
  const std::unique_ptr<Sensor> sensor = make_sensor(rig.scene().sensors.front(), 0, 0);
  double stored = 0.0, highest = 0.0;
  for (const Element& pillar : sensor->layout().elements) {
    const double depth = std::max(0.0, 0.2e-3 - pillar.tip.z());
    stored += 0.5 * pillar.k_normal * depth * depth;
  }
  for (std::size_t tick = 0; tick < rig->ticks(0); ++tick) {
    rig->step();
    highest = std::max(highest, rig.body("box").pose.position.z() - 9.8e-3);
  }
  EXPECT_LT(highest, stored / weight_of_100_g);
  EXPECT_GT(highest, 0.2 * stored / weight_of_100_g);
}

// Drawn at v, a pillar under f_n with a dashpot tau in parallel with its spring k_t is held by k_t
// v (t + tau), and slips at mu f_n: tau before the field's pillar, whose labels use springs alone.
// Slip is also early by 0.6 sqrt(m/k_t) = 30 us (a free tip's damping), late by 0.2 steps of
// trailing (articulated_stage_test.cc), and late by 0.17 of a step: slip that begins at the share s
// of a step reaches only (1 - s) v/2 by its end while the dashpot relaxes (tau = h), and is then
// located at 2 s/(1 + s). The stage takes 1 ms to reach its speed and so is half of that behind.
TEST(ArticulatedScene, StageSlideIsEarlyByTheDashpotsTime) {
  const double speed = 8e-3, start = 0.5 + 0.5e-3, tau = 1e-3, dt = 1e-3, early = 0.6 * std::sqrt(1e-5 / 3900.0);
  DynamicRig rig(
      "fidelity: articulated\nduration: 0.8 s\ntime_step: 1 ms\nfriction: {static: 0.5, kinetic: 0.5}\n"
      "motion: {kind: stage, compression: 0.8 mm, speed: 8 mm/s, acceleration: 8 m/s2, start: 0.5 s}\n"
      "bodies: {floor: {shape: plane}}\nsensors: {pad: {type: papillarray, touches: [floor]}}\n");
  ASSERT_EQ(rig.scene().sensors.front().damping, tau) << "the default";
  const std::unique_ptr<Sensor> sensor = make_sensor(rig.scene().sensors.front(), 0, 0);
  const PadLayout& layout = sensor->layout();
  std::vector<double> slips(layout.units.size(), 0.0);
  for (std::size_t tick = 0; tick < rig->ticks(0); ++tick) {
    rig->step();
    for (const ContactEvent& event : rig->contact(0).events) {
      if (event.kind == EventKind::slip) slips[event.unit] = event.time;
    }
  }
  for (std::size_t u = 0; u < slips.size(); ++u) {
    const Element& pillar = layout.elements[u];
    const double of_field = start + 0.5 * pillar.k_normal * (0.8e-3 - pillar.tip.z()) / (pillar.k_tangential * speed);
    EXPECT_GT(slips[u], of_field - tau - early) << u;
    EXPECT_LT(slips[u], of_field - tau + 0.4 * dt) << u;
  }
}

// A tip is independent of the model's defaults for joints, geoms and pairs.
TEST(ArticulatedScene, DefaultsOfTheModelDoNotReachThePillars) {
  const auto height = [](const std::string& defaults) {
    const ModelFolder folder;
    folder.write("fingers.xml", replaced(two_fingers(""), "<worldbody>", defaults + "<worldbody>"));
    DynamicRig rig(held, folder.file("scene.yaml"));
    rig.run_to(0.3);
    return rig.body("box").pose.position.z();
  };
  const double plain = height("");
  // The model's own elements keep their attributes: the fingers' joints and geoms set only the
  // joints' damping.
  EXPECT_EQ(
      height(
          "<default><joint damping='7' pos='0.1 0 0'/><geom margin='0.001' density='1e5' solimp='0.5 0.6'/><pair solref='0.1 1' margin='0.01' gap='0.01' condim='1'/></default>"),
      plain);
  // 100 g on ten pillars of 3.9 kN/m.
  EXPECT_NEAR(plain, 0.1 - weight_of_100_g / (10.0 * 3900.0), 1e-3 * 25e-6);
}

// Light boxes need more noslip iterations: with 10 a box of 5 g was shaken loose in 0.5 s.
TEST(ArticulatedScene, LightBoxIsHeld) {
  for (const double mass : {5e-3, 2e-3}) {
    const ModelFolder folder;
    folder.write("fingers.xml", two_fingers(""));
    DynamicRig rig(
        replaced(replaced(held, "mass: 100 g", "mass: " + std::to_string(mass)), "time_step: 1 ms", "time_step: 0.5 ms"),
        folder.file("scene.yaml"));
    rig.run_to(0.2);
    const double before = rig.body("box").pose.position.z();
    rig.run_to(1.0);
    EXPECT_NEAR(rig.body("box").pose.position.z(), before, 0.8 * 0.5e-6) << mass;
    EXPECT_NEAR(rig->contact(0).force.row(0).sum(), -0.5 * mass * 9.81, 1e-3 * mass * 9.81) << mass;
  }
}

// Compliance [1/kg] of the box of 40 x 40 x 60 mm and mass m to a push on the face at x, at (y, z)
// from its middle.
double box_gives_way(double m, double y, double z) {
  const double about_y = m / 12.0 * (0.04 * 0.04 + 0.06 * 0.06), about_z = m / 12.0 * (0.04 * 0.04 + 0.04 * 0.04);
  return 1.0 / m + z * z / about_y + y * y / about_z;
}

// Returns the step that a message allows [s].
double allowed_step(const std::string& message) {
  EXPECT_THAT(message, refused_at("time_step", {"1 ms", "articulated"}));
  return parse_quantity(message.substr(message.find("up to ") + 6), Quantity::time);
}

// The contact may be a quarter of the compliance: h = sqrt(0.25 15/(k_n w)) with the 7.1 kN/m of a
// pillar and w at the corners, 7 mm from the middle both ways, for the box and its finger of 50 g.
TEST(ArticulatedScene, StepIsLimitedByTheLightestBody) {
  const std::string light = replaced(held, "mass: 100 g", "mass: 1 g");
  EXPECT_NEAR(allowed_step(answer(light)), std::sqrt(0.25 * 15.0 / (7100.0 * (box_gives_way(1e-3, 7e-3, 7e-3) + 1.0 / 50e-3))),
              2e-6);
  EXPECT_EQ(answer(replaced(light, "time_step: 1 ms", "time_step: auto")), "accepted");
  EXPECT_THAT(answer(replaced(held, "time_step: 1 ms", "time_step: 5 ms")), refused_at("time_step", {"5 ms", "2 ms"}));
}

const std::string with_wall =
    replaced(replaced(replaced(held, "bodies: {", "bodies: {wall: {shape: plane, position: [0, 0, -1]}, "), "touches: [box]",
                      "touches: [wall, box]"),
             "touches: [box]", "touches: [wall, box]");

// A slide compensates for one body. At the wall, which does not move, a press may be wrong by 1 %:
// h = sqrt(0.01 15/(k_n w)), with w the larger of the box's compliances.
TEST(ArticulatedScene, StepIsLimitedByBodiesThatMoveUnalike) {
  EXPECT_NEAR(allowed_step(answer(replaced(with_wall, "mass: 100 g", "mass: 5 g"))),
              std::sqrt(0.01 * 15.0 / (7100.0 * box_gives_way(5e-3, 7e-3, 7e-3))), 2e-6);
}

// 4 N on five of nine pillars, four of them 0.2 mm shorter: f + 4 (f - k_n 0.2 mm) = 4 N. MuJoCo's
// contact gets softer on light bodies (by w h^2/15, 6 % of a pillar's compliance at 2 g and 0.5
// ms). This is compensated in either order of the touched bodies, including the box's turning and
// the dampers of the fingers (5 N s/m, which are 50 g + 5 N s/m h to a step).
TEST(ArticulatedScene, LightBoxIsPressedAsAHeavyOne) {
  const double middle = (4.0 + 4.0 * 7100.0 * 0.2e-3) / 5.0, edge = middle - 7100.0 * 0.2e-3;
  const std::string at_500_hz = "type: papillarray, rate: 500 Hz";
  const std::string slow = replaced(replaced(held, "type: papillarray, site: left", at_500_hz + ", site: left"),
                                    "type: papillarray, site: right", at_500_hz + ", site: right");
  struct Case {
    std::string scene, mass, step;
  };
  for (const auto& [scene, mass, step] : {Case{held, "100 g", "1 ms"}, Case{slow, "20 g", "2 ms"}, Case{held, "5 g", "1 ms"},
                                          Case{held, "2 g", "0.5 ms"}, Case{with_wall, "5 g", "0.25 ms"}}) {
    const ModelFolder folder;
    folder.write("fingers.xml", two_fingers(""));
    DynamicRig rig(replaced(replaced(scene, "100 g", mass), "time_step: 1 ms", "time_step: " + step), folder.file("scene.yaml"));
    rig.run_to(0.5);
    for (const std::size_t pad : {0U, 1U}) {
      for (const Eigen::Index u : {1, 3, 4, 5, 7}) {
        const double wanted = u == 4 ? middle : edge;
        EXPECT_NEAR(rig->contact(pad).contact_force(2, u), wanted, 2e-4 * wanted) << mass << ' ' << u;
      }
    }
  }
}

TEST(ArticulatedScene, WhatOnlyAFieldCanDoIsRefused) {
  EXPECT_THAT(answer(replaced(held, "site: right_pad,", "site: right_pad, damping: 1.1 ms,")),
              refused_at("sensors.right.damping", {"1.1 ms", "1 ms", "fidelity"}));
  EXPECT_THAT(answer(held + "effects: [ageing]\n"), refused_at("effects", {"articulated", "fidelity"}));
  EXPECT_THAT(answer(replaced(held, "kinetic: 0.5", "kinetic: 0.4")),
              refused_at("friction", {"articulated", "kinetic", "static"}));
  EXPECT_THAT(
      answer(
          replaced(held, "touches: [box]", "touches: [rock]"),
          replaced(
              two_fingers(""), "<worldbody>",
              "<asset><mesh name='rock' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset><worldbody><body name='rock' pos='0 0 5'><geom name='rock' type='mesh' mesh='rock'/></body>")),
      refused_at("sensors.left.touches", {"rock", "mesh"}));
}

std::string stage_over_floor(const std::string& motion) {
  return "fidelity: articulated\nduration: 1.5 s\ntime_step: 1 ms\nfriction: {static: 0.5, kinetic: 0.5}\nmotion: {kind: stage, start: 1.2 s, " +
         motion + "}\nbodies: {floor: {shape: plane}}\nsensors: {pad: {type: papillarray, touches: [floor]}}\n";
}

// A pillar is 4.2 mm high. The pad, pressed at 10 mm/s without ramps from 0.5 mm above, is that deep
// at 470 ms.
TEST(ArticulatedScene, CompressionBeyondTheHeightOfAUnitIsRefused) {
  const std::string press = "gap: 0.5 mm, approach_speed: 10 mm/s, acceleration: inf, compression: ";
  EXPECT_EQ(answer(stage_over_floor(press + "4.1 mm"), "", 1.0), "accepted");
  EXPECT_THAT(answer(stage_over_floor(press + "4.4 mm"), "", 1.0),
              refused_at("sensors.pad", {"at 0.47", "element 4", "height of a unit", "4.2 mm"}));
}

// 60 mm/s of the slide and 60 mm/s of the press add up to at most 0.12 mm in 1 ms.
TEST(ArticulatedScene, StepIsLimitedByTheSpeedOfTheStage) {
  EXPECT_THAT(answer(stage_over_floor("speed: 60 mm/s, approach_speed: 60 mm/s, acceleration: inf")),
              refused_at("time_step", {"1 ms", "articulated", "0.1 mm", "0.833"}));
  EXPECT_EQ(answer(stage_over_floor("speed: 40 mm/s, approach_speed: 40 mm/s, acceleration: inf")), "accepted");
}

TEST(ArticulatedScene, ModelsThatWouldHaveOtherPillarsAreRefused) {
  const auto with_flag = [](const std::string& flag) {
    return answer(held, two_fingers("> <flag " + flag + "/></option><option "));
  };
  for (const std::string flag : {"constraint", "contact", "spring", "damper"}) {
    EXPECT_THAT(with_flag(flag + "='disable'"), StartsWith("model: its flag " + flag + " is disabled"));
  }
  for (const std::string flag : {"override", "sleep"}) {
    EXPECT_THAT(with_flag(flag + "='enable'"), StartsWith("model: its flag " + flag + " is enabled"));
  }
  EXPECT_THAT(answer(held, replaced(two_fingers(""), "<option", "<compiler boundmass='0.001'/><option")),
              refused_at("model", {"0.001 kg", "1e-05 kg"}));
}

// A table under the box: with the pillars' recipe MuJoCo's own friction is a fraction of mu f_n
// (sim/mujoco/README.md).
TEST(ArticulatedScene, FrictionOfOtherContactsIsRefusedWhenItComes) {
  const std::string table = replaced(held, "bodies: {", "bodies: {table: {shape: plane, position: [0, 0, 0.06]}, ");
  EXPECT_EQ(answer(table), "accepted") << "10 mm under the box, which hangs";
  const std::string dropped = replaced(table, "{left: 4 N, right: 4 N}", "{left: 0 N, right: 0 N}");
  EXPECT_THAT(answer(dropped, two_fingers(""), 1.0),
              AllOf(StartsWith("fidelity: at 0."), HasSubstr("the bodies 'table' and 'box' touch by MuJoCo's own contact"),
                    EndsWith("or use fidelity: field")));
  EXPECT_EQ(answer(pressed_box("fidelity: articulated\ntime_step: 1 ms\n"), "", 0.0), "accepted");
  EXPECT_THAT(answer(pressed_box("fidelity: articulated\ntime_step: 1 ms\n"), "", 0.1), StartsWith("fidelity: at 0"));
}

}  // namespace
}  // namespace slipbench

// A scene's description of a grasp: protocols, scatter and refusals.
#include <cmath>
#include <vector>

#include "sim/grasp/grasp.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

Scene scene_of(const std::string& text) { return parsed("slipbench: 1\nsensors: {pad: {type: papillarray}}\n" + text); }

std::string refusal(const std::string& text) {
  return refusal_of([&] {
    const Scene scene = scene_of(text);
    if (scene.grasp) draw_grasp(*scene.grasp, scene.seed, 0);
  });
}

TEST(GraspCatalogue, EntriesAreDocumented) {
  ASSERT_EQ(grasp_catalogue().size(), 3U);
  for (const Entry& entry : grasp_catalogue()) {
    EXPECT_FALSE(entry.summary.empty() || entry.source.empty()) << entry.name;
    for (const ParameterSpec& parameter : entry.parameters) {
      EXPECT_FALSE(parameter.doc.empty() || parameter.source.empty()) << entry.name << "." << parameter.name;
    }
    defaults_of(entry.parameters);  // throws for an invalid default
  }
}

TEST(GraspScene, ProtocolsGiveDefaultsThatTheSceneOverrides) {
  const Scene recorded = scene_of("grip: {}\n");
  EXPECT_TRUE(recorded.dynamic());
  EXPECT_EQ(recorded.motion.name, "lift");
  EXPECT_EQ(recorded.grasp->grip.number("preset"), 4.0);
  EXPECT_EQ(recorded.motion.parameters.number("speed"), 0.043);
  EXPECT_EQ(recorded.motion.parameters.number("acceleration"), 0.4);
  const Scene printed = scene_of("grip: {protocol: as_printed}\n");
  EXPECT_EQ(printed.grasp->grip.number("preset"), 1.0);
  EXPECT_EQ(printed.motion.parameters.number("speed"), 0.005);
  EXPECT_EQ(printed.motion.parameters.number("acceleration"), 0.05);
  // The lift takes 100 mm at 5 mm/s: 20.1 s after 1.5 s.
  EXPECT_EQ(printed.duration, 23.0);
  EXPECT_EQ(recorded.duration, 5.0);
  EXPECT_EQ(scene_of("duration: 6 s\ngrip: {}\n").duration, 6.0);
  const Scene own = scene_of("grip: {protocol: as_printed, preset: 2 N}\nmotion: {kind: lift, speed: 10 mm/s}\n");
  EXPECT_EQ(own.grasp->grip.number("preset"), 2.0);
  EXPECT_EQ(own.motion.parameters.number("speed"), 0.01);
  EXPECT_EQ(own.motion.parameters.number("acceleration"), 0.05);
  // The declared values are those of as_recorded.
  for (const Protocol& protocol : protocol_catalogue()) EXPECT_EQ(protocol.defaults.size(), 4U) << protocol.name;
  EXPECT_EQ(scene_of("grip: {protocol: as_recorded}\n").motion.parameters.values(), recorded.motion.parameters.values());
}

TEST(GraspScene, WithoutScatterEveryTrialIsAlike) {
  const Scene scene = scene_of("box: {size: [50 mm, 60 mm, 80 mm], position: [1 mm, -2 mm], centre_of_mass: [0, 0, 5 mm]}\n");
  for (const std::uint64_t trial : {0U, 7U}) {
    const Grasp grasp = draw_grasp(*scene.grasp, 3, trial);
    EXPECT_EQ(grasp.box_size, Eigen::Vector3d(0.05, 0.06, 0.08));
    EXPECT_TRUE(grasp.box_position.isApprox(Eigen::Vector3d(0.001, -0.002, 0.04 - 0.07), 1e-15));
    EXPECT_EQ(grasp.centre_of_mass, Eigen::Vector3d(0.0, 0.0, 0.005));
    EXPECT_EQ(grasp.yaw, 0.0);
    EXPECT_EQ(grasp.pitch, 0.0);
    EXPECT_EQ(grasp.phase, 0.0);
    EXPECT_EQ(grasp.friction_scale, 1.0);
    EXPECT_NEAR(grasp.opening, 0.05 + 2.0 * (1e-3 + 1e-3), 1e-15);
  }
}

TEST(GraspScene, ScatterHasTheSpreadThatItSays) {
  const Scene scene = scene_of("grip: {}\nscatter: {}\n");
  constexpr int trials = 4000;
  // The error of a mean of n draws is less than 4.5 sd/sqrt(n), the relative one of a standard
  // deviation less than 4.5/sqrt(2 n), with an exception in 100,000.
  struct Sum {
    double mean = 0.0, square = 0.0;
    void add(double value) { mean += value / trials, square += value * value / trials; }
    void expect(double expected_mean, double sd) const {
      EXPECT_NEAR(mean, expected_mean, 4.5 * sd / std::sqrt(trials));
      EXPECT_NEAR(std::sqrt(square - mean * mean), sd, 4.5 * sd / std::sqrt(2.0 * trials));
    }
  } x, y, z, yaw, pitch, centre, width, friction, phase;
  for (std::uint64_t trial = 0; trial < trials; ++trial) {
    const Grasp grasp = draw_grasp(*scene.grasp, 1, trial);
    x.add(grasp.box_position.x()), y.add(grasp.box_position.y()), z.add(grasp.box_position.z());
    yaw.add(grasp.yaw), pitch.add(grasp.pitch), centre.add(grasp.centre_of_mass.y());
    width.add(grasp.box_size.x()), friction.add(std::log(grasp.friction_scale)), phase.add(grasp.phase);
    EXPECT_TRUE(grasp.phase >= 0.0 && grasp.phase < 0.02);
    EXPECT_TRUE(grasp.box_size.x() >= 0.06 && grasp.box_size.x() < 0.06 + 0.374e-3);
  }
  constexpr double degree = 0.017453292519943295;
  x.expect(0.0, 0.5e-3), y.expect(0.0, 1.5e-3), z.expect(-0.02, 2e-3);
  yaw.expect(0.0, degree), pitch.expect(0.0, degree), centre.expect(0.0, 2e-3), friction.expect(0.0, 0.1);
  width.expect(0.06 + 0.187e-3, 0.374e-3 / std::sqrt(12.0)), phase.expect(0.01, 0.02 / std::sqrt(12.0));
}

TEST(GraspScene, OneScatterDoesNotShiftAnother) {
  const Scene all = scene_of("grip: {}\nscatter: {}\n"),
              fewer = scene_of("grip: {}\nscatter: {position: [0, 0, 0], yaw: 0, phase: false}\n");
  const Grasp a = draw_grasp(*all.grasp, 1, 5), b = draw_grasp(*fewer.grasp, 1, 5);
  EXPECT_EQ(a.pitch, b.pitch);
  EXPECT_EQ(a.centre_of_mass, b.centre_of_mass);
  EXPECT_EQ(a.box_size, b.box_size);
  EXPECT_EQ(b.yaw, 0.0);
  EXPECT_NE(a.yaw, 0.0);
}

TEST(GraspScene, SecondPadIsAGridOrTheSensorsOwn) {
  PadLayout sensor{.elements = {{{0.001, 0.0, 0.0}, {0.0, 0.0, -1.0}, 10.0, 5.0, 0.0, 0.0}}, .units = {{0, 1}}};
  const PadLayout silicone = second_pad(scene_of("grip: {}\n").grasp->grip, sensor);
  ASSERT_EQ(silicone.elements.size(), 24U);
  double normal = 0.0, tangential = 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), farthest = Eigen::Vector3d::Zero();
  for (const Element& element : silicone.elements) {
    normal += element.k_normal;
    tangential += element.k_tangential;
    middle += element.tip;
    farthest = farthest.cwiseMax(element.tip);
  }
  EXPECT_NEAR(normal, 400e3, 1e-9);
  EXPECT_NEAR(tangential, 200e3, 1e-9);
  EXPECT_LT(middle.norm(), 1e-15);
  EXPECT_NEAR(farthest.x(), 11e-3 * 3.0 / 4.0, 1e-15);  // each in the middle of its cell
  EXPECT_NEAR(farthest.y(), 18.75e-3 * 5.0 / 6.0, 1e-15);
  EXPECT_EQ(second_pad(scene_of("grip: {second_pad: same}\n").grasp->grip, sensor).elements.size(), 1U);
}

TEST(GraspScene, IdealForceIsTheWeightOverBothPads) {
  const Scene scene = scene_of("box: {mass: 0.3 kg}\nfriction: {static: 0.5}\n");
  EXPECT_NEAR(ideal_grip_force(scene, 1.0, 10.0), 3.0, 1e-15);  // 0.3 x 10/(2 x 0.5)
  EXPECT_NEAR(ideal_grip_force(scene, 1.2, 10.0), 2.5, 1e-15);
  EXPECT_TRUE(std::isinf(ideal_grip_force(scene_of("box: {}\nfriction: {static: 0}\n"), 1.0, 9.81)));
}

TEST(GraspScene, RefusesWhatDoesNotBelongTogether) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"scatter: {}\n", "scene.yaml:3: 'scatter' applies only to a grasp"},
      {"grip: {}\nbodies: {b: {shape: box}}\n", "scene.yaml:4: 'bodies' cannot be used in a grasp"},
      {"grip: {}\nmodel: a.xml\n", "scene.yaml:4: 'model' cannot be used in a grasp"},
      {"grip: {}\nfield_solver: implicit\nfidelity: mujoco_contact\n",
       "scene.yaml:4: field_solver: 'implicit' needs 'fidelity: field'"},
      {"grip: {}\nfield_solver: implicit\nintegrator: discrete\n",
       "scene.yaml:5: integrator: 'discrete' cannot be combined with 'field_solver: implicit' in a grasp"},
      {"grip: {}\nmotion: {kind: stage}\n", "scene.yaml:4: motion 'stage' cannot move the arm of a grasp"},
      {"motion: {kind: lift}\n", "scene.yaml:3: motion 'lift' needs a grasp"},
      {"grip: {protocol: as_prnted}\n", "scene.yaml:3: unknown protocol 'as_prnted'; did you mean 'as_printed'?"},
      {"grip: {stifness: [1, 1, 1]}\n", "scene.yaml:3: unknown key 'stifness' in grip; did you mean 'stiffness'?"},
      {"grip: {}\nfidelity: articulated\n",
       "scene.yaml:4: fidelity: 'articulated' cannot simulate the table of a grasp; allowed in a grasp: field, mujoco_contact"},
      {"grip: {}\nintegrator: RK4\n", "scene.yaml:4: integrator: 'RK4' has four stages in a step"},
      {"grip: {}\nsurface: {shape: plane}\n", "scene.yaml:4: unknown key 'shape' in surface"},
      {"box: {size: [80 mm, 60 mm, 100 mm], position: [2 mm, 0]}\n", "box.size: a box of 80 mm"},
      {"box: {}\ngrip: {height: 101 mm}\n", "box: the middle of the pads is beside the box"},
  };
  for (const auto& [text, message] : cases) {
    const std::string found = refusal(text);
    EXPECT_NE(found.find(message), std::string::npos) << found;
  }
  EXPECT_EQ(refusal("grip: {}\nbox: {}\nscatter: {}\ngravity: 1.6 m/s2\n"), "accepted");
  for (const std::string fidelity : {"field", "mujoco_contact"}) {
    EXPECT_EQ(refusal("grip: {}\nfidelity: " + fidelity + "\ncontact: none\nintegrator: auto\nfield_solver: auto\n"), "accepted");
  }
  EXPECT_EQ(refusal("grip: {}\nfield_solver: implicit\n"), "accepted");
}

TEST(GraspScene, EverySensorButTheFirstFollows) {
  const auto of_sensors = [](const std::string& sensors) {
    return refusal_of([&] { parsed("slipbench: 1\ngrip: {}\nsensors:\n" + sensors); });
  };
  const std::string pad = "  pad: {type: papillarray}\n";
  EXPECT_EQ(of_sensors(pad + "  skin: {type: piezo_skin, follows: pad}\n  nib: {type: nib_pad, follows: second_pad}\n"),
            "accepted");
  EXPECT_THAT(of_sensors(pad + "  skin: {type: piezo_skin}\n"),
              refused_at("scene.yaml:5", {"sensors.skin", "pad", "second_pad"}));
  EXPECT_THAT(of_sensors("  skin: {type: piezo_skin, follows: pad}\n" + pad),
              refused_at("scene.yaml:4", {"follows", "sensors.skin", "grasp"}));
  EXPECT_THAT(of_sensors(pad + "  skin: {type: piezo_skin, follows: first_pad}\n"),
              refused_at("scene.yaml:5", {"first_pad", "pad", "second_pad"}));
}

TEST(GraspScene, ShippedTwoSkinsReadOneContact) {
  const Scene scene = parsed(shipped("grasp/two_skins.yaml"));
  ASSERT_EQ(scene.sensors.size(), 3U);
  EXPECT_EQ(scene.sensors[0].type, "papillarray");
  EXPECT_EQ(scene.sensors[0].follows, "");
  EXPECT_EQ(scene.sensors[1].type, "piezo_skin");
  EXPECT_EQ(scene.sensors[2].type, "nib_pad");
  for (const std::size_t i : {1U, 2U}) EXPECT_EQ(scene.sensors[i].follows, scene.sensors[0].name);
  EXPECT_EQ(scene.detector->sensor, 0U);
  // 0.4 kg on two pads of mu 0.35 needs 5.6 N each: the preset of 4 N lets it slip, and the loop
  // has to react.
  EXPECT_GT(ideal_grip_force(scene, 1.0, 9.81), scene.grasp->grip.number("preset"));
}

TEST(GraspScene, ShippedLiftIsAsRecordedAndTakesWhatIsSet) {
  SceneFile file = shipped("grasp/lift.yaml");
  const Scene scene = parsed(file);
  EXPECT_EQ(scene.material, "ptfe");
  EXPECT_EQ(scene.grasp->grip.number("preset"), 4.0);
  EXPECT_EQ(scene.motion.parameters.number("speed"), 0.043);
  EXPECT_EQ(scene.grasp->box.number("mass"), 0.2);
  EXPECT_TRUE(scene.grasp->scatter.has_value());
  EXPECT_FALSE(scene.time_step);
  for (const Override& change : {Override{"surface.material", "wet_felt"},
                                 {"box.mass", "0.5 kg"},
                                 {"grip.preset", "1 N"},
                                 {"grip.protocol", "as_printed"}}) {
    file.apply(change);
  }
  const Scene changed = parsed(file);
  EXPECT_EQ(changed.material, "wet_felt");
  EXPECT_EQ(changed.grasp->box.number("mass"), 0.5);
  EXPECT_EQ(changed.grasp->grip.number("preset"), 1.0);
  EXPECT_EQ(changed.motion.parameters.number("speed"), 0.005);
}

}  // namespace
}  // namespace slipbench

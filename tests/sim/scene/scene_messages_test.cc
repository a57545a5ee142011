// What a scene that is wrong is answered: every message names the place, what was found, what is allowed and the nearest name.
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench {
namespace {

// Two lines that make a valid scene: what a case adds stands in line 3 and below.
const std::string head = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

std::string answer(const std::string& text) {
  const Catalogues catalogues = test_catalogues();
  return refusal_of([&] { parse_scene(SceneFile::from_text(text, "s.yaml"), catalogues); });
}

struct Case {
  std::string text;
  std::string message;  // what follows "s.yaml:", or "accepted"
};

// What stands between `before` and `after` is answered by its message.
void expect_answers(const std::string& before, const std::vector<Case>& cases, const std::string& after = "\n") {
  for (const auto& [text, message] : cases)
    EXPECT_EQ(answer(before + text + after), message == "accepted" ? message : "s.yaml:" + message) << text;
}

// yaml-cpp 0.8 names the anchor, too.
TEST(SceneMessages, AnAliasWithoutAnAnchorIsRefused) {
  EXPECT_THAT(answer(head + "seed: 1\nmotion: *a\n"),
              StartsWith("s.yaml:4: not valid YAML: the referenced anchor is not defined"));
}

const std::string scene_keys =
    "accuracy, bodies, box, contact, controller, controls, description, detector, duration, effects, expect, fidelity, field_solver, friction, gravity, grip, hold, integrator, model, motion, scatter, seed, sensors, slipbench, split, surface, sweep, time_step";
const std::string sensor_keys =
    "ahead, bias, bristle_spread, bristles, corner_drop, damping, edge_drop, electronics, follows, profile, rate, site, touches, type";
const std::string materials =
    "acrylic, cardboard, felt, glass, masonite, paper, ptfe, rubber, soaped_wavy_acrylic, wavy_acrylic, wet_felt, wet_paper, wet_ptfe, wet_rubber";

std::string tab(int line) {
  return std::to_string(line) + ": a tab before the first word; allowed: spaces, since tabs cannot indent YAML";
}

// Two bodies and a pad that touches one, in four lines; what a case adds stands in line 5 and below.
const std::string bodies_head =
    "slipbench: 1\nbodies: {box: {shape: box}, table: {shape: plane}}\nsensors:\n  pad: {type: papillarray, touches: [box]}\n";
const std::string pad = "slipbench: 1\nsensors: {pad: {type: papillarray, ";
const std::string contact = head + "fidelity: mujoco_contact\ncontact: ";
const std::string needs_bodies = " needs bodies moved by forces: a scene with 'model' or 'bodies'";  // a grasp refuses it, too
const std::string needs_forces = " needs bodies moved by forces: a scene with 'box', 'model' or 'bodies'";

std::string paths_of(int count) {
  std::string text = "{";
  for (int i = 0; i < count; ++i) text += "motion.p" + std::to_string(i) + ": [1], ";
  return text + "}";
}

std::string four_axes_of_32() {
  std::string values = "[0";
  for (int i = 1; i < 32; ++i) values += "," + std::to_string(i);
  values += "]";
  return "{motion.speed: " + values + ", motion.gap: " + values + ", motion.rotation: " + values +
         ", motion.direction: " + values + "}";
}

TEST(SceneMessages, OfYaml) {
  const std::vector<Case> whole = {
      {"", "1: empty"},
      {"\r\r", "1: empty"},
      {"slipbench: 1\rseed: 1\r",
       "1: lines end with a carriage return alone; allowed: a line feed, with or without a carriage return"},
      {std::string(1'000'001, '#'), " longer than 1000000 bytes; allowed: at most that"},
  };
  expect_answers("", whole, "");
  const std::vector<Case> bare = {
      {"\r \t", "1: empty"},
      {"# nothing", "1: empty"},
      {"- 1", "1: the scene is a sequence; allowed: a map of keys with values, 'slipbench: 1' first"},
  };
  expect_answers("", bare);
  const std::vector<Case> below_head = {
      {"motion: {speed: 1", "4: not valid YAML: end of map flow not found"},
      {"motion:\n\tspeed: 1", tab(4)},
      {"motion:\n  speed: 1\n  \tgap: 1 mm", tab(5)},
      {"effects:\n\t- ageing\n\t- stribeck", tab(4)},
      {"\tseed: 1", tab(3)},
      {"seed:\t1\nmotion: {speed: 1", "5: not valid YAML: end of map flow not found"},
      {"---\nslipbench: 1", "3: a second document; allowed: one document a file"},
      {"seed: 1\nseed: 2", "4: duplicate key 'seed', first at s.yaml:3"},
      {"motion:\n  speed: 1\n  gap: 1\n  speed: 2", "6: duplicate key 'speed', first at s.yaml:4"},
      {"motion: &a {speed: 1}", "3: anchors ('&name') are not allowed"},
      {"seed: !!int 1", "3: tags ('!name') are not allowed"},
      {"motion: {<<: {speed: 1}}", "3: merge keys ('<<') are not allowed"},
      {"? {a: b}\n: 1", "3: a key that is not text; are all brackets closed?"},
      {"~: 1", "3: a key that is not text; are all brackets closed?"},
      {"seed: 1\x01", "3: byte 56 is not text; allowed: UTF-8 text"},
      {"description: \xff", "3: byte 62 is not text; allowed: UTF-8 text"},
      {"description: \xc0\xaf", "3: byte 62 is not text; allowed: UTF-8 text"},
      {"description: \xed\xa0\x80", "3: byte 62 is not text; allowed: UTF-8 text"},
      {"description: \"a\\0b\"", "3: 'a\\x00b' holds a zero byte"},
      {"effects: " + std::string(64, '[') + std::string(64, ']'), "3: nested too deeply; allowed: 64 levels"},
  };
  expect_answers(head, below_head);
}

TEST(SceneMessages, OfTopLevel) {
  const std::vector<Case> bare = {
      {"sensors: {pad: {type: papillarray}}", "1: no key 'slipbench'; a scene says its schema version: 'slipbench: 1'"},
      {"slipbench: 2", "1: slipbench is '2'; allowed: 1, the schema version"},
      {"slipbench: 1\nsensors: {b: {type: papillarray}, a: {type: papillarray}}\ndetector: {type: ratio}",
       "3: no key 'sensor' in detector, and the scene has several; allowed: a, b"},
  };
  expect_answers("", bare);
  const std::vector<Case> below_head = {
      {"motoin: {}", "3: unknown key 'motoin' in the scene; did you mean 'motion'? allowed: " + scene_keys},
      {"expect: 1 s", "3: expect is '1 s'; allowed: a map of what must come out, such as 'gross_slip_by: 1.0 s'"},
      {"expect:", "3: expect is nothing; allowed: a map of what must come out, such as 'gross_slip_by: 1.0 s'"},
      {"expect: {gros_slip_by: 1 s}",
       "3: unknown key 'gros_slip_by' in expect; did you mean 'gross_slip_by'? allowed: confidence, control, gross_slip_by"},
      {"accuracy: {}",
       "3: accuracy is empty; allowed: creep, force, label, label_micro, micro_onset, onset, slip_distance, or accuracy: none"},
      {"accuracy: 1 %", "3: accuracy is '1 %'; allowed: a map of what may be wrong by how much, such as 'onset: 1 %', or none"},
      {"accuracy: {onsets: 1 %}",
       "3: unknown key 'onsets' in accuracy; did you mean 'onset'? allowed: creep, force, label, label_micro, micro_onset, onset, slip_distance"},
      {"accuracy: {creep: 1 %}", "3: accuracy.creep: unknown unit '%' of a speed in '1 %'; allowed: m/s, mm/s, cm/s, um/s"},
      {"accuracy: {onset: 200 %}", "3: accuracy.onset: '200 %' is out of range; allowed: > 0 and <= 1"},
      {"accuracy: {onset: 1 %}\ntime_step: 1 ms",
       "4: 'time_step' is found for a scene that says its accuracy; allowed: one of the two"},
      {"accuracy: {onset: 1 %}\nfield_solver: explicit",
       "4: 'field_solver' is found for a scene that says its accuracy; allowed: one of the two"},
      {"sweep: {accuracy.onset: [1 %]}", "3: 'accuracy.onset' cannot be swept; allowed: any other key of the scene"},
      {"sweep: {expect.gross_slip_by: [1 s]}", "3: 'expect.gross_slip_by' cannot be swept; allowed: any other key of the scene"},
      {"description: {a: b}", "3: description is a map; allowed: text"},
      {"duration: 0 s", "3: duration: '0 s' is out of range; allowed: > 0 s and <= 86400 s"},
      {"duration: inf", "3: duration: 'inf' is infinite; allowed: a finite number"},
      {"duration: 4 m", "3: duration: unknown unit 'm' of a time in '4 m'; allowed: s, ms, us, min"},
      {"duration:", "3: duration is nothing; allowed: a number such as 4 s"},
      {"duration: [4]", "3: duration is a sequence; allowed: a number such as 4 s"},
      {"time_step: small", "3: time_step: 'small' is not a time; allowed: a number in s, or one with a unit: s, ms, us, min"},
      {"duration: 1 s\ntime_step: 2 s", "4: time_step 2 s exceeds the duration; allowed: at most 1 s, or auto"},
      {"time_step: 10 us\nduration: 1001 s",
       "3: time_step 10 us makes more than 100,000,000 steps; allowed: at least 10.01 us, or auto"},
      {"fidelity: feild",
       "3: fidelity: unknown value 'feild'; did you mean 'field'? allowed: field, articulated, mujoco_contact"},
      {"contact: {noslip: 3}",
       "3: 'contact' is of MuJoCo's own contact friction, and the fidelity is 'field'; allowed with 'fidelity: mujoco_contact'"},
      {"fidelity: articulated\ncontact: {}",
       "4: 'contact' is of MuJoCo's own contact friction, and the fidelity is 'articulated'; allowed with 'fidelity: mujoco_contact'"},
      {"seed: -1", "3: seed: '-1' is no seed; allowed: 0 to 18446744073709551615"},
      {"seed: 18446744073709551616", "3: seed: '18446744073709551616' is no seed; allowed: 0 to 18446744073709551615"},
      {"detector: {type: traned}", "3: unknown detector 'traned'; did you mean 'trained'? allowed: none, ratio, trained"},
      {"detector: ratio", "3: detector is 'ratio'; allowed: a map of 'type' and parameters"},
      {"detector: {}", "3: no key 'type' in detector; allowed: none, ratio, trained"},
      {"detector: {type: []}", "3: detector.type is a sequence; allowed: the name of a detector"},
      {"detector: {type: ratio, treshold: 1}",
       "3: unknown key 'treshold' in detector; did you mean 'threshold'? allowed: sensor, threshold, type"},
      {"detector:\n  type: ratio\n  threshold: -1", "5: detector.threshold: '-1' is out of range; allowed: > 0"},
      {"detector: {type: ratio, sensor: pat}", "3: detector.sensor: no sensor 'pat'; did you mean 'pad'? allowed: pad"},
      {"detector: {type: trained, memories: [a]}",
       "3: detector.memories is a sequence; allowed: a path from the scene's own folder, or own"},
      {"detector: {type: trained, memories: ''}", "3: detector.memories: the path is empty; allowed: a path, or own"},
      {"controller: {type: grip}", "3: unknown controller 'grip'; allowed: none"},
      {"detector: {type: none, gain: 1}", "3: unknown key 'gain' in detector; allowed: type"},
      {"controller: none", "3: controller is 'none'; allowed: a map of 'type' and parameters"},
  };
  expect_answers(head, below_head);
  const std::vector<Case> of_contact = {
      {"[]", "4: contact is a sequence; allowed: a map of parameters, or none"},
      {"{no_slip: 3}",
       "4: unknown key 'no_slip' in contact; did you mean 'noslip'? allowed: cone, impratio, integrator, iterations, noslip, noslip_tolerance, refsafe, solimp, solref, solreffriction, solver, tip_damping, tip_mass, tolerance"},
      {"{cone: eliptic}", "4: contact.cone: unknown value 'eliptic'; did you mean 'elliptic'? allowed: elliptic, pyramidal"},
      {"{integrator: euler}",
       "4: contact.integrator: unknown value 'euler'; did you mean 'Euler'? allowed: Euler, implicit, implicitfast, discrete, RK4"},
      {"\n  noslip: 3\n  solref: [0.02, -1]",
       "6: contact.solref: 0.02, -1; allowed: two positive numbers, or two negative ones: -stiffness and -damping"},
      {"{solref: [0, 0]}",
       "4: contact.solref: 0, 0; allowed: two positive numbers, or two negative ones: -stiffness and -damping"},
      {"{solreffriction: [0.02, 0]}",
       "4: contact.solreffriction: 0.02, 0; allowed: two positive numbers, two negative ones, or 0, 0: as solref"},
      {"\n  noslip: 3\n  solreffriction: [0.002, 1]",
       "6: contact.solreffriction: MuJoCo leaves it aside under pyramidal cones, its default; allowed with: cone: elliptic"},
      {"{solimp: [0.9, 1, 0.001]}", "4: contact.solimp.1: 1 would be clipped by MuJoCo; allowed: 1e-04 to 0.9999"},
      {"\n  noslip: 3\n  solimp:\n    - 0.9\n    - 0.95\n    - 0",
       "9: contact.solimp.2: of a depth of 0 MuJoCo makes a constant impedance, the mean of the two; allowed: > 1e-15 m"},
      {"{solimp: [0.9, 0.95, 1e-15]}",
       "4: contact.solimp.2: of a depth of 1e-15 MuJoCo makes a constant impedance, the mean of the two; allowed: > 1e-15 m"},
      {"{solimp: [0.00009, 0.95, 0.001]}", "4: contact.solimp.0: 9e-05 would be clipped by MuJoCo; allowed: 1e-04 to 0.9999"},
      {"{solimp: [0.9, 0.95, 0.001, 0.5, 0]}",
       "4: contact.solimp has 5 entries; allowed: a sequence of 3 such as [0.9, 0.95, 0.001]"},
      {"{impratio: 1e-16}", "4: contact.impratio: '1e-16' is out of range; allowed: >= 1e-15"},
      {"{tip_mass: 0 g}", "4: contact.tip_mass: '0 g' is out of range; allowed: > 0 kg"},
      {"{cone: elliptic, solref: [-1e7, -6325], solreffriction: [0.002, 1], solimp: [0.99, 0.999, 0.001]}", "accepted"},
      {"nothing", "4: contact is 'nothing'; allowed: a map of parameters, or none"},
  };
  expect_answers(contact, of_contact);
}

TEST(SceneMessages, OfBodies) {
  const std::vector<Case> bodies = {
      {"[box]", "3: bodies is a sequence; allowed: a map of bodies, such as 'box: {shape: box}'"},
      {"{}", "3: bodies is empty; allowed: a map of bodies, such as 'box: {shape: box}'"},
      {"{my box: {shape: box}}", "3: 'my box' cannot name a body; allowed: letters, digits and '_', no digit first"},
      {"{box: box}", "3: bodies.box is 'box'; allowed: a map of 'shape' and parameters"},
      {"{box: {mass: 1}}", "3: no key 'shape' in bodies.box; allowed: box, plane"},
      {"{box: {shape: bax}}", "3: unknown body shape 'bax'; did you mean 'box'? allowed: box, plane"},
      {"{box: {shape: box, masse: 1}}",
       "3: unknown key 'masse' in bodies.box; did you mean 'mass'? allowed: free, friction, mass, position, shape, size"},
      {"{box: {shape: box, mass: 0}}", "3: bodies.box.mass: '0' is out of range; allowed: > 0 kg"},
      {"{box: {shape: box}}\nhold: {against: pad}", "4: no key 'body' in hold; allowed: the name of a body"},
      {"{box: {shape: box}}\nhold: {body: box, against: pad, until: 1 s}",
       "4: unknown key 'until' in hold; allowed: against, body, from, within"},
      {"{box: {shape: box}}\nhold: {body: box, against: pad, from: 100 s}",
       "4: hold.from: 100 s is the trial's end or later; allowed: less than 4 s"},
      {"{box: {shape: box}}\nhold: {body: box,\n  against: box}",
       "5: hold.against: 'box' is the body itself; allowed: what holds it, a sensor or another body"},
  };
  expect_answers(head + "bodies: ", bodies);
  const std::vector<Case> of_a_sensor = {
      {"{type: papillarray}", "4: no key 'touches' in sensors.pad; allowed: names of geoms or bodies, such as [box]"},
      {"{type: papillarray, touches: box}", "4: sensors.pad.touches is 'box'; allowed: names of geoms or bodies, such as [box]"},
      {"{type: papillarray, touches: []}", "4: sensors.pad.touches is empty; allowed: names of geoms or bodies, such as [box]"},
      {"{type: papillarray, touches: [box, box]}", "4: 'box' is named twice in sensors.pad.touches"},
      {"{type: papillarray, touches: [box], damping: -1 ms}", "4: sensors.pad.damping: '-1 ms' is out of range; allowed: >= 0 s"},
      {"{type: papillarray, touches: [box], site: tip}\nmotion: {speed: 1 mm/s}",
       "5: motion moves the sensors that have no 'site', and every sensor of this scene has one; leave it out"},
  };
  expect_answers("slipbench: 1\nbodies: {box: {shape: box}}\nsensors:\n  pad: ", of_a_sensor);
  const std::vector<Case> below_head = {
      {"model: ''", "3: model is empty; allowed: the path of an MJCF file, from the scene's own folder"},
      {"model: {}", "3: model is a map; allowed: the path of an MJCF file, from the scene's own folder"},
      {"gravity: 9.81", "3: 'gravity'" + needs_forces},
      {"controls: {}", "3: 'controls'" + needs_bodies},
      {"field_solver: implicit", "3: 'field_solver'" + needs_forces},
      {"hold: {}", "3: 'hold'" + needs_bodies},
      {"integrator: RK4", "3: 'integrator'" + needs_forces},
      {"field_solver: explicit", "3: 'field_solver'" + needs_forces},
  };
  expect_answers(head, below_head);
  const std::vector<Case> of_the_pad = {
      {"site: tip", "2: 'site' in sensors.pad" + needs_bodies},
      {"touches: [box]", "2: 'touches' in sensors.pad" + needs_bodies},
      {"damping: 1 ms", "2: 'damping' in sensors.pad" + needs_forces},
  };
  expect_answers(pad, of_the_pad, "}}\n");
  const std::vector<Case> touching = {
      {"gravity: 9.81 m/s",
       "5: gravity: unknown unit 'm/s' of an acceleration in '9.81 m/s'; did you mean 'm/s2'? allowed: m/s2, mm/s2, cm/s2"},
      {"gravity: -1", "5: gravity: '-1' is out of range; allowed: >= 0 m/s2 and <= 1000 m/s2"},
      {"field_solver: implicite",
       "5: field_solver: unknown value 'implicite'; did you mean 'implicit'? allowed: auto, explicit, implicit"},
      {"fidelity: articulated\nfield_solver: implicit",
       "6: field_solver: 'implicit' is for pads as fields; with 'fidelity: articulated' leave it out"},
      {"integrator: RK5",
       "5: integrator: unknown value 'RK5'; did you mean 'RK4'? allowed: auto, Euler, implicit, implicitfast, discrete, RK4"},
      {"fidelity: articulated\nintegrator: Euler",
       "6: integrator: 'Euler' is for pads as fields; 'fidelity: articulated' has its own, discrete"},
      {"fidelity: mujoco_contact\nintegrator: Euler",
       "6: integrator: 'Euler' is for pads as fields; allowed with 'fidelity: mujoco_contact': contact.integrator"},
      {"field_solver: implicit\nintegrator: RK4",
       "6: integrator: 'RK4' does not solve implicit fields; allowed with them: discrete"},
      {"integrator: RK4", "accepted"},
      {"surface: {material: felt, shape: plane}", "5: unknown key 'shape' in surface of a scene with bodies; allowed: material"},
      {"  skin: {type: papillarray, follows: pat}", "5: sensors.skin.follows: no pad 'pat'; did you mean 'pad'? allowed: pad"},
      {"  skin: {type: papillarray, follows: nib}\n  nib: {type: papillarray, follows: pad}",
       "5: sensors.skin.follows: no pad 'nib'; allowed: pad"},
      {"  skin: {type: papillarray, follows: pad, touches: [box]}",
       "5: 'touches' in sensors.skin is that of the pad that it follows; leave it out"},
      {"  skin: {type: papillarray, ahead: 1 mm, touches: [box]}",
       "5: 'ahead' in sensors.skin is for a sensor that says 'follows'; leave it out"},
      {"  skin: {type: papillarray, follows: pad, ahead: -1 mm}",
       "5: sensors.skin.ahead: '-1 mm' is out of range; allowed: >= 0 m and <= 10 mm"},
      {"  skin: {type: papillarray, follows: pad}\nfidelity: articulated",
       "5: 'follows' in sensors.skin: an articulated pad has no field to be read beside it; allowed with 'fidelity: field'"},
      {"controls: [1]", "5: controls is a sequence; allowed: a map of actuators of the model, such as 'grip: 4 N'"},
      {"controls: {grip: 4 Nn}",
       "5: controls.grip: unknown unit 'Nn' in '4 Nn'; did you mean 'N'? allowed: %, m, mm, um, cm, nm, s, ms, us, min, m/s, mm/s, cm/s, um/s, m/s2, mm/s2, cm/s2, rad, deg, rad/s, deg/s, rad/s2, deg/s2, Hz, kHz, MHz, N, mN, kN, kg, g, N/m, N/mm, kN/m, N s/m, Pa, kPa, MPa"},
      {"controls: {grip: {}}",
       "5: controls.grip is a map; allowed: a number such as 4 N, or points such as [[0 s, 0 N], [1 s, 4 N]]"},
      {"controls: {grip: [[0 s, 1 N], 2 N]}", "5: controls.grip.1 is '2 N'; allowed: a time and a value, such as [1 s, 4 N]"},
      {"controls: {grip: [[1 s, 1 N], [1 s, 2 N]]}", "5: controls.grip.1: the times do not ascend; allowed: later than 1 s"},
      {"controls: {grip: inf}", "5: controls.grip: 'inf' is infinite; allowed: a finite number"},
  };
  expect_answers(bodies_head, touching);
  const std::vector<Case> version_alone = {
      {"sensors: {pad: {type: papillarray}, skin: {type: papillarray, follows: pad}}",
       "2: 'follows' in sensors.skin" + needs_forces},
  };
  expect_answers("slipbench: 1\n", version_alone);
}

TEST(SceneMessages, OfParts) {
  const std::vector<Case> below_head = {
      {"surface: {material: acryl}", "3: unknown material 'acryl'; did you mean 'acrylic'? allowed: " + materials},
      {"surface:\n  shape: plan", "4: unknown surface shape 'plan'; did you mean 'plane'? allowed: cylinder, plane"},
      {"surface: {radius: 1 m}", "3: unknown key 'radius' in surface; allowed: material, shape"},
      {"surface: ptfe", "3: surface is 'ptfe'; allowed: a map of 'shape' and parameters"},
      {"friction: {mu: 1}", "3: unknown key 'mu' in friction; allowed: kinetic, scale, static"},
      {"friction: {static: -0.1}", "3: friction.static: '-0.1' is out of range; allowed: >= 0 and <= 100"},
      {"friction: {static: 101}", "3: friction.static: '101' is out of range; allowed: >= 0 and <= 100"},
      {"friction:\n  static: 0.5\n  kinetic: 0.6",
       "5: friction.kinetic 0.6 exceeds the static coefficient 0.5; allowed: at most that"},
      {"friction: {kinetic: 0.6}",
       "3: friction.kinetic 0.6 exceeds the static coefficient 0.5 of acrylic; allowed: at most that"},
      {"friction: {scale: 0}", "3: friction.scale: '0' is out of range; allowed: > 0 and <= 100"},
      {"friction: {scale: 1e300}", "3: friction.scale: '1e300' is out of range; allowed: > 0 and <= 100"},
      {"motion: {kind: satge}", "3: unknown motion 'satge'; did you mean 'stage'? allowed: stage"},
      {"motion: {speed: inf}", "3: motion.speed: 'inf' is infinite; allowed: a finite number"},
      {"motion: {speed: .nan}",
       "3: motion.speed: '.nan' is not a speed; allowed: a number in m/s, or one with a unit: m/s, mm/s, cm/s, um/s"},
      {"motion: {pivot: 1 mm}", "3: motion.pivot is '1 mm'; allowed: a sequence of 2 such as [0 mm, 0 mm]"},
      {"motion: {pivot: [1, 2, 3]}", "3: motion.pivot has 3 entries; allowed: a sequence of 2 such as [0 mm, 0 mm]"},
      {"motion:\n  tilt:\n    - 1 deg\n    - 90 deg",
       "6: motion.tilt.1: '90 deg' is out of range; allowed: >= -0.5 rad and <= 0.5 rad"},
      {"effects: ageing", "3: effects is 'ageing'; allowed: a sequence of names or of {name: {parameters}}"},
      {"effects: [agein]", "3: unknown effect 'agein'; did you mean 'ageing'? allowed: ageing, stribeck"},
      {"effects:\n  - ageing\n  - ageing: {rate: 1}", "5: effect 'ageing' is named twice in effects"},
      {"effects: [{ageing: {}, stribeck: {}}]", "3: effects.0 is a map of 2 keys; allowed: a name, or one {name: {parameters}}"},
      {"effects: [{ageing: {rte: 1}}]", "3: unknown key 'rte' in ageing; did you mean 'rate'? allowed: rate"},
      {"effects: [{ageing: 3}]", "3: effects.ageing is '3'; allowed: a map of parameters"},
  };
  expect_answers(head, below_head);
  const std::vector<Case> version_alone = {
      {"seed: 2", "1: no key 'sensors'; allowed: a map of at least one sensor, such as 'pad: {type: papillarray}'"},
      {"sensors: {}", "2: sensors is empty; allowed: a map of at least one sensor, such as 'pad: {type: papillarray}'"},
      {"sensors: {2nd pad: {type: papillarray}}",
       "2: '2nd pad' cannot name a sensor; allowed: letters, digits and '_', no digit first"},
      {"sensors:\n  pad: {rate: 1 kHz}", "3: no key 'type' in sensors.pad; allowed: papillarray"},
      {"sensors: {pad: {type: papilarray}}", "2: unknown sensor 'papilarray'; did you mean 'papillarray'? allowed: papillarray"},
  };
  expect_answers("slipbench: 1\n", version_alone);
  const std::vector<Case> of_the_pad = {
      {"bristle: 6", "2: unknown key 'bristle' in sensors.pad; did you mean 'bristles'? allowed: " + sensor_keys},
      {"profile: grip", "2: sensors.pad.profile: unknown value 'grip'; allowed: gripper, hexapod"},
      {"bristles: 2.5", "2: sensors.pad.bristles: '2.5' is not a whole number; allowed: digits, with a leading '-' if negative"},
      {"bias: on", "2: sensors.pad.bias: 'on' is not a flag; allowed: true, false"},
      {"electronics: idea",
       "2: sensors.pad.electronics: unknown value 'idea'; did you mean 'ideal'? allowed: ideal, typical, or a sequence of parts"},
      {"electronics: [nose]", "2: unknown part of the electronics 'nose'; did you mean 'noise'? allowed: drift, noise"},
  };
  expect_answers(pad, of_the_pad, "}}\n");
}

TEST(SceneMessages, OfSweep) {
  const std::vector<Case> swept = {
      {"[1]", "3: sweep is a sequence; allowed: a map of paths, such as 'motion.speed: [1 mm/s, 4 mm/s]'"},
      {paths_of(1001), "3: sweep has 1001 entries; allowed: at most 1000"},
      {"{motion.speed: 1}", "3: sweep.motion.speed is '1'; allowed: a sequence of values, or {draw: ...}"},
      {"{motion.speed: []}", "3: sweep.motion.speed is empty; allowed: a sequence of at least one value"},
      {"{motion.sped: [1]}",
       "3: unknown key 'sped' in motion; did you mean 'speed'? allowed: acceleration, angular_acceleration, approach_speed, compression, direction, gap, kind, pivot, retract, reverse, rotation, speed, start, stop, tilt"},
      {"{motion.: [1]}", "3: 'motion.' is not a path; allowed: keys joined by dots, such as 'motion.speed' or 'motion.tilt.0'"},
      {"{scene: [{seed: 1}]}", "3: 'seed' cannot be swept; allowed: any other key of the scene"},
      {"{scene: 1}",
       "3: sweep.scene is '1'; allowed: a sequence of maps of the scene's keys, or {draw: choice, values: ...} of such"},
      {"{scene: [1, 2]}", "3: sweep.scene has '1'; allowed: maps of the scene's keys"},
      {"{motion.speed: [1, 2], scene: [{motion: {speed: 1}}]}",
       "3: sweep.scene sets what sweep.motion.speed sets, too; allowed: each value once"},
      {"{seed: [1, 2]}", "3: 'seed' cannot be swept; allowed: any other key of the scene"},
      {"{motion.tilt.0: [1]}", "3: no item '0' in 'motion.tilt', which the scene does not give"},
      {"{split: [{by: trial}]}", "3: 'split' cannot be swept; allowed: any other key of the scene"},
      {"{motion: [{speed: 1}, {gap: 2}], motion.speed: [1]}",
       "3: sweep.motion.speed sets what sweep.motion sets, too; allowed: each value once"},
      {"{motion.tilt: [[0, 0]], motion.tilt.0: [1]}",
       "3: sweep.motion.tilt.0 sets what sweep.motion.tilt sets, too; allowed: each value once"},
      {"\n  motion.speed:\n    - 1 mm/s\n    - 2 mm",
       "6: motion.speed: unknown unit 'mm' of a speed in '2 mm'; allowed: m/s, mm/s, cm/s, um/s"},
      {"{trials: 0}", "3: sweep.trials is '0'; allowed: 1 to 1000000"},
      {"{trials: {}}", "3: sweep.trials is a map; allowed: 1 to 1000000"},
      {"{motion.speed: [1, 2], trials: 500001}", " 2 grid cells of 500001 trials each; allowed: at most 1,000,000 trials"},
      {four_axes_of_32(), "3: the sweep has more than 1,000,000 grid cells; allowed: at most that"},
      {"{motion.speed: {min: 1, max: 2}}",
       "3: no key 'draw' in sweep.motion.speed; allowed: choice, log_uniform, lognormal, normal, uniform"},
      {"{motion.speed: {draw: unifrom, min: 1, max: 2}}",
       "3: unknown draw 'unifrom'; did you mean 'uniform'? allowed: choice, log_uniform, lognormal, normal, uniform"},
      {"{motion.speed: {draw: uniform, min: 1, max: 2, mean: 1}}",
       "3: unknown key 'mean' in sweep.motion.speed; did you mean 'max'? allowed: draw, max, min"},
      {"{motion.speed: {draw: uniform, min: 1}}", "3: no key 'max' in sweep.motion.speed; a draw 'uniform' needs it"},
      {"{motion.speed: {draw: uniform, min: 2, max: 1}}",
       "3: sweep.motion.speed.max: '1' is out of range; allowed: more than min"},
      {"{motion.speed: {draw: uniform, min: -1e308, max: 1e308}}",
       "3: sweep.motion.speed.max: '1e308' is out of range; allowed: an interval within a double's range"},
      {"{motion.speed: {draw: uniform, min: 1, max: inf}}",
       "3: sweep.motion.speed.max: 'inf' is infinite; allowed: a finite number"},
      {"{motion.speed: {draw: uniform, min: 1, max: fast}}",
       "3: sweep.motion.speed.max: 'fast' is not a number; allowed: a number, or one with a unit: %"},
      {"{motion.speed: {draw: uniform, min: 1, max: {}}}", "3: sweep.motion.speed.max is a map; allowed: a number"},
      {"{motion.speed: {draw: uniform, min: 1 mm/s, max: 2 mm}}",
       "3: sweep.motion.speed.max: '2 mm' does not fit the other numbers; allowed: a number in m/s"},
      {"{motion.speed: {draw: uniform, min: 1 N, max: 1.0000000000000002 N}}",
       "3 (drawn): motion.speed: unknown unit 'N' of a speed in '1 N'; allowed: m/s, mm/s, cm/s, um/s"},
      {"{motion.speed: {draw: normal, mean: 1, sd: -1}}", "3: sweep.motion.speed.sd: '-1' is out of range; allowed: >= 0"},
      {"{motion.speed: {draw: lognormal, median: 0, sd: 1}}", "3: sweep.motion.speed.median: '0' is out of range; allowed: > 0"},
      {"{motion.speed: {draw: lognormal, median: 1 m/s, sd: 1 m/s}}",
       "3: sweep.motion.speed.sd: unknown unit 'm/s' of a number in '1 m/s'; allowed: %"},
      {"{motion.speed: {draw: log_uniform, min: 0, max: 1}}", "3: sweep.motion.speed.min: '0' is out of range; allowed: > 0"},
      {"{motion.speed: {draw: normal, mean: 0, sd: 1 mm/s, min: 1 m/s}}",
       "3 (drawn): no draw within [1 m/s, inf] in 1000 tries; allowed: bounds nearer to the mean"},
      {"{motion.speed: {draw: choice, values: [2 mm]}}",
       "3 (drawn): motion.speed: unknown unit 'mm' of a speed in '2 mm'; allowed: m/s, mm/s, cm/s, um/s"},
      {"{motion.speed: {draw: choice, values: []}}",
       "3: sweep.motion.speed.values is empty; allowed: a sequence of at least one value"},
  };
  expect_answers(head + "sweep: ", swept);
  const std::vector<Case> below_head = {
      {"split: {by: material, share: [1, 0, 0]}", "3: unknown key 'share' in split; did you mean 'shares'? allowed: by, shares"},
      {"split: {by: colour}", "3: split.by: unknown value 'colour'; allowed: material, object, speed, trial"},
      {"split: {shares: [0.7, 0.2, 0.2]}",
       "3: split.shares: 0.7, 0.2, 0.2; allowed: shares of train, valid and test that are 1 in all, some of it for train"},
  };
  expect_answers(head, below_head);
}

TEST(SceneMessages, OfAFileThatCannotBeReadSaysWhy) {
  const auto load = [](const std::string& path) -> std::string {
    return refusal_of([&] { static_cast<void>(SceneFile::load(path)); });
  };
  EXPECT_EQ(load("/no/such/scene.yaml"), "/no/such/scene.yaml: cannot be read: No such file or directory");
  EXPECT_EQ(load("/tmp"), "/tmp: is a folder, no file");
  EXPECT_EQ(load("/dev/zero"), "/dev/zero: is a device, no file");
  const std::string pipe = testing::TempDir() + "slipbench_scene_pipe_" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(load(pipe), pipe + ": is a pipe, no file");  // without a writer, opening it would wait for ever
  std::filesystem::remove(pipe);
}

}  // namespace
}  // namespace slipbench

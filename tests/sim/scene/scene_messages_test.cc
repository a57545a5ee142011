// Errors of invalid scenes: every message names the place, what was found, what is allowed and the
// nearest name.
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench {
namespace {

// Two lines that make a valid scene; a case adds line 3 and below.
const std::string head = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

std::string answer(const std::string& text) {
  const Catalogues catalogues = test_catalogues();
  return refusal_of([&] { parse_scene(SceneFile::from_text(text, "s.yaml"), catalogues); });
}

using Case = Refused<>;  // its place is the line, "" if no line is at fault

// Expects each text, between `before` and `after`, to be refused as its case states.
void expect_answers(const std::string& before, const std::vector<Case>& cases, const std::string& after = "\n") {
  for (const auto& [text, line, words] : cases)
    EXPECT_THAT(answer(before + text + after), refused_at(line == "accepted" ? line : "s.yaml:" + line, words)) << text;
}

// yaml-cpp 0.8 also names the anchor.
TEST(SceneMessages, AnAliasWithoutAnAnchorIsRefused) {
  EXPECT_THAT(answer(head + "seed: 1\nmotion: *a\n"), refused_at("s.yaml:4", {"anchor"}));
}

// Two bodies and a pad that touches one, in four lines; a case adds line 5 and below.
const std::string bodies_head =
    "slipbench: 1\nbodies: {box: {shape: box}, table: {shape: plane}}\nsensors:\n  pad: {type: papillarray, touches: [box]}\n";
const std::string pad = "slipbench: 1\nsensors: {pad: {type: papillarray, ";
const std::string contact = head + "fidelity: mujoco_contact\ncontact: ";

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
      {"", "1", {"empty"}},
      {"\r\r", "1", {"empty"}},
      {"slipbench: 1\rseed: 1\r", "1", {"carriage return"}},
      {std::string(1'000'001, '#'), "", {"1000000"}},
  };
  expect_answers("", whole, "");
  const std::vector<Case> bare = {
      {"\r \t", "1", {"empty"}},
      {"# nothing", "1", {"empty"}},
      {"- 1", "1", {"sequence"}},
  };
  expect_answers("", bare);
  const std::vector<Case> below_head = {
      {"motion: {speed: 1", "4", {"YAML"}},
      {"motion:\n\tspeed: 1", "4", {"tab"}},
      {"motion:\n  speed: 1\n  \tgap: 1 mm", "5", {"tab"}},
      {"effects:\n\t- ageing\n\t- stribeck", "4", {"tab"}},
      {"\tseed: 1", "3", {"tab"}},
      {"seed:\t1\nmotion: {speed: 1", "5", {"YAML"}},
      {"---\nslipbench: 1", "3", {"second YAML document"}},
      {"seed: 1\nseed: 2", "4", {"duplicate", "seed", "s.yaml:3"}},
      {"motion:\n  speed: 1\n  gap: 1\n  speed: 2", "6", {"duplicate", "speed", "s.yaml:4"}},
      {"motion: &a {speed: 1}", "3", {"anchors"}},
      {"seed: !!int 1", "3", {"tags"}},
      {"motion: {<<: {speed: 1}}", "3", {"merge keys"}},
      {"? {a: b}\n: 1", "3", {"key", "brackets"}},
      {"~: 1", "3", {"key", "brackets"}},
      {"seed: 1\x01", "3", {"byte 56", "UTF-8"}},
      {"description: \xff", "3", {"byte 62", "UTF-8"}},
      {"description: \xc0\xaf", "3", {"byte 62", "UTF-8"}},
      {"description: \xed\xa0\x80", "3", {"byte 62", "UTF-8"}},
      {"description: \"a\\0b\"", "3", {"a\\x00b", "zero byte"}},
      {"effects: " + std::string(64, '[') + std::string(64, ']'), "3", {"nested", "64"}},
  };
  expect_answers(head, below_head);
}

TEST(SceneMessages, OfTopLevel) {
  const std::vector<Case> bare = {
      {"sensors: {pad: {type: papillarray}}", "1", {"no key", "slipbench"}},
      {"slipbench: 2", "1", {"slipbench", "2", "1"}},
      {"slipbench: 1\nsensors: {b: {type: papillarray}, a: {type: papillarray}}\ndetector: {type: ratio}",
       "3",
       {"sensor", "detector", "a, b"}},
  };
  expect_answers("", bare);
  const std::vector<Case> below_head = {
      {"motoin: {}", "3", {"motoin", "motion"}},
      {"expect: 1 s", "3", {"expect", "1 s"}},
      {"expect:", "3", {"expect", "nothing"}},
      {"expect: {gros_slip_by: 1 s}", "3", {"gros_slip_by", "expect", "gross_slip_by"}},
      {"sweep: {expect.gross_slip_by: [1 s]}", "3", {"expect.gross_slip_by", "swept"}},
      {"description: {a: b}", "3", {"description", "map"}},
      {"duration: 0 s", "3", {"duration", "0 s", "86400 s"}},
      {"duration: inf", "3", {"duration", "inf", "finite"}},
      {"duration: 4 m", "3", {"duration", "4 m", "time"}},
      {"duration:", "3", {"duration", "nothing"}},
      {"duration: [4]", "3", {"duration", "sequence"}},
      {"time_step: small", "3", {"time_step", "small", "time"}},
      {"duration: 1 s\ntime_step: 2 s", "4", {"time_step", "2 s", "1 s", "auto"}},
      {"time_step: 10 us\nduration: 1001 s", "3", {"time_step", "10 us", "100,000,000", "10.01 us"}},
      {"fidelity: feild", "3", {"fidelity", "feild", "field"}},
      {"contact: {noslip: 3}", "3", {"contact", "field", "fidelity: mujoco_contact"}},
      {"fidelity: articulated\ncontact: {}", "4", {"contact", "articulated", "fidelity: mujoco_contact"}},
      {"seed: -1", "3", {"seed", "-1", "18446744073709551615"}},
      {"seed: 18446744073709551616", "3", {"seed", "18446744073709551616", "18446744073709551615"}},
      {"detector: {type: traned}", "3", {"detector", "traned", "trained"}},
      {"detector: ratio", "3", {"detector", "'ratio'"}},
      {"detector: {}", "3", {"no key", "type", "detector"}},
      {"detector: {type: []}", "3", {"detector.type", "sequence"}},
      {"detector: {type: ratio, treshold: 1}", "3", {"treshold", "detector", "threshold"}},
      {"detector:\n  type: ratio\n  threshold: -1", "5", {"detector.threshold", "-1", "0"}},
      {"detector: {type: ratio, sensor: pat}", "3", {"detector.sensor", "pat", "pad"}},
      {"detector: {type: trained, memories: [a]}", "3", {"detector.memories", "sequence"}},
      {"detector: {type: trained, memories: ''}", "3", {"detector.memories", "empty", "own"}},
      {"controller: {type: grip}", "3", {"controller", "grip"}},
      {"detector: {type: none, gain: 1}", "3", {"gain", "detector", "type"}},
      {"controller: none", "3", {"controller", "'none'"}},
  };
  expect_answers(head, below_head);
  const std::vector<Case> of_contact = {
      {"[]", "4", {"contact", "sequence"}},
      {"{no_slip: 3}", "4", {"no_slip", "contact", "noslip"}},
      {"{cone: eliptic}", "4", {"contact.cone", "eliptic", "elliptic"}},
      {"{integrator: euler}", "4", {"contact.integrator", "euler", "Euler"}},
      {"\n  noslip: 3\n  solref: [0.02, -1]", "6", {"contact.solref", "0.02, -1"}},
      {"{solref: [0, 0]}", "4", {"contact.solref", "0, 0"}},
      {"{solreffriction: [0.02, 0]}", "4", {"contact.solreffriction", "0.02, 0"}},
      {"\n  noslip: 3\n  solreffriction: [0.002, 1]", "6", {"contact.solreffriction", "pyramidal", "cone: elliptic"}},
      {"{solimp: [0.9, 1, 0.001]}", "4", {"contact.solimp.1", "1", "1e-04", "0.9999"}},
      {"\n  noslip: 3\n  solimp:\n    - 0.9\n    - 0.95\n    - 0", "9", {"contact.solimp.2", "depth of 0", "1e-15 m"}},
      {"{solimp: [0.9, 0.95, 1e-15]}", "4", {"contact.solimp.2", "1e-15", "1e-15 m"}},
      {"{solimp: [0.00009, 0.95, 0.001]}", "4", {"contact.solimp.0", "9e-05", "1e-04", "0.9999"}},
      {"{solimp: [0.9, 0.95, 0.001, 0.5, 0]}", "4", {"contact.solimp", "5 entries", "3"}},
      {"{impratio: 1e-16}", "4", {"contact.impratio", "1e-16", "1e-15"}},
      {"{tip_mass: 0 g}", "4", {"contact.tip_mass", "0 g", "> 0 g"}},
      {"{cone: elliptic, solref: [-1e7, -6325], solreffriction: [0.002, 1], solimp: [0.99, 0.999, 0.001]}", "accepted", {}},
      {"nothing", "4", {"contact", "'nothing'"}},
  };
  expect_answers(contact, of_contact);
}

TEST(SceneMessages, OfBodies) {
  const std::vector<Case> bodies = {
      {"[box]", "3", {"bodies", "sequence"}},
      {"{}", "3", {"bodies", "empty"}},
      {"{my box: {shape: box}}", "3", {"my box", "body"}},
      {"{box: box}", "3", {"bodies.box", "'box'"}},
      {"{box: {mass: 1}}", "3", {"no key", "shape", "bodies.box", "box, plane"}},
      {"{box: {shape: bax}}", "3", {"body shape", "bax", "box"}},
      {"{box: {shape: box, masse: 1}}", "3", {"masse", "bodies.box", "mass"}},
      {"{box: {shape: box, mass: 0}}", "3", {"bodies.box.mass", "0", "0 kg"}},
      {"{box: {shape: box}}\nhold: {against: pad}", "4", {"no key", "body", "hold"}},
      {"{box: {shape: box}}\nhold: {body: box, against: pad, until: 1 s}", "4", {"until", "hold"}},
      {"{box: {shape: box}}\nhold: {body: box, against: pad, from: 100 s}", "4", {"hold.from", "100 s", "4 s"}},
      {"{box: {shape: box}}\nhold: {body: box,\n  against: box}", "5", {"hold.against", "box"}},
  };
  expect_answers(head + "bodies: ", bodies);
  const std::vector<Case> of_a_sensor = {
      {"{type: papillarray}", "4", {"no key", "touches", "sensors.pad"}},
      {"{type: papillarray, touches: box}", "4", {"sensors.pad.touches", "'box'", "[box]"}},
      {"{type: papillarray, touches: []}", "4", {"sensors.pad.touches", "empty"}},
      {"{type: papillarray, touches: [box, box]}", "4", {"box", "twice", "sensors.pad.touches"}},
      {"{type: papillarray, touches: [box], damping: -1 ms}", "4", {"sensors.pad.damping", "-1 ms", "0 ms"}},
      {"{type: papillarray, touches: [box], site: tip}\nmotion: {speed: 1 mm/s}", "5", {"motion", "site"}},
  };
  expect_answers("slipbench: 1\nbodies: {box: {shape: box}}\nsensors:\n  pad: ", of_a_sensor);
  const std::vector<Case> below_head = {
      {"model: ''", "3", {"model", "empty", "MJCF"}},
      {"model: {}", "3", {"model", "map", "MJCF"}},
      {"gravity: 9.81", "3", {"gravity", "box", "model", "bodies"}},
      {"controls: {}", "3", {"controls", "model", "bodies"}},
      {"field_solver: implicit", "3", {"field_solver", "box", "model", "bodies"}},
      {"hold: {}", "3", {"hold", "model", "bodies"}},
      {"integrator: RK4", "3", {"integrator", "box", "model", "bodies"}},
      {"field_solver: explicit", "3", {"field_solver", "box", "model", "bodies"}},
  };
  expect_answers(head, below_head);
  const std::vector<Case> of_the_pad = {
      {"site: tip", "2", {"site", "sensors.pad", "model", "bodies"}},
      {"touches: [box]", "2", {"touches", "sensors.pad", "model", "bodies"}},
      {"damping: 1 ms", "2", {"damping", "sensors.pad", "box", "model", "bodies"}},
  };
  expect_answers(pad, of_the_pad, "}}\n");
  const std::vector<Case> touching = {
      {"gravity: 9.81 m/s", "5", {"gravity", "9.81 m/s", "acceleration", "m/s2"}},
      {"gravity: -1", "5", {"gravity", "-1", "0 m/s2", "1000 m/s2"}},
      {"field_solver: implicite", "5", {"field_solver", "implicite", "implicit"}},
      {"fidelity: articulated\nfield_solver: implicit", "6", {"field_solver", "implicit", "fidelity: articulated"}},
      {"integrator: RK5", "5", {"integrator", "RK5", "RK4"}},
      {"fidelity: articulated\nintegrator: Euler", "6", {"integrator", "Euler", "fidelity: articulated"}},
      {"fidelity: mujoco_contact\nintegrator: Euler",
       "6",
       {"integrator", "Euler", "fidelity: mujoco_contact", "contact.integrator"}},
      {"field_solver: implicit\nintegrator: RK4", "6", {"integrator", "RK4", "implicit", "discrete"}},
      {"integrator: RK4", "accepted", {}},
      {"surface: {material: felt, shape: plane}", "5", {"shape", "surface", "bodies", "material"}},
      {"  skin: {type: papillarray, follows: pat}", "5", {"sensors.skin.follows", "pat", "pad"}},
      {"  skin: {type: papillarray, follows: nib}\n  nib: {type: papillarray, follows: pad}",
       "5",
       {"sensors.skin.follows", "nib"}},
      {"  skin: {type: papillarray, follows: pad, touches: [box]}", "5", {"touches", "sensors.skin"}},
      {"  skin: {type: papillarray, ahead: 1 mm, touches: [box]}", "5", {"ahead", "follows", "sensors.skin"}},
      {"  skin: {type: papillarray, follows: pad, ahead: -1 mm}", "5", {"sensors.skin.ahead", "-1 mm", "0 mm", "10 mm"}},
      {"  skin: {type: papillarray, follows: pad}\nfidelity: articulated",
       "5",
       {"follows", "sensors.skin", "articulated", "fidelity: field"}},
      {"controls: [1]", "5", {"controls", "sequence"}},
      {"controls: {grip: 4 Nn}", "5", {"controls.grip", "4 Nn", "N"}},
      {"controls: {grip: {}}", "5", {"controls.grip", "map"}},
      {"controls: {grip: [[0 s, 1 N], 2 N]}", "5", {"controls.grip.1", "2 N"}},
      {"controls: {grip: [[1 s, 1 N], [1 s, 2 N]]}", "5", {"controls.grip.1", "ascend", "1 s"}},
      {"controls: {grip: inf}", "5", {"controls.grip", "inf", "finite"}},
  };
  expect_answers(bodies_head, touching);
  const std::vector<Case> version_alone = {
      {"sensors: {pad: {type: papillarray}, skin: {type: papillarray, follows: pad}}",
       "2",
       {"follows", "sensors.skin", "box", "model", "bodies"}},
  };
  expect_answers("slipbench: 1\n", version_alone);
}

TEST(SceneMessages, OfParts) {
  const std::vector<Case> below_head = {
      {"surface: {material: acryl}", "3", {"material", "acryl", "acrylic"}},
      {"surface:\n  shape: plan", "4", {"surface shape", "plan", "plane"}},
      {"surface: {radius: 1 m}", "3", {"radius", "surface"}},
      {"surface: ptfe", "3", {"surface", "'ptfe'"}},
      {"friction: {mu: 1}", "3", {"mu", "friction"}},
      {"friction: {static: -0.1}", "3", {"friction.static", "-0.1", "0", "100"}},
      {"friction: {static: 101}", "3", {"friction.static", "101", "0", "100"}},
      {"friction:\n  static: 0.5\n  kinetic: 0.6", "5", {"friction.kinetic", "0.6", "0.5"}},
      {"friction: {kinetic: 0.6}", "3", {"friction.kinetic", "0.6", "0.5", "acrylic"}},
      {"friction: {scale: 0}", "3", {"friction.scale", "'0'", "100"}},
      {"friction: {scale: 1e300}", "3", {"friction.scale", "1e300", "100"}},
      {"motion: {kind: satge}", "3", {"motion", "satge", "stage"}},
      {"motion: {speed: inf}", "3", {"motion.speed", "inf", "finite"}},
      {"motion: {speed: .nan}", "3", {"motion.speed", ".nan", "mm/s"}},
      {"motion: {pivot: 1 mm}", "3", {"motion.pivot", "'1 mm'", "2"}},
      {"motion: {pivot: [1, 2, 3]}", "3", {"motion.pivot", "3 entries", "2"}},
      {"motion:\n  tilt:\n    - 1 deg\n    - 90 deg", "6", {"motion.tilt.1", "90 deg", "-28.64 deg", "28.64 deg"}},
      {"effects: ageing", "3", {"effects", "'ageing'"}},
      {"effects: [agein]", "3", {"effect", "agein", "ageing"}},
      {"effects:\n  - ageing\n  - ageing: {rate: 1}", "5", {"effect", "ageing", "twice"}},
      {"effects: [{ageing: {}, stribeck: {}}]", "3", {"effects.0", "map", "2 keys"}},
      {"effects: [{ageing: {rte: 1}}]", "3", {"rte", "ageing", "rate"}},
      {"effects: [{ageing: 3}]", "3", {"effects.ageing", "3"}},
  };
  expect_answers(head, below_head);
  const std::vector<Case> version_alone = {
      {"seed: 2", "1", {"no key", "sensors"}},
      {"sensors: {}", "2", {"sensors", "empty"}},
      {"sensors: {2nd pad: {type: papillarray}}", "2", {"2nd pad", "sensor"}},
      {"sensors:\n  pad: {rate: 1 kHz}", "3", {"no key", "type", "sensors.pad"}},
      {"sensors: {pad: {type: papilarray}}", "2", {"sensor", "papilarray", "papillarray"}},
  };
  expect_answers("slipbench: 1\n", version_alone);
  const std::vector<Case> of_the_pad = {
      {"bristle: 6", "2", {"bristle", "sensors.pad", "bristles"}},
      {"profile: grip", "2", {"sensors.pad.profile", "grip", "gripper, hexapod"}},
      {"bristles: 2.5", "2", {"sensors.pad.bristles", "2.5", "whole number"}},
      {"bias: on", "2", {"sensors.pad.bias", "on", "true, false"}},
      {"electronics: idea", "2", {"sensors.pad.electronics", "idea", "ideal"}},
      {"electronics: [nose]", "2", {"nose", "noise"}},
  };
  expect_answers(pad, of_the_pad, "}}\n");
}

TEST(SceneMessages, OfSweep) {
  const std::vector<Case> swept = {
      {"[1]", "3", {"sweep", "sequence"}},
      {paths_of(1001), "3", {"sweep", "1001", "1000"}},
      {"{motion.speed: 1}", "3", {"sweep.motion.speed", "'1'"}},
      {"{motion.speed: []}", "3", {"sweep.motion.speed", "empty"}},
      {"{motion.sped: [1]}", "3", {"sped", "motion", "speed"}},
      {"{motion.: [1]}", "3", {"'motion.'", "path"}},
      {"{scene: [{seed: 1}]}", "3", {"seed", "swept"}},
      {"{scene: 1}", "3", {"sweep.scene", "1", "draw"}},
      {"{scene: [1, 2]}", "3", {"sweep.scene", "1"}},
      {"{motion.speed: [1, 2], scene: [{motion: {speed: 1}}]}", "3", {"sweep.scene", "sweep.motion.speed"}},
      {"{seed: [1, 2]}", "3", {"seed", "swept"}},
      {"{motion.tilt.0: [1]}", "3", {"0", "motion.tilt"}},
      {"{split: [{by: trial}]}", "3", {"split", "swept"}},
      {"{motion: [{speed: 1}, {gap: 2}], motion.speed: [1]}", "3", {"sweep.motion.speed", "sweep.motion"}},
      {"{motion.tilt: [[0, 0]], motion.tilt.0: [1]}", "3", {"sweep.motion.tilt.0", "sweep.motion.tilt"}},
      {"\n  motion.speed:\n    - 1 mm/s\n    - 2 mm", "6", {"motion.speed", "2 mm", "speed"}},
      {"{trials: 0}", "3", {"sweep.trials", "0", "1", "1000000"}},
      {"{trials: {}}", "3", {"sweep.trials", "map", "1000000"}},
      {"{motion.speed: [1, 2], trials: 500001}", "", {"2 grid cells", "500001", "1,000,000"}},
      {four_axes_of_32(), "3", {"sweep", "1,000,000"}},
      {"{motion.speed: {min: 1, max: 2}}", "3", {"no key", "draw", "sweep.motion.speed", "uniform"}},
      {"{motion.speed: {draw: unifrom, min: 1, max: 2}}", "3", {"draw", "unifrom", "uniform"}},
      {"{motion.speed: {draw: uniform, min: 1, max: 2, mean: 1}}", "3", {"mean", "sweep.motion.speed", "max"}},
      {"{motion.speed: {draw: uniform, min: 1}}", "3", {"max", "uniform", "sweep.motion.speed"}},
      {"{motion.speed: {draw: uniform, min: 2, max: 1}}", "3", {"sweep.motion.speed.max", "1", "min"}},
      {"{motion.speed: {draw: uniform, min: -1e308, max: 1e308}}", "3", {"sweep.motion.speed.max", "1e308", "double"}},
      {"{motion.speed: {draw: uniform, min: 1, max: inf}}", "3", {"sweep.motion.speed.max", "inf", "finite"}},
      {"{motion.speed: {draw: uniform, min: 1, max: fast}}", "3", {"sweep.motion.speed.max", "fast", "number"}},
      {"{motion.speed: {draw: uniform, min: 1, max: {}}}", "3", {"sweep.motion.speed.max", "map"}},
      {"{motion.speed: {draw: uniform, min: 1 mm/s, max: 2 mm}}", "3", {"sweep.motion.speed.max", "2 mm", "m/s"}},
      {"{motion.speed: {draw: uniform, min: 1 N, max: 1.0000000000000002 N}}", "3 (drawn)", {"motion.speed", "1 N", "speed"}},
      {"{motion.speed: {draw: normal, mean: 1, sd: -1}}", "3", {"sweep.motion.speed.sd", "-1", "0"}},
      {"{motion.speed: {draw: lognormal, median: 0, sd: 1}}", "3", {"sweep.motion.speed.median", "'0'", "0"}},
      {"{motion.speed: {draw: lognormal, median: 1 m/s, sd: 1 m/s}}", "3", {"sweep.motion.speed.sd", "1 m/s", "%"}},
      {"{motion.speed: {draw: log_uniform, min: 0, max: 1}}", "3", {"sweep.motion.speed.min", "'0'", "0"}},
      {"{motion.speed: {draw: normal, mean: 0, sd: 1 mm/s, min: 1 m/s}}", "3 (drawn)", {"1 m/s", "1000"}},
      {"{motion.speed: {draw: choice, values: [2 mm]}}", "3 (drawn)", {"motion.speed", "2 mm", "speed"}},
      {"{motion.speed: {draw: choice, values: []}}", "3", {"sweep.motion.speed.values", "empty"}},
  };
  expect_answers(head + "sweep: ", swept);
  const std::vector<Case> below_head = {
      {"split: {by: material, share: [1, 0, 0]}", "3", {"share", "split", "shares"}},
      {"split: {by: colour}", "3", {"split.by", "colour", "material"}},
      {"split: {shares: [0.7, 0.2, 0.2]}", "3", {"split.shares", "0.7, 0.2, 0.2", "1"}},
  };
  expect_answers(head, below_head);
}

// A name without a near match is answered with all declared names.
TEST(SceneMessages, UnknownNameListsAllThatAreAllowed) {
  const Catalogues catalogues = test_catalogues();
  const auto names = [](const auto& declared, std::vector<std::string> more = {}) {
    for (const auto& one : declared) more.push_back(one.name);
    return more;
  };
  EXPECT_THAT(answer(head + "xyzzy: 1\n"),
              mentions({"bodies",   "box",       "contact",    "controller", "controls",     "description", "detector",
                        "duration", "effects",   "expect",     "fidelity",   "field_solver", "friction",    "gravity",
                        "grip",     "hold",      "integrator", "model",      "motion",       "scatter",     "seed",
                        "sensors",  "slipbench", "split",      "surface",    "sweep",        "time_step"}));
  EXPECT_THAT(answer(pad + "xyzzy: 1}}\n"),
              mentions(names(catalogues.sensors.at(0).parameters,
                             {"ahead", "damping", "electronics", "follows", "site", "touches", "type"})));
  EXPECT_THAT(answer(head + "motion: {xyzzy: 1}\n"), mentions(names(catalogues.motions.at(0).parameters, {"kind"})));
  EXPECT_THAT(answer(head + "motion: {kind: xyzzy}\n"), mentions(names(catalogues.motions)));
  EXPECT_THAT(answer(head + "surface: {material: xyzzy}\n"), mentions(names(catalogues.materials)));
  EXPECT_THAT(answer(head + "surface: {shape: xyzzy}\n"), mentions(names(catalogues.surfaces)));
  EXPECT_THAT(answer(head + "effects: [xyzzy]\n"), mentions(names(catalogues.effects)));
  EXPECT_THAT(answer(head + "detector: {type: xyzzy}\n"), mentions(names(catalogues.detectors, {"none"})));
  EXPECT_THAT(answer(head + "bodies: {box: {shape: xyzzy}}\n"), mentions(names(catalogues.bodies)));
}

TEST(SceneMessages, OfAFileThatCannotBeReadSaysWhy) {
  const auto load = [](const std::string& path) -> std::string {
    return refusal_of([&] { static_cast<void>(SceneFile::load(path)); });
  };
  EXPECT_THAT(load("/no/such/scene.yaml"), refused_at("/no/such/scene.yaml", {"No such file or directory"}));
  EXPECT_THAT(load("/tmp"), refused_at("/tmp", {"a folder"}));
  EXPECT_THAT(load("/dev/zero"), refused_at("/dev/zero", {"a device"}));
  const std::string pipe = testing::TempDir() + "slipbench_scene_pipe_" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(load(pipe), refused_at(pipe, {"a pipe"}));  // without a writer, opening it would wait for ever
  std::filesystem::remove(pipe);
}

}  // namespace
}  // namespace slipbench

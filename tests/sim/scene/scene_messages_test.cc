// What a scene that is wrong is answered: every message names the place, what was found, what is allowed and the nearest name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <ostream>
#include <string>

#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench {
namespace {

// Two lines that make a valid scene: what a case adds stands in line 3 and below.
const std::string head = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

std::string answer(const std::string& text) {
  const Catalogues catalogues = test_catalogues();
  try {
    parse_scene(SceneFile::from_text(text, "s.yaml"), catalogues);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string with_contact(const std::string& contact) { return head + "fidelity: mujoco_contact\ncontact: " + contact + "\n"; }

struct Case {
  const char* name;
  std::string text;
  std::string message;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Refusal : public testing::TestWithParam<Case> {};

TEST_P(Refusal, HasItsMessage) { EXPECT_EQ(answer(GetParam().text), GetParam().message) << GetParam().text; }

// yaml-cpp 0.8 names the anchor, too.
TEST(Yaml, AnAliasWithoutAnAnchorIsRefused) {
  EXPECT_THAT(answer(head + "seed: 1\nmotion: *a\n"),
              testing::StartsWith("s.yaml:4: not valid YAML: the referenced anchor is not defined"));
}

std::string case_name(const testing::TestParamInfo<Case>& info) { return info.param.name; }

const std::string scene_keys =
    "accuracy, bodies, box, contact, controller, controls, description, detector, duration, effects, expect, fidelity, field_solver, friction, gravity, grip, hold, integrator, model, motion, scatter, seed, sensors, slipbench, split, surface, sweep, time_step";
const std::string sensor_keys =
    "bias, bristle_spread, bristles, damping, electronics, follows, profile, rate, site, touches, type";
const std::string materials =
    "acrylic, cardboard, felt, glass, masonite, paper, ptfe, rubber, soaped_wavy_acrylic, wavy_acrylic, wet_felt, wet_paper, wet_ptfe, wet_rubber";

std::string tab(int line) {
  return "s.yaml:" + std::to_string(line) + ": a tab before the first word; allowed: spaces, since tabs cannot indent YAML";
}

INSTANTIATE_TEST_SUITE_P(
    Yaml, Refusal,
    testing::Values(
        Case{"Empty", "", "s.yaml:1: empty"},  //
        Case{"BlankOnly", "\r \t\n", "s.yaml:1: empty"}, Case{"CarriageReturnsOnly", "\r\r", "s.yaml:1: empty"},
        Case{"CarriageReturnsForLineFeeds", "slipbench: 1\rseed: 1\r",
             "s.yaml:1: lines end with a carriage return alone; allowed: a line feed, with or without a carriage return"},
        Case{"CommentOnly", "# nothing\n", "s.yaml:1: empty"},
        Case{"Syntax", head + "motion: {speed: 1\n", "s.yaml:4: not valid YAML: end of map flow not found"},
        Case{"Tab", head + "motion:\n\tspeed: 1\n", tab(4)},
        Case{"TabAfterSpaces", head + "motion:\n  speed: 1\n  \tgap: 1 mm\n", tab(5)},
        Case{"TabBeforeEveryLine", head + "effects:\n\t- ageing\n\t- stribeck\n", tab(4)},
        Case{"TabAtTheTop", head + "\tseed: 1\n", tab(3)},
        Case{"TabInsideALine", head + "seed:\t1\nmotion: {speed: 1\n", "s.yaml:5: not valid YAML: end of map flow not found"},
        Case{"SecondDocument", head + "---\nslipbench: 1\n", "s.yaml:3: a second document; allowed: one document a file"},
        Case{"DuplicateKey", head + "seed: 1\nseed: 2\n", "s.yaml:4: duplicate key 'seed', first at s.yaml:3"},
        Case{"DuplicateNestedKey", head + "motion:\n  speed: 1\n  gap: 1\n  speed: 2\n",
             "s.yaml:6: duplicate key 'speed', first at s.yaml:4"},
        Case{"Anchor", head + "motion: &a {speed: 1}\n", "s.yaml:3: anchors ('&name') are not allowed"},
        Case{"Tag", head + "seed: !!int 1\n", "s.yaml:3: tags ('!name') are not allowed"},
        Case{"MergeKey", head + "motion: {<<: {speed: 1}}\n", "s.yaml:3: merge keys ('<<') are not allowed"},
        Case{"MapAsKey", head + "? {a: b}\n: 1\n", "s.yaml:3: a key that is not text; are all brackets closed?"},
        Case{"NullKey", head + "~: 1\n", "s.yaml:3: a key that is not text; are all brackets closed?"},
        Case{"ControlCharacter", head + "seed: 1\x01\n", "s.yaml:3: byte 56 is not text; allowed: UTF-8 text"},
        Case{"NotUtf8", head + "description: \xff\n", "s.yaml:3: byte 62 is not text; allowed: UTF-8 text"},
        Case{"Overlong", head + "description: \xc0\xaf\n", "s.yaml:3: byte 62 is not text; allowed: UTF-8 text"},
        Case{"Surrogate", head + "description: \xed\xa0\x80\n", "s.yaml:3: byte 62 is not text; allowed: UTF-8 text"},
        Case{"ZeroByte", head + "description: \"a\\0b\"\n", "s.yaml:3: 'a\\x00b' holds a zero byte"},
        Case{"TooLong", std::string(1'000'001, '#'), "s.yaml: longer than 1000000 bytes; allowed: at most that"},
        Case{"TooDeep", head + "effects: " + std::string(64, '[') + std::string(64, ']') + "\n",
             "s.yaml:3: nested too deeply; allowed: 64 levels"},
        Case{"NotAMap", "- 1\n", "s.yaml:1: the scene is a sequence; allowed: a map of keys with values, 'slipbench: 1' first"}),
    case_name);

INSTANTIATE_TEST_SUITE_P(
    TopLevel, Refusal,
    testing::Values(
        Case{"NoVersion", "sensors: {pad: {type: papillarray}}\n",
             "s.yaml:1: no key 'slipbench'; a scene says its schema version: 'slipbench: 1'"},
        Case{"OtherVersion", "slipbench: 2\n", "s.yaml:1: slipbench is '2'; allowed: 1, the schema version"},
        Case{"UnknownKey", head + "motoin: {}\n",
             "s.yaml:3: unknown key 'motoin' in the scene; did you mean 'motion'? allowed: " + scene_keys},
        Case{"Expect", head + "expect: 1 s\n",
             "s.yaml:3: expect is '1 s'; allowed: a map of what must come out, such as 'gross_slip_by: 1.0 s'"},
        Case{"ExpectOfNothing", head + "expect:\n",
             "s.yaml:3: expect is nothing; allowed: a map of what must come out, such as 'gross_slip_by: 1.0 s'"},
        Case{
            "ExpectationUnknown", head + "expect: {gros_slip_by: 1 s}\n",
            "s.yaml:3: unknown key 'gros_slip_by' in expect; did you mean 'gross_slip_by'? allowed: confidence, control, gross_slip_by"},
        Case{
            "AccuracyOfNothing", head + "accuracy: {}\n",
            "s.yaml:3: accuracy is empty; allowed: creep, force, label, label_micro, micro_onset, onset, slip_distance, or accuracy: none"},
        Case{"AccuracyIsNoMap", head + "accuracy: 1 %\n",
             "s.yaml:3: accuracy is '1 %'; allowed: a map of what may be wrong by how much, such as 'onset: 1 %', or none"},
        Case{
            "AccuracyUnknown", head + "accuracy: {onsets: 1 %}\n",
            "s.yaml:3: unknown key 'onsets' in accuracy; did you mean 'onset'? allowed: creep, force, label, label_micro, micro_onset, onset, slip_distance"},
        Case{"AccuracyOfASpeedInShares", head + "accuracy: {creep: 1 %}\n",
             "s.yaml:3: accuracy.creep: unknown unit '%' of a speed in '1 %'; allowed: m/s, mm/s, cm/s, um/s"},
        Case{"AccuracyOfMoreThanAll", head + "accuracy: {onset: 200 %}\n",
             "s.yaml:3: accuracy.onset: '200 %' is out of range; allowed: > 0 and <= 1"},
        Case{"AccuracyBesideAStep", head + "accuracy: {onset: 1 %}\ntime_step: 1 ms\n",
             "s.yaml:4: 'time_step' is found for a scene that says its accuracy; allowed: one of the two"},
        Case{"AccuracyBesideASolver", head + "accuracy: {onset: 1 %}\nfield_solver: explicit\n",
             "s.yaml:4: 'field_solver' is found for a scene that says its accuracy; allowed: one of the two"},
        Case{"AccuracySwept", head + "sweep: {accuracy.onset: [1 %]}\n",
             "s.yaml:3: 'accuracy.onset' cannot be swept; allowed: any other key of the scene"},
        Case{"ExpectationSwept", head + "sweep: {expect.gross_slip_by: [1 s]}\n",
             "s.yaml:3: 'expect.gross_slip_by' cannot be swept; allowed: any other key of the scene"},
        Case{"DescriptionAsMap", head + "description: {a: b}\n", "s.yaml:3: description is a map; allowed: text"},
        Case{"NoDuration", head + "duration: 0 s\n", "s.yaml:3: duration: '0 s' is out of range; allowed: > 0 s and <= 86400 s"},
        Case{"EndlessDuration", head + "duration: inf\n", "s.yaml:3: duration: 'inf' is infinite; allowed: a finite number"},
        Case{"DurationInMetres", head + "duration: 4 m\n",
             "s.yaml:3: duration: unknown unit 'm' of a time in '4 m'; allowed: s, ms, us, min"},
        Case{"EmptyDuration", head + "duration:\n", "s.yaml:3: duration is nothing; allowed: a number such as 4 s"},
        Case{"DurationAsSequence", head + "duration: [4]\n", "s.yaml:3: duration is a sequence; allowed: a number such as 4 s"},
        Case{"TimeStepWord", head + "time_step: small\n",
             "s.yaml:3: time_step: 'small' is not a time; allowed: a number in s, or one with a unit: s, ms, us, min"},
        Case{"TimeStepTooLong", head + "duration: 1 s\ntime_step: 2 s\n",
             "s.yaml:4: time_step 2 s exceeds the duration; allowed: at most 1 s, or auto"},
        Case{"TimeStepTooShort", head + "time_step: 10 us\nduration: 1001 s\n",
             "s.yaml:3: time_step 10 us makes more than 100,000,000 steps; allowed: at least 10.01 us, or auto"},
        Case{"Fidelity", head + "fidelity: feild\n",
             "s.yaml:3: fidelity: unknown value 'feild'; did you mean 'field'? allowed: field, articulated, mujoco_contact"},
        Case{
            "ContactOfAField", head + "contact: {noslip: 3}\n",
            "s.yaml:3: 'contact' is of MuJoCo's own contact friction, and the fidelity is 'field'; allowed with 'fidelity: mujoco_contact'"},
        Case{
            "ContactOfTheRecipe", head + "fidelity: articulated\ncontact: {}\n",
            "s.yaml:4: 'contact' is of MuJoCo's own contact friction, and the fidelity is 'articulated'; allowed with 'fidelity: mujoco_contact'"},
        Case{"ContactAsASequence", with_contact("[]"), "s.yaml:4: contact is a sequence; allowed: a map of parameters, or none"},
        Case{
            "ContactKey", with_contact("{no_slip: 3}"),
            "s.yaml:4: unknown key 'no_slip' in contact; did you mean 'noslip'? allowed: cone, impratio, integrator, iterations, noslip, noslip_tolerance, refsafe, solimp, solref, solreffriction, solver, tip_damping, tip_mass, tolerance"},
        Case{"ContactCone", with_contact("{cone: eliptic}"),
             "s.yaml:4: contact.cone: unknown value 'eliptic'; did you mean 'elliptic'? allowed: elliptic, pyramidal"},
        Case{
            "ContactIntegrator", with_contact("{integrator: euler}"),
            "s.yaml:4: contact.integrator: unknown value 'euler'; did you mean 'Euler'? allowed: Euler, implicit, implicitfast, discrete, RK4"},
        Case{"ContactSolref", with_contact("\n  noslip: 3\n  solref: [0.02, -1]"),
             "s.yaml:6: contact.solref: 0.02, -1; allowed: two positive numbers, or two negative ones: -stiffness and -damping"},
        Case{"ContactSolrefOfNothing", with_contact("{solref: [0, 0]}"),
             "s.yaml:4: contact.solref: 0, 0; allowed: two positive numbers, or two negative ones: -stiffness and -damping"},
        Case{"ContactSolreffriction", with_contact("{solreffriction: [0.02, 0]}"),
             "s.yaml:4: contact.solreffriction: 0.02, 0; allowed: two positive numbers, two negative ones, or 0, 0: as solref"},
        Case{
            "ContactSolreffrictionOfPyramidalCones", with_contact("\n  noslip: 3\n  solreffriction: [0.002, 1]"),
            "s.yaml:6: contact.solreffriction: MuJoCo leaves it aside under pyramidal cones, its default; allowed with: cone: elliptic"},
        Case{"ContactSolimp", with_contact("{solimp: [0.9, 1, 0.001]}"),
             "s.yaml:4: contact.solimp.1: 1 would be clipped by MuJoCo; allowed: 1e-04 to 0.9999"},
        Case{
            "ContactSolimpOfNoDepth", with_contact("\n  noslip: 3\n  solimp:\n    - 0.9\n    - 0.95\n    - 0"),
            "s.yaml:9: contact.solimp.2: of a depth of 0 MuJoCo makes a constant impedance, the mean of the two; allowed: > 1e-15 m"},
        Case{
            "ContactSolimpAtTheLeastDepth", with_contact("{solimp: [0.9, 0.95, 1e-15]}"),
            "s.yaml:4: contact.solimp.2: of a depth of 1e-15 MuJoCo makes a constant impedance, the mean of the two; allowed: > 1e-15 m"},
        Case{"ContactSolimpBelow", with_contact("{solimp: [0.00009, 0.95, 0.001]}"),
             "s.yaml:4: contact.solimp.0: 9e-05 would be clipped by MuJoCo; allowed: 1e-04 to 0.9999"},
        Case{"ContactSolimpOfMore", with_contact("{solimp: [0.9, 0.95, 0.001, 0.5, 0]}"),
             "s.yaml:4: contact.solimp has 5 entries; allowed: a sequence of 3 such as [0.9, 0.95, 0.001]"},
        Case{"ContactImpratio", with_contact("{impratio: 1e-16}"),
             "s.yaml:4: contact.impratio: '1e-16' is out of range; allowed: >= 1e-15"},
        Case{"ContactTipMass", with_contact("{tip_mass: 0 g}"),
             "s.yaml:4: contact.tip_mass: '0 g' is out of range; allowed: > 0 kg"},
        Case{"ContactAccepted",
             with_contact("{cone: elliptic, solref: [-1e7, -6325], solreffriction: [0.002, 1], solimp: [0.99, 0.999, 0.001]}"),
             "accepted"},
        Case{"ContactWord", with_contact("nothing"), "s.yaml:4: contact is 'nothing'; allowed: a map of parameters, or none"},
        Case{"NegativeSeed", head + "seed: -1\n", "s.yaml:3: seed: '-1' is no seed; allowed: 0 to 18446744073709551615"},
        Case{"HugeSeed", head + "seed: 18446744073709551616\n",
             "s.yaml:3: seed: '18446744073709551616' is no seed; allowed: 0 to 18446744073709551615"},
        Case{"Detector", head + "detector: {type: traned}\n",
             "s.yaml:3: unknown detector 'traned'; did you mean 'trained'? allowed: none, ratio, trained"},
        Case{"DetectorAsAName", head + "detector: ratio\n",
             "s.yaml:3: detector is 'ratio'; allowed: a map of 'type' and parameters"},
        Case{"DetectorWithoutType", head + "detector: {}\n",
             "s.yaml:3: no key 'type' in detector; allowed: none, ratio, trained"},
        Case{"DetectorTypeIsNoName", head + "detector: {type: []}\n",
             "s.yaml:3: detector.type is a sequence; allowed: the name of a detector"},
        Case{"DetectorParameter", head + "detector: {type: ratio, treshold: 1}\n",
             "s.yaml:3: unknown key 'treshold' in detector; did you mean 'threshold'? allowed: sensor, threshold, type"},
        Case{"DetectorParameterRange", head + "detector:\n  type: ratio\n  threshold: -1\n",
             "s.yaml:5: detector.threshold: '-1' is out of range; allowed: > 0"},
        Case{"DetectorSensor", head + "detector: {type: ratio, sensor: pat}\n",
             "s.yaml:3: detector.sensor: no sensor 'pat'; did you mean 'pad'? allowed: pad"},
        Case{"DetectorOfSeveralSensors",
             "slipbench: 1\nsensors: {b: {type: papillarray}, a: {type: papillarray}}\ndetector: {type: ratio}\n",
             "s.yaml:3: no key 'sensor' in detector, and the scene has several; allowed: a, b"},
        Case{"DetectorPath", head + "detector: {type: trained, memories: [a]}\n",
             "s.yaml:3: detector.memories is a sequence; allowed: a path from the scene's own folder, or own"},
        Case{"DetectorPathIsEmpty", head + "detector: {type: trained, memories: ''}\n",
             "s.yaml:3: detector.memories: the path is empty; allowed: a path, or own"},
        Case{"ControllerType", head + "controller: {type: grip}\n", "s.yaml:3: unknown controller 'grip'; allowed: none"},
        Case{"DetectorKey", head + "detector: {type: none, gain: 1}\n",
             "s.yaml:3: unknown key 'gain' in detector; allowed: type"},
        Case{"Controller", head + "controller: none\n",
             "s.yaml:3: controller is 'none'; allowed: a map of 'type' and parameters"}),
    case_name);

// Two bodies and a pad that touches one, in four lines; what a case adds stands in line 5 and below.
const std::string bodies_head =
    "slipbench: 1\nbodies: {box: {shape: box}, table: {shape: plane}}\nsensors:\n  pad: {type: papillarray, touches: [box]}\n";
std::string with_sensor(const std::string& sensor) {
  return "slipbench: 1\nbodies: {box: {shape: box}}\nsensors:\n  pad: " + sensor + "\n";
}
std::string with_bodies(const std::string& bodies) { return head + "bodies: " + bodies + "\n"; }

INSTANTIATE_TEST_SUITE_P(
    Bodies, Refusal,
    testing::Values(
        Case{"BodiesAsSequence", with_bodies("[box]"),
             "s.yaml:3: bodies is a sequence; allowed: a map of bodies, such as 'box: {shape: box}'"},
        Case{"NoBodies", with_bodies("{}"), "s.yaml:3: bodies is empty; allowed: a map of bodies, such as 'box: {shape: box}'"},
        Case{"BodyName", with_bodies("{my box: {shape: box}}"),
             "s.yaml:3: 'my box' cannot name a body; allowed: letters, digits and '_', no digit first"},
        Case{"BodyAsName", with_bodies("{box: box}"), "s.yaml:3: bodies.box is 'box'; allowed: a map of 'shape' and parameters"},
        Case{"BodyWithoutShape", with_bodies("{box: {mass: 1}}"), "s.yaml:3: no key 'shape' in bodies.box; allowed: box, plane"},
        Case{"BodyShape", with_bodies("{box: {shape: bax}}"),
             "s.yaml:3: unknown body shape 'bax'; did you mean 'box'? allowed: box, plane"},
        Case{
            "BodyKey", with_bodies("{box: {shape: box, masse: 1}}"),
            "s.yaml:3: unknown key 'masse' in bodies.box; did you mean 'mass'? allowed: free, friction, mass, position, shape, size"},
        Case{"BodyMass", with_bodies("{box: {shape: box, mass: 0}}"),
             "s.yaml:3: bodies.box.mass: '0' is out of range; allowed: > 0 kg"},
        Case{"EmptyModel", head + "model: ''\n",
             "s.yaml:3: model is empty; allowed: the path of an MJCF file, from the scene's own folder"},
        Case{"ModelAsMap", head + "model: {}\n",
             "s.yaml:3: model is a map; allowed: the path of an MJCF file, from the scene's own folder"},
        Case{"GravityWithoutBodies", head + "gravity: 9.81\n",
             "s.yaml:3: 'gravity' needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"ControlsWithoutBodies", head + "controls: {}\n",
             "s.yaml:3: 'controls' needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"SolverWithoutBodies", head + "field_solver: implicit\n",
             "s.yaml:3: 'field_solver' needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"HoldWithoutBodies", head + "hold: {}\n",
             "s.yaml:3: 'hold' needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"HoldWithoutBody", with_bodies("{box: {shape: box}}") + "hold: {against: pad}\n",
             "s.yaml:4: no key 'body' in hold; allowed: the name of a body"},
        Case{"HoldKey", with_bodies("{box: {shape: box}}") + "hold: {body: box, against: pad, until: 1 s}\n",
             "s.yaml:4: unknown key 'until' in hold; allowed: against, body, from, within"},
        Case{"HoldAfterTheEnd", with_bodies("{box: {shape: box}}") + "hold: {body: box, against: pad, from: 100 s}\n",
             "s.yaml:4: hold.from: 100 s is the trial's end or later; allowed: less than 4 s"},
        Case{"HoldItself", with_bodies("{box: {shape: box}}") + "hold: {body: box,\n  against: box}\n",
             "s.yaml:5: hold.against: 'box' is the body itself; allowed: what holds it, a sensor or another body"},
        Case{"IntegratorWithoutBodies", head + "integrator: RK4\n",
             "s.yaml:3: 'integrator' needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"SolverExplicitWithoutBodies", head + "field_solver: explicit\n",
             "s.yaml:3: 'field_solver' needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"SiteWithoutBodies", "slipbench: 1\nsensors: {pad: {type: papillarray, site: tip}}\n",
             "s.yaml:2: 'site' in sensors.pad needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"TouchesWithoutBodies", "slipbench: 1\nsensors: {pad: {type: papillarray, touches: [box]}}\n",
             "s.yaml:2: 'touches' in sensors.pad needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"DampingWithoutBodies", "slipbench: 1\nsensors: {pad: {type: papillarray, damping: 1 ms}}\n",
             "s.yaml:2: 'damping' in sensors.pad needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{
            "Gravity", bodies_head + "gravity: 9.81 m/s\n",
            "s.yaml:5: gravity: unknown unit 'm/s' of an acceleration in '9.81 m/s'; did you mean 'm/s2'? allowed: m/s2, mm/s2, cm/s2"},
        Case{"NegativeGravity", bodies_head + "gravity: -1\n",
             "s.yaml:5: gravity: '-1' is out of range; allowed: >= 0 m/s2 and <= 1000 m/s2"},
        Case{"Solver", bodies_head + "field_solver: implicite\n",
             "s.yaml:5: field_solver: unknown value 'implicite'; did you mean 'implicit'? allowed: auto, explicit, implicit"},
        Case{"ImplicitArticulated", bodies_head + "fidelity: articulated\nfield_solver: implicit\n",
             "s.yaml:6: field_solver: 'implicit' is for pads as fields; with 'fidelity: articulated' leave it out"},
        Case{
            "Integrator", bodies_head + "integrator: RK5\n",
            "s.yaml:5: integrator: unknown value 'RK5'; did you mean 'RK4'? allowed: auto, Euler, implicit, implicitfast, discrete, RK4"},
        Case{"IntegratorOfPillars", bodies_head + "fidelity: articulated\nintegrator: Euler\n",
             "s.yaml:6: integrator: 'Euler' is for pads as fields; 'fidelity: articulated' has its own, discrete"},
        Case{"IntegratorOfContact", bodies_head + "fidelity: mujoco_contact\nintegrator: Euler\n",
             "s.yaml:6: integrator: 'Euler' is for pads as fields; allowed with 'fidelity: mujoco_contact': contact.integrator"},
        Case{"IntegratorOfImplicitFields", bodies_head + "field_solver: implicit\nintegrator: RK4\n",
             "s.yaml:6: integrator: 'RK4' does not solve implicit fields; allowed with them: discrete"},
        Case{"IntegratorAccepted", bodies_head + "integrator: RK4\n", "accepted"},
        Case{"SurfaceShapeWithBodies", bodies_head + "surface: {material: felt, shape: plane}\n",
             "s.yaml:5: unknown key 'shape' in surface of a scene with bodies; allowed: material"},
        Case{"NoTouches", with_sensor("{type: papillarray}"),
             "s.yaml:4: no key 'touches' in sensors.pad; allowed: names of geoms or bodies, such as [box]"},
        Case{"TouchesAsName", with_sensor("{type: papillarray, touches: box}"),
             "s.yaml:4: sensors.pad.touches is 'box'; allowed: names of geoms or bodies, such as [box]"},
        Case{"TouchesNothing", with_sensor("{type: papillarray, touches: []}"),
             "s.yaml:4: sensors.pad.touches is empty; allowed: names of geoms or bodies, such as [box]"},
        Case{"TouchesTwice", with_sensor("{type: papillarray, touches: [box, box]}"),
             "s.yaml:4: 'box' is named twice in sensors.pad.touches"},
        Case{"FollowsWithoutBodies",
             "slipbench: 1\nsensors: {pad: {type: papillarray}, skin: {type: papillarray, follows: pad}}\n",
             "s.yaml:2: 'follows' in sensors.skin needs bodies that move by forces: a scene with 'model' or 'bodies'"},
        Case{"FollowsNobody", bodies_head + "  skin: {type: papillarray, follows: pat}\n",
             "s.yaml:5: sensors.skin.follows: no pad 'pat'; did you mean 'pad'? allowed: pad"},
        Case{"FollowsAFollower",
             bodies_head + "  skin: {type: papillarray, follows: nib}\n  nib: {type: papillarray, follows: pad}\n",
             "s.yaml:5: sensors.skin.follows: no pad 'nib'; allowed: pad"},
        Case{"FollowerThatTouches", bodies_head + "  skin: {type: papillarray, follows: pad, touches: [box]}\n",
             "s.yaml:5: 'touches' in sensors.skin is that of the pad that it follows; leave it out"},
        Case{
            "FollowsPillars", bodies_head + "  skin: {type: papillarray, follows: pad}\nfidelity: articulated\n",
            "s.yaml:5: 'follows' in sensors.skin: an articulated pad has no field to be read beside it; allowed with 'fidelity: field'"},
        Case{"Damping", with_sensor("{type: papillarray, touches: [box], damping: -1 ms}"),
             "s.yaml:4: sensors.pad.damping: '-1 ms' is out of range; allowed: >= 0 s"},
        Case{"MotionThatMovesNothing",
             with_sensor("{type: papillarray, touches: [box], site: tip}") + "motion: {speed: 1 mm/s}\n",
             "s.yaml:5: motion moves the sensors that have no 'site', and every sensor of this scene has one; leave it out"},
        Case{"ControlsAsSequence", bodies_head + "controls: [1]\n",
             "s.yaml:5: controls is a sequence; allowed: a map of actuators of the model, such as 'grip: 4 N'"},
        Case{
            "ControlUnit", bodies_head + "controls: {grip: 4 Nn}\n",
            "s.yaml:5: controls.grip: unknown unit 'Nn' in '4 Nn'; did you mean 'N'? allowed: %, m, mm, um, cm, nm, s, ms, us, min, m/s, mm/s, cm/s, um/s, m/s2, mm/s2, cm/s2, rad, deg, rad/s, deg/s, rad/s2, deg/s2, Hz, kHz, MHz, N, mN, kN, kg, g, N/m, N/mm, kN/m, N s/m"},
        Case{"ControlAsMap", bodies_head + "controls: {grip: {}}\n",
             "s.yaml:5: controls.grip is a map; allowed: a number such as 4 N, or points such as [[0 s, 0 N], [1 s, 4 N]]"},
        Case{"ControlPoint", bodies_head + "controls: {grip: [[0 s, 1 N], 2 N]}\n",
             "s.yaml:5: controls.grip.1 is '2 N'; allowed: a time and a value, such as [1 s, 4 N]"},
        Case{"ControlTimes", bodies_head + "controls: {grip: [[1 s, 1 N], [1 s, 2 N]]}\n",
             "s.yaml:5: controls.grip.1: the times do not ascend; allowed: later than 1 s"},
        Case{"EndlessControl", bodies_head + "controls: {grip: inf}\n",
             "s.yaml:5: controls.grip: 'inf' is infinite; allowed: a finite number"}),
    case_name);

INSTANTIATE_TEST_SUITE_P(
    Parts, Refusal,
    testing::Values(
        Case{"Material", head + "surface: {material: acryl}\n",
             "s.yaml:3: unknown material 'acryl'; did you mean 'acrylic'? allowed: " + materials},
        Case{"Shape", head + "surface:\n  shape: plan\n",
             "s.yaml:4: unknown surface shape 'plan'; did you mean 'plane'? allowed: cylinder, plane"},
        Case{"ShapeParameterOfAnotherShape", head + "surface: {radius: 1 m}\n",
             "s.yaml:3: unknown key 'radius' in surface; allowed: material, shape"},
        Case{"SurfaceAsName", head + "surface: ptfe\n", "s.yaml:3: surface is 'ptfe'; allowed: a map of 'shape' and parameters"},
        Case{"FrictionKey", head + "friction: {mu: 1}\n",
             "s.yaml:3: unknown key 'mu' in friction; allowed: kinetic, scale, static"},
        Case{"NegativeFriction", head + "friction: {static: -0.1}\n",
             "s.yaml:3: friction.static: '-0.1' is out of range; allowed: >= 0 and <= 100"},
        Case{"HugeFriction", head + "friction: {static: 101}\n",
             "s.yaml:3: friction.static: '101' is out of range; allowed: >= 0 and <= 100"},
        Case{"KineticAboveStatic", head + "friction:\n  static: 0.5\n  kinetic: 0.6\n",
             "s.yaml:5: friction.kinetic 0.6 exceeds the static coefficient 0.5; allowed: at most that"},
        Case{"KineticAboveTheMaterials", head + "friction: {kinetic: 0.6}\n",
             "s.yaml:3: friction.kinetic 0.6 exceeds the static coefficient 0.5 of acrylic; allowed: at most that"},
        Case{"NoScale", head + "friction: {scale: 0}\n",
             "s.yaml:3: friction.scale: '0' is out of range; allowed: > 0 and <= 100"},
        Case{"HugeScale", head + "friction: {scale: 1e300}\n",
             "s.yaml:3: friction.scale: '1e300' is out of range; allowed: > 0 and <= 100"},
        Case{"Motion", head + "motion: {kind: satge}\n",
             "s.yaml:3: unknown motion 'satge'; did you mean 'stage'? allowed: stage"},
        Case{"InfiniteSpeed", head + "motion: {speed: inf}\n",
             "s.yaml:3: motion.speed: 'inf' is infinite; allowed: a finite number"},
        Case{
            "SpeedNaN", head + "motion: {speed: .nan}\n",
            "s.yaml:3: motion.speed: '.nan' is not a speed; allowed: a number in m/s, or one with a unit: m/s, mm/s, cm/s, um/s"},
        Case{"VectorAsNumber", head + "motion: {pivot: 1 mm}\n",
             "s.yaml:3: motion.pivot is '1 mm'; allowed: a sequence of 2 such as [0 mm, 0 mm]"},
        Case{"VectorTooLong", head + "motion: {pivot: [1, 2, 3]}\n",
             "s.yaml:3: motion.pivot has 3 entries; allowed: a sequence of 2 such as [0 mm, 0 mm]"},
        Case{"VectorEntry", head + "motion:\n  tilt:\n    - 1 deg\n    - 90 deg\n",
             "s.yaml:6: motion.tilt.1: '90 deg' is out of range; allowed: >= -0.5 rad and <= 0.5 rad"},
        Case{"NoSensors", "slipbench: 1\nseed: 2\n",
             "s.yaml:1: no key 'sensors'; allowed: a map of at least one sensor, such as 'pad: {type: papillarray}'"},
        Case{"EmptySensors", "slipbench: 1\nsensors: {}\n",
             "s.yaml:2: sensors is empty; allowed: a map of at least one sensor, such as 'pad: {type: papillarray}'"},
        Case{"SensorName", "slipbench: 1\nsensors: {2nd pad: {type: papillarray}}\n",
             "s.yaml:2: '2nd pad' cannot name a sensor; allowed: letters, digits and '_', no digit first"},
        Case{"SensorWithoutType", "slipbench: 1\nsensors:\n  pad: {rate: 1 kHz}\n",
             "s.yaml:3: no key 'type' in sensors.pad; allowed: papillarray"},
        Case{"SensorType", "slipbench: 1\nsensors: {pad: {type: papilarray}}\n",
             "s.yaml:2: unknown sensor 'papilarray'; did you mean 'papillarray'? allowed: papillarray"},
        Case{"SensorKey", "slipbench: 1\nsensors: {pad: {type: papillarray, bristle: 6}}\n",
             "s.yaml:2: unknown key 'bristle' in sensors.pad; did you mean 'bristles'? allowed: " + sensor_keys},
        Case{"SensorChoice", "slipbench: 1\nsensors: {pad: {type: papillarray, profile: grip}}\n",
             "s.yaml:2: sensors.pad.profile: unknown value 'grip'; allowed: gripper, hexapod"},
        Case{"SensorInteger", "slipbench: 1\nsensors: {pad: {type: papillarray, bristles: 2.5}}\n",
             "s.yaml:2: sensors.pad.bristles: '2.5' is not a whole number; allowed: digits, with a leading '-' if negative"},
        Case{"SensorFlag", "slipbench: 1\nsensors: {pad: {type: papillarray, bias: on}}\n",
             "s.yaml:2: sensors.pad.bias: 'on' is not a flag; allowed: true, false"},
        Case{
            "ElectronicsWord", "slipbench: 1\nsensors: {pad: {type: papillarray, electronics: idea}}\n",
            "s.yaml:2: sensors.pad.electronics: unknown value 'idea'; did you mean 'ideal'? allowed: ideal, typical, or a sequence of parts"},
        Case{"ElectronicsPart", "slipbench: 1\nsensors: {pad: {type: papillarray, electronics: [nose]}}\n",
             "s.yaml:2: unknown part of the electronics 'nose'; did you mean 'noise'? allowed: drift, noise"},
        Case{"EffectsAsName", head + "effects: ageing\n",
             "s.yaml:3: effects is 'ageing'; allowed: a sequence of names or of {name: {parameters}}"},
        Case{"Effect", head + "effects: [agein]\n",
             "s.yaml:3: unknown effect 'agein'; did you mean 'ageing'? allowed: ageing, stribeck"},
        Case{"EffectTwice", head + "effects:\n  - ageing\n  - ageing: {rate: 1}\n",
             "s.yaml:5: effect 'ageing' is named twice in effects"},
        Case{"EffectOfTwoKeys", head + "effects: [{ageing: {}, stribeck: {}}]\n",
             "s.yaml:3: effects.0 is a map of 2 keys; allowed: a name, or one {name: {parameters}}"},
        Case{"EffectParameter", head + "effects: [{ageing: {rte: 1}}]\n",
             "s.yaml:3: unknown key 'rte' in ageing; did you mean 'rate'? allowed: rate"},
        Case{"EffectParametersAsNumber", head + "effects: [{ageing: 3}]\n",
             "s.yaml:3: effects.ageing is '3'; allowed: a map of parameters"}),
    case_name);

std::string paths_of(int count) {
  std::string text = "{";
  for (int i = 0; i < count; ++i) text += "motion.p" + std::to_string(i) + ": [1], ";
  return text + "}";
}

// What follows "sweep: " in line 3.
std::string sweep(const std::string& text) { return head + "sweep: " + text + "\n"; }

std::string four_axes_of_32() {
  std::string values = "[0";
  for (int i = 1; i < 32; ++i) values += "," + std::to_string(i);
  values += "]";
  return "{motion.speed: " + values + ", motion.gap: " + values + ", motion.rotation: " + values +
         ", motion.direction: " + values + "}";
}

INSTANTIATE_TEST_SUITE_P(
    Sweep, Refusal,
    testing::Values(
        Case{"SweepAsSequence", sweep("[1]"),
             "s.yaml:3: sweep is a sequence; allowed: a map of paths, such as 'motion.speed: [1 mm/s, 4 mm/s]'"},
        Case{"TooManyPaths", sweep(paths_of(1001)), "s.yaml:3: sweep has 1001 entries; allowed: at most 1000"},
        Case{"AxisAsNumber", sweep("{motion.speed: 1}"),
             "s.yaml:3: sweep.motion.speed is '1'; allowed: a sequence of values, or {draw: ...}"},
        Case{"EmptyAxis", sweep("{motion.speed: []}"),
             "s.yaml:3: sweep.motion.speed is empty; allowed: a sequence of at least one value"},
        Case{
            "SweptPath", sweep("{motion.sped: [1]}"),
            "s.yaml:3: unknown key 'sped' in motion; did you mean 'speed'? allowed: acceleration, angular_acceleration, approach_speed, compression, direction, gap, kind, pivot, retract, reverse, rotation, speed, start, stop, tilt"},
        Case{"SweptPathSyntax", sweep("{motion.: [1]}"),
             "s.yaml:3: 'motion.' is not a path; allowed: keys joined by dots, such as 'motion.speed' or 'motion.tilt.0'"},
        Case{"SweptScenesSeed", sweep("{scene: [{seed: 1}]}"),
             "s.yaml:3: 'seed' cannot be swept; allowed: any other key of the scene"},
        Case{
            "SweptSceneAlone", sweep("{scene: 1}"),
            "s.yaml:3: sweep.scene is '1'; allowed: a sequence of maps of the scene's keys, or {draw: choice, values: ...} of such"},
        Case{"SweptSceneOfNumbers", sweep("{scene: [1, 2]}"), "s.yaml:3: sweep.scene has '1'; allowed: maps of the scene's keys"},
        Case{"SweptSceneTwice", sweep("{motion.speed: [1, 2], scene: [{motion: {speed: 1}}]}"),
             "s.yaml:3: sweep.scene sets what sweep.motion.speed sets, too; allowed: each value once"},
        Case{"SweptSeed", sweep("{seed: [1, 2]}"), "s.yaml:3: 'seed' cannot be swept; allowed: any other key of the scene"},
        Case{"SweptItemOfNothing", sweep("{motion.tilt.0: [1]}"),
             "s.yaml:3: no item '0' in 'motion.tilt', which the scene does not give"},
        Case{"SplitKey", head + "split: {by: material, share: [1, 0, 0]}\n",
             "s.yaml:3: unknown key 'share' in split; did you mean 'shares'? allowed: by, shares"},
        Case{"SplitBy", head + "split: {by: colour}\n",
             "s.yaml:3: split.by: unknown value 'colour'; allowed: material, object, speed, trial"},
        Case{
            "SplitShares", head + "split: {shares: [0.7, 0.2, 0.2]}\n",
            "s.yaml:3: split.shares: 0.7, 0.2, 0.2; allowed: shares of train, valid and test that are 1 in all, some of it for train"},
        Case{"SplitSwept", sweep("{split: [{by: trial}]}"),
             "s.yaml:3: 'split' cannot be swept; allowed: any other key of the scene"},
        Case{"SweptTwice", sweep("{motion: [{speed: 1}, {gap: 2}], motion.speed: [1]}"),
             "s.yaml:3: sweep.motion.speed sets what sweep.motion sets, too; allowed: each value once"},
        Case{"SweptBelow", sweep("{motion.tilt: [[0, 0]], motion.tilt.0: [1]}"),
             "s.yaml:3: sweep.motion.tilt.0 sets what sweep.motion.tilt sets, too; allowed: each value once"},
        Case{"AxisValue", sweep("\n  motion.speed:\n    - 1 mm/s\n    - 2 mm"),
             "s.yaml:6: motion.speed: unknown unit 'mm' of a speed in '2 mm'; allowed: m/s, mm/s, cm/s, um/s"},
        Case{"Trials", sweep("{trials: 0}"), "s.yaml:3: sweep.trials is '0'; allowed: 1 to 1000000"},
        Case{"TrialsAsMap", sweep("{trials: {}}"), "s.yaml:3: sweep.trials is a map; allowed: 1 to 1000000"},
        Case{"TooManyTrials", sweep("{motion.speed: [1, 2], trials: 500001}"),
             "s.yaml: 2 grid cells of 500001 trials each; allowed: at most 1,000,000 trials"},
        Case{"TooManyCells", sweep(four_axes_of_32()),
             "s.yaml:3: the sweep has more than 1,000,000 grid cells; allowed: at most that"},
        Case{"DrawWithoutKind", sweep("{motion.speed: {min: 1, max: 2}}"),
             "s.yaml:3: no key 'draw' in sweep.motion.speed; allowed: choice, log_uniform, lognormal, normal, uniform"},
        Case{
            "DrawKind", sweep("{motion.speed: {draw: unifrom, min: 1, max: 2}}"),
            "s.yaml:3: unknown draw 'unifrom'; did you mean 'uniform'? allowed: choice, log_uniform, lognormal, normal, uniform"},
        Case{"DrawKey", sweep("{motion.speed: {draw: uniform, min: 1, max: 2, mean: 1}}"),
             "s.yaml:3: unknown key 'mean' in sweep.motion.speed; did you mean 'max'? allowed: draw, max, min"},
        Case{"DrawWithoutBound", sweep("{motion.speed: {draw: uniform, min: 1}}"),
             "s.yaml:3: no key 'max' in sweep.motion.speed; a draw 'uniform' needs it"},
        Case{"DrawBounds", sweep("{motion.speed: {draw: uniform, min: 2, max: 1}}"),
             "s.yaml:3: sweep.motion.speed.max: '1' is out of range; allowed: more than min"},
        Case{"DrawTooWide", sweep("{motion.speed: {draw: uniform, min: -1e308, max: 1e308}}"),
             "s.yaml:3: sweep.motion.speed.max: '1e308' is out of range; allowed: an interval within a double's range"},
        Case{"DrawInfinite", sweep("{motion.speed: {draw: uniform, min: 1, max: inf}}"),
             "s.yaml:3: sweep.motion.speed.max: 'inf' is infinite; allowed: a finite number"},
        Case{"DrawNotANumber", sweep("{motion.speed: {draw: uniform, min: 1, max: fast}}"),
             "s.yaml:3: sweep.motion.speed.max: 'fast' is not a number; allowed: a number, or one with a unit: %"},
        Case{"DrawNumberAsMap", sweep("{motion.speed: {draw: uniform, min: 1, max: {}}}"),
             "s.yaml:3: sweep.motion.speed.max is a map; allowed: a number"},
        Case{"DrawOfTwoQuantities", sweep("{motion.speed: {draw: uniform, min: 1 mm/s, max: 2 mm}}"),
             "s.yaml:3: sweep.motion.speed.max: '2 mm' does not fit the other numbers; allowed: a number in m/s"},
        Case{"DrawOfAnotherQuantity", sweep("{motion.speed: {draw: uniform, min: 1 N, max: 1.0000000000000002 N}}"),
             "s.yaml:3 (drawn): motion.speed: unknown unit 'N' of a speed in '1 N'; allowed: m/s, mm/s, cm/s, um/s"},
        Case{"NegativeDeviation", sweep("{motion.speed: {draw: normal, mean: 1, sd: -1}}"),
             "s.yaml:3: sweep.motion.speed.sd: '-1' is out of range; allowed: >= 0"},
        Case{"LognormalMedian", sweep("{motion.speed: {draw: lognormal, median: 0, sd: 1}}"),
             "s.yaml:3: sweep.motion.speed.median: '0' is out of range; allowed: > 0"},
        Case{"LognormalDeviation", sweep("{motion.speed: {draw: lognormal, median: 1 m/s, sd: 1 m/s}}"),
             "s.yaml:3: sweep.motion.speed.sd: unknown unit 'm/s' of a number in '1 m/s'; allowed: %"},
        Case{"LogUniformFromZero", sweep("{motion.speed: {draw: log_uniform, min: 0, max: 1}}"),
             "s.yaml:3: sweep.motion.speed.min: '0' is out of range; allowed: > 0"},
        Case{"UnreachableBounds", sweep("{motion.speed: {draw: normal, mean: 0, sd: 1 mm/s, min: 1 m/s}}"),
             "s.yaml:3 (drawn): no draw within [1 m/s, inf] in 1000 tries; allowed: bounds nearer to the mean"},
        Case{"ChoiceValue", sweep("{motion.speed: {draw: choice, values: [2 mm]}}"),
             "s.yaml:3 (drawn): motion.speed: unknown unit 'mm' of a speed in '2 mm'; allowed: m/s, mm/s, cm/s, um/s"},
        Case{"EmptyChoice", sweep("{motion.speed: {draw: choice, values: []}}"),
             "s.yaml:3: sweep.motion.speed.values is empty; allowed: a sequence of at least one value"}),
    case_name);

TEST(Refusal, OfAFileThatCannotBeReadSaysWhy) {
  const auto load = [](const std::string& path) -> std::string {
    try {
      static_cast<void>(SceneFile::load(path));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
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

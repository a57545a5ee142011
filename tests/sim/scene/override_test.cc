// Values given on the command line.

#include <map>
#include <vector>

#include "sim/scene/entry_reader.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene_reader.h"
#include "tests/expect.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench {
namespace {

constexpr const char* base = R"(slipbench: 1
motion: {speed: 1 mm/s, tilt: [0 deg, 1 deg]}
sensors: {pad: {type: papillarray}}
effects: [{ageing: {rate: 0.1}}]
)";

SceneFile with(const std::vector<Override>& changes, const std::string& text = base) {
  SceneFile file = SceneFile::from_text(text, "s.yaml");
  for (const Override& change : changes) file.apply(change);
  return file;
}

Scene read(const std::vector<Override>& changes) {
  const Catalogues catalogues = test_catalogues();
  return parse_scene(with(changes), catalogues);
}

std::string refusal(const std::vector<Override>& changes, const std::string& text = base) {
  const Catalogues catalogues = test_catalogues();
  return refusal_of([&] { parse_scene(with(changes, text), catalogues); });
}

TEST(Override, ALongValueIsNotSaidAsAWhole) {
  const std::string message = refusal({{"motion.speed", std::string(100'000, 'x')}});
  EXPECT_LT(message.size(), 1000U);
  EXPECT_EQ(message.substr(0, 24), "--set motion.speed=xxxxx");
}

TEST(Override, ReplacesAValue) {
  EXPECT_EQ(read({{"motion.speed", "8 mm/s"}}).motion.parameters.number("speed"), 0.008);
  EXPECT_EQ(read({{"motion.tilt.0", "0.2"}}).motion.parameters.vector("tilt")[0], 0.2);
  EXPECT_EQ(read({{"effects.0.ageing.rate", "0.2"}}).effects[0].parameters.number("rate"), 0.2);
  EXPECT_EQ(read({{"effects", "[stribeck]"}}).effects[0].name, "stribeck");
  EXPECT_TRUE(read({{"effects", "[]"}}).effects.empty());
  EXPECT_EQ(read({{"motion", "{start: 1 s}"}}).motion.parameters.number("speed"), 0.004) << "a map is replaced, not merged";
}

// Values inside an entry of the sweep: in an axis of maps, and in a draw whose name may begin like
// the axis. A value in no entry becomes an entry of its own.
TEST(Override, ReachesIntoTheSweep) {
  const Catalogues catalogues = test_catalogues();
  const std::string text = std::string(base) +
                           "sweep:\n  motion: [{speed: 2 mm/s}, {speed: 3 mm/s}]\n"
                           "  motion.tilt.0: {draw: normal, mean: 0 deg, sd: 0}\n";
  const TrialPlan plan(with({{"sweep.motion.1.speed", "9 mm/s"}, {"sweep.motion.tilt.0.mean", "0.5"}}, text), catalogues, 0, 1);
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan.trial(0).scene.motion.parameters.number("speed"), 0.002);
  EXPECT_EQ(plan.trial(1).scene.motion.parameters.number("speed"), 0.009);
  EXPECT_EQ(plan.trial(1).scene.motion.parameters.vector("tilt")[0], 0.5);
  EXPECT_EQ(TrialPlan(with({{"sweep.time_step", "[1 ms, 2 ms]"}}, text), catalogues, 0, 1).size(), 4U);
}

// A comparison of settings writes these values before its own, for any scene: nothing else in the
// scene may affect it.
TEST(Override, TakesKeysBackInEveryScene) {
  const Catalogues catalogues = test_catalogues();
  const auto trace_of = [&](const std::string& text, const std::vector<Override>& changes) {
    Trace trace;
    read_scene(with(changes, text).root(), catalogues, &trace);
    std::map<std::string, std::string> values;  // in any notation
    for (const auto& [path, read] : trace) values[path] = read.json;
    return values;
  };
  const std::string head = "slipbench: 1\n", bodies = head + "bodies: {box: {shape: box}}\n";
  const std::string prescribed = head + "sensors: {pad: {type: papillarray}}\n";
  const std::string pad = bodies + "sensors: {pad: {type: papillarray, touches: [box]}}\n";
  const std::vector<Override> back{{"contact", "none"}, {"integrator", "auto"}, {"field_solver", "auto"}};
  for (const std::string& scene : {prescribed, pad}) {
    for (const std::string fidelity : {"field", "articulated", "mujoco_contact"}) {
      const std::string plain = scene + "fidelity: " + fidelity + "\n";
      EXPECT_EQ(trace_of(plain, back), trace_of(plain, {})) << plain;
    }
    const std::string contact = scene + "fidelity: mujoco_contact\ncontact: {noslip: 3}\n";
    std::vector<Override> to_field = back;
    to_field.push_back({"fidelity", "field"});
    EXPECT_EQ(trace_of(contact, to_field), trace_of(scene, {})) << contact;
    EXPECT_NE(trace_of(contact, {}), trace_of(contact, back)) << "the defaults again";
  }
  EXPECT_EQ(trace_of(pad + "integrator: RK4\n", back), trace_of(pad, {}));
  EXPECT_EQ(trace_of(pad + "field_solver: implicit\n", back), trace_of(pad, {}));
}

TEST(Override, AddsAValueAndTheMapsOnTheWay) {
  EXPECT_EQ(read({{"friction.static", "0.3"}}).friction.static_coefficient, 0.3);
  EXPECT_EQ(read({{"seed", "9"}}).seed, 9u);
  EXPECT_EQ(read({{"sensors.second", "{type: papillarray}"}}).sensors.size(), 2u);
}

TEST(Override, TheLastOneWins) {
  EXPECT_EQ(read({{"seed", "1"}, {"seed", "2"}}).seed, 2u);
  EXPECT_EQ(read({{"motion.speed", "1"}, {"motion", "{speed: 2}"}}).motion.parameters.number("speed"), 2.0);
}

TEST(Override, GivesAParameterToAnEffectThatIsNamedAlone) {
  const Scene scene = read({{"effects", "[stribeck, ageing]"}, {"effects.1.ageing.rate", "0.3"}});
  EXPECT_EQ(scene.effects.at(1).parameters.number("rate"), 0.3);
  EXPECT_THAT(refusal({{"effects", "[stribeck]"}, {"effects.0.ageing.rate", "0.3"}}),
              refused_at("--set effects.0.ageing.rate=0.3", {"ageing", "effects.0", "stribeck"}));
}

TEST(Override, IsNamedInMessages) {
  EXPECT_THAT(refusal({{"motion.speed", "8 N"}}), refused_at("--set motion.speed=8 N", {"motion.speed", "8 N", "speed"}));
  EXPECT_THAT(refusal({{"motion.sped", "8"}}), refused_at("--set motion.sped=8", {"sped", "motion", "speed"}));
  EXPECT_THAT(refusal({{"effects", "[ageing"}}), refused_at("--set effects=[ageing", {"brackets"}));
  EXPECT_THAT(refusal({{"seed", ""}}), refused_at("--set seed=", {"empty"}));
}

TEST(Override, RefusesPathsThatCannotExist) {
  EXPECT_THAT(refusal({{"motion.speed.x", "1"}}), refused_at("--set motion.speed.x=1", {"x", "motion.speed", "1 mm/s"}));
  EXPECT_THAT(refusal({{"motion.tilt.2", "1"}}), refused_at("--set motion.tilt.2=1", {"2", "motion.tilt", "0", "1"}));
  EXPECT_THAT(refusal({{"effects.1", "ageing"}}), refused_at("--set effects.1=ageing", {"1", "effects", "0"}));
  EXPECT_THAT(refusal({{"effects.first", "ageing"}}), refused_at("--set effects.first=ageing", {"first", "effects", "0"}));
  EXPECT_THAT(refusal({{"motion.tilt.99999999999999999999", "1"}}),
              refused_at("--set motion.tilt.99999999999999999999=1", {"99999999999999999999", "motion.tilt", "0", "1"}));
  EXPECT_THAT(refusal({{"motion.pivot.0", "1"}}), refused_at("--set motion.pivot.0=1", {"0", "motion.pivot"}));
  EXPECT_THAT(refusal({{"motion..speed", "1"}}), refused_at("--set motion..speed=1", {"motion..speed", "path"}));
  EXPECT_THAT(refusal({{"", "1"}}), refused_at("--set =1", {"''", "path"}));
}

TEST(Override, RemovesAKeyByNull) {
  const double speed = 0.004;  // the default
  for (const std::string null : {"null", "~"}) {
    EXPECT_EQ(read({{"motion.speed", null}}).motion.parameters.number("speed"), speed);
    EXPECT_EQ(read({{"motion", null}}).motion.parameters.number("speed"), speed);
  }
  EXPECT_TRUE(read({{"effects", "null"}}).effects.empty());
  EXPECT_EQ(read({{"seed", "3"}, {"seed", "null"}}).seed, read({}).seed) << "a value of the command line";
  EXPECT_EQ(read({{"effects.0.ageing.rate", "null"}}).effects[0].parameters.number("rate"),
            read({{"effects", "[ageing]"}}).effects[0].parameters.number("rate"));
  EXPECT_EQ(read({{"description", "'null'"}}).description, "null") << "a quoted word is a text";
}

TEST(Override, RefusesToRemoveWhatIsNotThere) {
  EXPECT_THAT(refusal({{"motion.sped", "null"}}), refused_at("--set motion.sped=null", {"sped", "motion", "speed", "tilt"}));
  EXPECT_THAT(refusal({{"motoin.speed", "null"}}), refused_at("--set motoin.speed=null", {"motoin", "the scene", "motion"}));
  EXPECT_THAT(refusal({{"motion.speed.x", "null"}}), refused_at("--set motion.speed.x=null", {"x", "motion.speed", "1 mm/s"}));
  EXPECT_THAT(refusal({{"effects.0", "null"}}), refused_at("--set effects.0=null", {"effects", "effects=[...]"}));
  EXPECT_THAT(refusal({{"effects.1.ageing", "null"}}), refused_at("--set effects.1.ageing=null", {"1", "effects", "0"}));
  EXPECT_THAT(refusal({{"sweep", "null"}}), refused_at("--set sweep=null", {"sweep", "the scene"}));
}

constexpr const char* swept = R"(slipbench: 1
motion: {tilt: [0 deg, 0 deg]}
sensors: {pad: {type: papillarray}}
sweep:
  motion: [{speed: 1 mm/s, rotation: 1 deg/s}, {speed: 2 mm/s}]
  motion.compression: [1 mm, 2 mm, 3 mm]
  motion.tilt: [[0, 0], [0.1, 0.1]]
)";

TrialPlan plan(const Catalogues& catalogues, const std::vector<Override>& changes) {
  return {with(changes, swept), catalogues, 0, 0};
}

TEST(Override, TakesItsPathOutOfTheSweep) {
  const Catalogues catalogues = test_catalogues();
  EXPECT_EQ(plan(catalogues, {}).size(), 12u);
  const TrialPlan fixed = plan(catalogues, {{"motion.compression", "0.5 mm"}});
  EXPECT_EQ(fixed.size(), 4u);
  for (std::size_t i = 0; i < fixed.size(); ++i) EXPECT_EQ(fixed.trial(i).scene.motion.parameters.number("compression"), 0.0005);
  // The whole map is fixed: every axis below it is removed.
  EXPECT_EQ(plan(catalogues, {{"motion", "{speed: 3 mm/s}"}}).size(), 1u);
}

TEST(Override, TakesItsKeyOutOfAnAxisOfMaps) {
  const Catalogues catalogues = test_catalogues();
  const TrialPlan fixed = plan(catalogues, {{"motion.speed", "9 mm/s"}});
  ASSERT_EQ(fixed.size(), 12u);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    const TrialPlan::Trial trial = fixed.trial(i);
    EXPECT_EQ(trial.scene.motion.parameters.number("speed"), 0.009);
    for (const auto& [path, value] : trial.drawn) EXPECT_NE(path, "motion.speed");
  }
  EXPECT_THAT(refusal({{"motion.tilt.0", "0.2"}}, swept), refused_at("s.yaml:7", {"sweep.motion.tilt", "--set motion.tilt"}));
}

TEST(Override, ChangesTheSweepItself) {
  const Catalogues catalogues = test_catalogues();
  EXPECT_EQ(plan(catalogues, {{"sweep.motion.compression", "[1 mm]"}}).size(), 4u);
  EXPECT_EQ(plan(catalogues, {{"sweep.trials", "3"}}).size(), 36u);
  EXPECT_EQ(plan(catalogues, {{"sweep", "{}"}}).size(), 1u);
}

TEST(Override, RemovesAKeyFromTheSweepByNull) {
  const Catalogues catalogues = test_catalogues();
  EXPECT_EQ(plan(catalogues, {{"sweep.motion.compression", "null"}}).size(), 4u);
  EXPECT_EQ(plan(catalogues, {{"sweep", "null"}}).size(), 1u);
  EXPECT_EQ(plan(catalogues, {{"motion.compression", "null"}}).size(), 4u) << "swept, and not in the scene";
  const TrialPlan still = plan(catalogues, {{"motion.speed", "null"}});  // in the maps of an axis
  ASSERT_EQ(still.size(), 12u);
  EXPECT_EQ(still.trial(11).scene.motion.parameters.number("speed"), 0.004);
  EXPECT_THAT(refusal({{"sweep.motion.compresion", "null"}}, swept),
              refused_at("--set sweep.motion.compresion=null", {"motion.compresion", "motion.compression"}));
}

// Values given on the command line are never dropped: a sweep below a fixed value applies to the
// value, in either order. A value can be given only once.
TEST(Override, KeepsASweepThatWasTyped) {
  const Catalogues catalogues = test_catalogues();
  const Override whole{"motion", "{start: 1 s}"};
  const Override fixed{"motion.speed", "9 mm/s"};
  for (const Override& typed :
       {Override{"sweep", "{motion.speed: [1 mm/s, 2 mm/s]}"}, Override{"sweep.motion.speed", "[1 mm/s, 2 mm/s]"}}) {
    EXPECT_EQ(TrialPlan(with({whole, typed}), catalogues, 0, 0).size(), 2u);
    EXPECT_EQ(TrialPlan(with({typed, whole}), catalogues, 0, 0).size(), 2u);
    const auto refused = refused_at("--set " + typed.path + "=" + typed.value, {"sweep.motion.speed", "fixes"});
    EXPECT_THAT(refusal({fixed, typed}), refused);
    EXPECT_THAT(refusal({typed, fixed}), refused);
  }
  EXPECT_THAT(refusal({fixed, {"sweep", "{motion: [{speed: 1 mm/s}, {speed: 2 mm/s}]}"}}),
              refused_at("--set sweep={motion: [{speed: 1 mm/s}, {speed: 2 mm/s}]}", {"sweep.motion", "fixes"}));
  EXPECT_THAT(refusal({{"sweep.motion.speed.max", "2 mm/s"}, fixed},
                      std::string(base) + "sweep: {motion.speed: {draw: uniform, min: 0, max: 1 mm/s}}"),
              refused_at("s.yaml:5 (drawn)", {"sweep.motion.speed", "fixes"}));
}

}  // namespace
}  // namespace slipbench

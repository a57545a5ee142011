// Values of valid scenes.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

#include "sim/scene/materials.h"
#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench {
namespace {

const std::string minimal = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n";

Scene read(const std::string& text) {
  const Catalogues catalogues = test_catalogues();
  return parse_scene(SceneFile::from_text(text, "s.yaml"), catalogues);
}

TEST(Scene, HasDefaultsForAllButItsSensors) {
  const Scene scene = read(minimal);
  EXPECT_EQ(scene.description, "");
  EXPECT_EQ(scene.duration, 4.0);
  EXPECT_FALSE(scene.time_step.has_value());
  EXPECT_EQ(scene.fidelity, "field");
  EXPECT_EQ(scene.seed, 0u);
  EXPECT_EQ(scene.material, "acrylic");
  EXPECT_EQ(scene.surface.name, "plane");
  EXPECT_EQ(scene.friction.static_coefficient, 0.5);
  EXPECT_EQ(scene.motion.name, "stage");
  EXPECT_EQ(scene.motion.parameters.number("compression"), 0.001);
  EXPECT_EQ(scene.motion.parameters.vector("pivot"), (std::vector{0.0, 0.0}));
  EXPECT_EQ(scene.motion.parameters.number("stop"), std::numeric_limits<double>::infinity());
  ASSERT_EQ(scene.sensors.size(), 1u);
  EXPECT_EQ(scene.sensors[0].name, "pad");
  EXPECT_EQ(scene.sensors[0].type, "papillarray");
  EXPECT_EQ(scene.sensors[0].parameters.number("rate"), 1000.0);
  EXPECT_TRUE(scene.sensors[0].electronics.empty());
  EXPECT_TRUE(scene.effects.empty());
  EXPECT_TRUE(scene.expect.expectations.empty());
}

TEST(Scene, DetectorReadsItsSensor) {
  EXPECT_FALSE(read(minimal).detector.has_value());
  EXPECT_FALSE(read(minimal + "detector: {type: none}\n").detector.has_value());
  const Scene one = read(minimal + "detector: {type: ratio}\n");
  EXPECT_EQ(one.detector->type, "ratio");
  EXPECT_EQ(one.detector->sensor, 0u);
  EXPECT_EQ(one.detector->parameters.number("threshold"), 0.4);
  const Scene two = read(
      "slipbench: 1\nsensors: {a: {type: papillarray}, b: {type: papillarray}}\ndetector: {type: ratio, sensor: b, threshold: 0.3}\n");
  EXPECT_EQ(two.detector->sensor, 1u);
  EXPECT_EQ(two.detector->parameters.number("threshold"), 0.3);
}

// A path in the scene is relative to the scene's folder, one of --set to the current folder; the
// default is a name, not a path, and stays unchanged.
TEST(Scene, PathsAreFromTheFolderOfWhatNamesThem) {
  const Catalogues catalogues = test_catalogues();
  const auto memories = [&](const std::string& value, const std::string& folder, const std::string& set) {
    SceneFile file = SceneFile::from_text(minimal + "detector: {type: trained" + value + "}\n", folder + "s.yaml");
    if (!set.empty()) file.apply({"detector.memories", set});
    return parse_scene(file, catalogues).detector->parameters.path("memories");
  };
  EXPECT_EQ(memories("", "scenes/", ""), "own");
  EXPECT_EQ(memories(", memories: own", "scenes/", ""), "own");
  EXPECT_EQ(memories(", memories: ./own", "scenes/", ""), "scenes/./own");
  EXPECT_EQ(memories(", memories: ../mine", "scenes/", ""), "scenes/../mine");
  EXPECT_EQ(memories(", memories: mine", "", ""), "mine");
  EXPECT_EQ(memories(", memories: /mine", "scenes/", ""), "/mine");
  EXPECT_EQ(memories("", "scenes/", "mine"), "mine");
  EXPECT_EQ(memories(", memories: mine", "scenes/", "../other"), "../other");
  EXPECT_EQ(memories("", "scenes/", "own"), "own");
}

TEST(Scene, ASweptPathIsFromTheFolderOfWhatNamesIt) {
  const Catalogues catalogues = test_catalogues();
  SceneFile file = SceneFile::from_text(minimal + "detector: {type: trained, memories: ours}\n", "scenes/s.yaml");
  file.apply({"sweep", "{detector.memories: [mine, own]}"});
  const TrialPlan plan(file, catalogues, 1, 7);
  EXPECT_EQ(plan.trial(0).scene.detector->parameters.path("memories"), "mine");
  EXPECT_EQ(plan.trial(1).scene.detector->parameters.path("memories"), "own");
}

// A trial reports a swept path as the scene writes it, so that it is valid on any machine.
TEST(Scene, SweptPathsAreReportedAsWritten) {
  const Catalogues catalogues = test_catalogues();
  const SceneFile file =
      SceneFile::from_text(minimal + "detector: {type: trained}\nsweep: {detector.memories: [own, ../mine]}\n", "scenes/s.yaml");
  const TrialPlan plan(file, catalogues, 1, 7);
  const TrialPlan::Trial trial = plan.trial(1);
  EXPECT_EQ(trial.drawn.front().second, "\"../mine\"");
  EXPECT_EQ(trial.scene.detector->parameters.path("memories"), "scenes/../mine");
}

TEST(Scene, ReadsEveryKey) {
  const Scene scene = read(R"(
slipbench: 1
description: 'text: with colon'
duration: 500 ms
time_step: 0.1 ms
fidelity: field
seed: 18446744073709551615
surface: {shape: cylinder, material: ptfe, radius: 20 mm}
friction: {static: 0.4, kinetic: 0.3, scale: 2}
motion:
  kind: stage
  pivot: [1 mm, -2e-3]
  stop: inf
  acceleration: inf
sensors:
  left: {type: papillarray, rate: 100 Hz, bristles: 6, profile: hexapod, bias: false, electronics: typical}
  right_2: {type: papillarray, electronics: [{drift: {slope: 2 mN}}]}
effects:
  - stribeck
  - ageing: {rate: 0.1}
detector: {type: none}
controller: {type: none}
expect: {gross_slip_by: 1.0 s}
)");
  EXPECT_EQ(scene.description, "text: with colon");
  EXPECT_EQ(scene.duration, 0.5);
  EXPECT_EQ(scene.time_step, 1e-4);
  EXPECT_EQ(scene.fidelity, "field");
  EXPECT_EQ(scene.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(scene.material, "ptfe");
  EXPECT_EQ(scene.surface.name, "cylinder");
  EXPECT_EQ(scene.surface.parameters.number("radius"), 0.02);
  EXPECT_EQ(scene.friction.static_coefficient, 0.8);
  EXPECT_EQ(scene.friction.kinetic_coefficient, 0.6);
  EXPECT_EQ(scene.friction.scale, 2.0);
  EXPECT_EQ(scene.motion.parameters.vector("pivot"), (std::vector{0.001, -0.002}));
  ASSERT_EQ(scene.sensors.size(), 2u);
  const Parameters& left = scene.sensors[0].parameters;
  EXPECT_EQ(left.number("rate"), 100.0);
  EXPECT_EQ(left.integer("bristles"), 6);
  EXPECT_EQ(left.choice("profile"), "hexapod");
  EXPECT_FALSE(left.flag("bias"));
  // typical: every part of the catalogue with its defaults.
  ASSERT_EQ(scene.sensors[0].electronics.size(), 7u);
  EXPECT_EQ(scene.sensors[0].electronics[0].name, "noise");
  EXPECT_EQ(scene.sensors[0].electronics[1].name, "drift");
  EXPECT_EQ(scene.sensors[0].electronics[1].parameters.number("slope"), 0.001);
  ASSERT_EQ(scene.sensors[1].electronics.size(), 1u);
  EXPECT_EQ(scene.sensors[1].electronics[0].parameters.number("slope"), 0.002);
  ASSERT_EQ(scene.effects.size(), 2u);
  EXPECT_EQ(scene.effects[0].name, "stribeck");
  EXPECT_EQ(scene.effects[0].parameters.number("speed"), 0.001);
  EXPECT_EQ(scene.effects[1].name, "ageing");
  EXPECT_EQ(scene.effects[1].parameters.number("rate"), 0.1);
  ASSERT_EQ(scene.expect.expectations.size(), 1u);
  EXPECT_EQ(scene.expect.expectations[0].name, "gross_slip_by");
  EXPECT_EQ(scene.expect.expectations[0].parameters.number("limit"), 1.0);
  EXPECT_EQ(scene.expect.confidence, 0.95);
  EXPECT_EQ(scene.expect.control, "");
}

TEST(Scene, TakesFrictionFromTheMaterialUnlessItGivesItsOwn) {
  // ptfe is 0.35 / 0.3325, a ratio of 0.95.
  const std::string ptfe = minimal + "surface: {material: ptfe}\n";
  EXPECT_EQ(read(ptfe).friction.static_coefficient, 0.35);
  EXPECT_EQ(read(ptfe).friction.kinetic_coefficient, 0.3325);
  EXPECT_DOUBLE_EQ(read(ptfe + "friction: {static: 0.2}\n").friction.kinetic_coefficient, 0.19);
  EXPECT_EQ(read(ptfe + "friction: {kinetic: 0.1}\n").friction.static_coefficient, 0.35);
  EXPECT_EQ(read(ptfe + "friction: {kinetic: 0.1}\n").friction.kinetic_coefficient, 0.1);
  EXPECT_EQ(read(ptfe + "friction: {scale: 2}\n").friction.static_coefficient, 0.7);
  EXPECT_EQ(read(ptfe + "friction: {static: 0}\n").friction.kinetic_coefficient, 0.0);
}

TEST(Scene, TakesAnEffectWithoutParametersInEitherForm) {
  const Scene scene = read(minimal + "effects:\n  - ageing:\n  - stribeck: {}\n");
  ASSERT_EQ(scene.effects.size(), 2u);
  EXPECT_EQ(scene.effects[0].parameters.number("rate"), 0.03);
}

TEST(Scene, KeepsItsTextAsItWasRead) {
  SceneFile file = SceneFile::from_text(minimal, "s.yaml");
  file.apply({"seed", "3"});
  EXPECT_EQ(file.text(), minimal);
  EXPECT_EQ(file.name(), "s.yaml");
}

TEST(Materials, AreThoseOfTheBenchWithTheirSources) {
  std::set<std::string> names;
  for (const Material& material : material_table()) {
    names.insert(material.name);
    EXPECT_GT(material.mu_kinetic, 0.0) << material.name;
    EXPECT_LE(material.mu_kinetic, material.mu_static) << material.name;
    EXPECT_FALSE(material.source.empty()) << material.name;
  }
  const std::set<std::string> expected{
      "acrylic", "cardboard",           "felt",         "glass",    "masonite",  "paper",    "ptfe",
      "rubber",  "soaped_wavy_acrylic", "wavy_acrylic", "wet_felt", "wet_paper", "wet_ptfe", "wet_rubber"};
  EXPECT_EQ(names, expected);
  EXPECT_EQ(material_table().size(), expected.size());
}

// Tables of a scene: rows in the scene itself and in CSV files.
const std::string csv = "places.csv";

// One folder per process, because tests run in parallel.
std::string folder() {
  const std::string path = testing::TempDir() + "tables_" + std::to_string(getpid()) + "/";
  std::filesystem::create_directories(path);
  return path;
}

Scene scene_of(const std::string& places, const std::string& file = "", const std::string& more = "") {
  Catalogues catalogues = test_catalogues();
  const std::vector<TableColumn> columns{{"x", Quantity::length}, {"y", Quantity::length}, {"weight"}};
  catalogues.sensors.push_back(
      {"skin",
       "",
       "",
       "",
       {table_spec(2, "places", columns, "doc", "assumed"), table_spec(1, "matrix", {}, "doc", "assumed"),
        map_spec("channels", "doc", "assumed", {"force", "shear"})}});
  std::ofstream(folder() + csv) << file;
  const std::string path = folder() + "table.yaml";
  std::ofstream(path) << "slipbench: 1\nsensors:\n  pad:\n    type: skin\n    places: " + places + "\n" + more;
  return parse_scene(SceneFile::load(path), catalogues);
}
std::vector<std::vector<double>> rows_of(const std::string& places, const std::string& file = "") {
  return scene_of(places, file).sensors[0].parameters.table("places").rows;
}
std::string refusal(const std::string& places, const std::string& file = "", const std::string& more = "") {
  std::string said = refusal_of([&] { static_cast<void>(scene_of(places, file, more)); });
  for (std::size_t at; (at = said.find(folder())) != std::string::npos;) said.erase(at, folder().size());
  return said;
}

TEST(SceneTable, RowsStandInTheSceneOrInAFile) {
  const std::vector<std::vector<double>> in_scene = rows_of("[[4 mm, 1, 2], [0.5, 1 cm, 3]]");
  EXPECT_EQ(in_scene, (std::vector<std::vector<double>>{{0.004, 1.0, 2.0}, {0.5, 0.01, 3.0}}));
  EXPECT_EQ(rows_of(csv, "weight, y, x [mm]\r\n2,1,4\n\n3,1 cm,500\n"), in_scene);
  EXPECT_TRUE(std::isnan(rows_of("[[1, 2]]")[0][2]));
  EXPECT_TRUE(std::isnan(rows_of(csv, "x,y\n1,2\n")[0][2]));
  EXPECT_TRUE(rows_of("none").empty());
  const Scene scene = scene_of(csv, "x,y\n1,2\n", "    matrix: [[1, 2, 3], [4, 5, 6]]\n");
  EXPECT_EQ(scene.sensors[0].parameters.table("places").path, folder() + csv);
  EXPECT_EQ(scene.sensors[0].parameters.table("matrix").rows[1][2], 6.0);
}

TEST(SceneTable, ErrorsNameTheLineOfWhatIsWrong) {
  EXPECT_THAT(refusal("[[1]]"), refused_at("table.yaml:5", {"sensors.pad.places", "1", "x, y, weight"}));
  EXPECT_THAT(refusal("[[1, 2, 3, 4]]"), refused_at("table.yaml:5", {"sensors.pad.places", "4", "x, y, weight"}));
  EXPECT_THAT(refusal("[1, 2]"), refused_at("table.yaml:5", {"sensors.pad.places", "'1'", "x, y, weight"}));
  EXPECT_THAT(refusal("[[1, 2 N]]"), refused_at("table.yaml:5", {"sensors.pad.places", "2 N"}));
  EXPECT_THAT(refusal("{a: 1}"), refused_at("table.yaml:5", {"sensors.pad.places", "map"}));
  EXPECT_THAT(refusal("none", "", "    matrix: [[1, 2], [3]]\n"), refused_at("table.yaml:6", {"sensors.pad.matrix", "row", "1"}));
  EXPECT_THAT(refusal("gone.csv"), refused_at("table.yaml:5", {"gone.csv"}));
  EXPECT_THAT(refusal(csv, "x,z\n1,2\n"), refused_at("places.csv:1", {"z", "x, y, weight"}));
  EXPECT_THAT(refusal(csv, "x,x\n"), refused_at("places.csv:1", {"x", "twice"}));
  EXPECT_THAT(refusal(csv, "x [mm,y\n"), refused_at("places.csv:1", {"x [mm", "]"}));
  EXPECT_THAT(refusal(csv, "x,y\n1,2\n1\n"), refused_at("places.csv:3", {"1 cell,", "2"}));
  EXPECT_THAT(refusal(csv, "x,y\n1,2\n1,two\n"), refused_at("places.csv:3", {"sensors.pad.places", "two", "length"}));
  EXPECT_THAT(refusal(csv, "x,weight\n1,2\n"), refused_at("places.csv:2", {"sensors.pad.places", "nothing"}));
  EXPECT_THAT(refusal(csv, "x,y\n"), refused_at("places.csv", {"sensors.pad.places"}));
}

// A scene of others may name files of its own folder, of the current folder and of the program; no
// message shows the content of another file.
TEST(SceneTable, FilesAreThoseOfTheFoldersThatTheUserNamed) {
  const std::string secret = folder() + "secret.csv", inside = folder() + "scene/";
  std::ofstream(secret) << "root:x:0:0\n1,2\n";
  std::filesystem::create_directories(inside);
  Catalogues catalogues = test_catalogues();
  catalogues.sensors.push_back(
      {"skin", "", "", "", {table_spec(2, "places", {{"x", Quantity::length}, {"y", Quantity::length}}, "doc", "assumed")}});
  const std::string head = "slipbench: 1\nsensors:\n  pad: {type: skin, places: ", path = inside + "s.yaml";
  const auto load = [&](const std::string& name, const std::string& set) {
    std::ofstream(path) << head << name << "}\n";
    SceneFile file = SceneFile::load(path);
    if (!set.empty()) file.apply({"sensors.pad.places", set});
    return parse_scene(file, catalogues).sensors[0].parameters.table("places").rows.size();
  };
  std::ofstream(inside + "own.csv") << "x,y\n1,2\n";
  EXPECT_EQ(load("own.csv", ""), 1);
  EXPECT_EQ(load("../scene/own.csv", ""), 1);
  std::filesystem::remove(inside + "link.csv");
  std::filesystem::create_symlink(secret, inside + "link.csv");
  for (const std::string& name : {secret, std::string("../secret.csv"), std::string("link.csv")}) {
    const std::string said = refusal_of([&] { static_cast<void>(load(name, "")); });
    EXPECT_THAT(said, refused_at(path + ":3", {"sensors.pad.places", "outside", "--set sensors.pad.places=PATH"})) << name;
    EXPECT_EQ(said.find("root"), std::string::npos) << said;
  }
  std::ofstream(secret) << "x,y\n1,2\n3,4\n";
  EXPECT_EQ(load("own.csv", secret), 2);  // named on the command line
  // The scene and the overrides of a dataset are words of others, too; a text of the caller is not.
  // The name of the source does not count.
  const auto rows = [&](const SceneFile& file) {
    return parse_scene(file, catalogues).sensors[0].parameters.table("places").rows.size();
  };
  const std::string text = head + secret + "}\n";
  EXPECT_EQ(rows(SceneFile::from_text(text, "<text>", true)), 2);
  for (const char* name : {"attribute scene", "<text>", "<stdin>", "--set"}) {
    EXPECT_THAT(refusal_of([&] { static_cast<void>(rows(SceneFile::from_text(text, name))); }),
                refused_at(std::string(name) + ":3", {"outside"}));
  }
  for (const bool callers_own : {false, true}) {
    SceneFile file = SceneFile::from_text(head + "none}\n", "attribute scene");
    file.apply({.path = "sensors.pad.places", .value = secret, .option = "--set", .of_sweep = false, .callers_own = callers_own});
    if (callers_own) {
      EXPECT_EQ(rows(file), 2);
    } else {
      EXPECT_THAT(refusal_of([&] { static_cast<void>(rows(file)); }), testing::HasSubstr("outside"));
    }
  }
}

// Networks, models and memories follow the same rule. A library is code that the user chooses to run.
TEST(Scene, FilesOfPartsAreThoseOfTheFoldersThatTheUserNamed) {
  const std::string inside = folder() + "parts/";
  std::filesystem::create_directories(inside);
  std::ofstream(folder() + "memory") << "x";
  std::ofstream(inside + "s.yaml") << minimal << "detector: {type: trained, memories: ../memory}\n";
  const Catalogues catalogues = test_catalogues();
  SceneFile file = SceneFile::load(inside + "s.yaml");
  EXPECT_THAT(refusal_of([&] { static_cast<void>(parse_scene(file, catalogues)); }),
              testing::HasSubstr("detector.memories: '" + inside + "../memory' is outside of the folder"));
  file.apply({"detector.memories", folder() + "memory"});
  EXPECT_EQ(parse_scene(file, catalogues).detector->parameters.path("memories"), folder() + "memory");
}

TEST(SceneTable, NamesOfAMapAreThoseThatAreAllowed) {
  EXPECT_EQ(scene_of("none", "", "    channels: {a: shear}\n").sensors[0].parameters.map("channels"),
            (ParameterMap{{"a", "shear"}}));
  EXPECT_THAT(refusal("none", "", "    channels: {a: sheer}\n"),
              refused_at("table.yaml:6", {"sensors.pad.channels.a", "sheer", "shear"}));
}

}  // namespace
}  // namespace slipbench

// Tables of a scene: rows in the scene itself and in CSV files.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench {
namespace {

const std::string csv = "places.csv";

// One a process, since tests run side by side.
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
  const std::string row = "table.yaml:5: sensors.pad.places: a row is ", allowed = "; allowed: x, y, weight or none";
  EXPECT_EQ(refusal("[[1]]"), row + "a sequence of 1" + allowed);
  EXPECT_EQ(refusal("[[1, 2, 3, 4]]"), row + "a sequence of 4" + allowed);
  EXPECT_EQ(refusal("[1, 2]"), row + "'1' of 0" + allowed);
  EXPECT_THAT(refusal("[[1, 2 N]]"), StartsWith("table.yaml:5: sensors.pad.places: "));
  EXPECT_THAT(refusal("{a: 1}"),
              StartsWith("table.yaml:5: sensors.pad.places is a map; allowed: rows of numbers, [[a, b, ...], ...]"));
  EXPECT_EQ(refusal("none", "", "    matrix: [[1, 2], [3]]\n"),
            "table.yaml:6: sensors.pad.matrix: a row is a sequence of 1; allowed: as many numbers as the first row");
  EXPECT_EQ(refusal("gone.csv"),
            "table.yaml:5: no file 'gone.csv' can be read; allowed: the path of a CSV file from the scene's own folder");
  EXPECT_EQ(refusal(csv, "x,z\n1,2\n"), "places.csv:1: unknown column 'z'; allowed: x, y, weight");
  EXPECT_EQ(refusal(csv, "x,x\n"), "places.csv:1: column 'x' stands there twice");
  EXPECT_EQ(refusal(csv, "x [mm,y\n"), "places.csv:1: 'x [mm' does not end with ']'; allowed: a name, or a name [unit]");
  EXPECT_EQ(refusal(csv, "x,y\n1,2\n1\n"), "places.csv:3: a row of 1 cells; allowed: as the header, 2");
  EXPECT_THAT(refusal(csv, "x,y\n1,2\n1,two\n"),
              StartsWith("places.csv:3: sensors.pad.places: 'two' is not a length; allowed: a number in m"));
  EXPECT_THAT(refusal(csv, "x,weight\n1,2\n"), StartsWith("places.csv:2: sensors.pad.places is nothing"));
  EXPECT_THAT(refusal(csv, "x,y\n"), StartsWith("places.csv: sensors.pad.places is "));
}

TEST(SceneTable, NamesOfAMapAreThoseThatAreAllowed) {
  EXPECT_EQ(scene_of("none", "", "    channels: {a: shear}\n").sensors[0].parameters.map("channels"),
            (ParameterMap{{"a", "shear"}}));
  EXPECT_THAT(refusal("none", "", "    channels: {a: sheer}\n"),
              StartsWith("table.yaml:6: sensors.pad.channels.a: unknown value 'sheer'; did you mean 'shear'?"));
}

}  // namespace
}  // namespace slipbench

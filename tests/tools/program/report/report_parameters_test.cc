#include "tools/program/report/report_parts.h"

#include <gtest/gtest.h>

namespace slipbench::report {
namespace {

TEST(PlainValue, TurnsTextWithAUnitIntoSi) {
  EXPECT_EQ(plain_value("motion.speed", "4 mm/s"), Json::parse(R"({"value": 0.004, "unit": "m/s"})"));
  EXPECT_EQ(plain_value("any.path", "2 s").at("unit"), "s");
}

TEST(PlainValue, TakesTheUnitOfABareNumberFromItsKey) {
  EXPECT_EQ(plain_value("motion.speed", 0.004), Json::parse(R"({"value": 0.004, "unit": "m/s"})"));
  EXPECT_EQ(plain_value("motion.compression", "0.001"), Json::parse(R"({"value": 0.001, "unit": "m"})"));
  EXPECT_EQ(plain_value("motion.tilt.0", 0.02).at("unit"), "rad");  // an index is no key
  EXPECT_EQ(plain_value("friction.static", 0.5).at("unit"), "");
  // Whatever the entries declare, wherever they stand.
  EXPECT_EQ(plain_value("motion.travel", 0.02).at("unit"), "m");
  EXPECT_EQ(plain_value("motion.clearance", 0.0).at("unit"), "m");
  EXPECT_EQ(plain_value("sensors.pad.tip_radius", 0.1).at("unit"), "m");
  EXPECT_EQ(plain_value("sensors.pad.k_tangential", 9000.0).at("unit"), "N/m");
  EXPECT_EQ(plain_value("box.mass", 0.1).at("unit"), "kg");
  EXPECT_EQ(plain_value("motion.vibration", 2.0).at("unit"), "") << "a level";
  EXPECT_EQ(plain_value("duration", 2.0).at("unit"), "s");
  EXPECT_EQ(plain_value("detector.window", 0.1).at("unit"), "s");
  EXPECT_EQ(plain_value("detector.parameters.window", 0.1).at("unit"), "") << "a library's own, which only the library knows";
}

TEST(PlainValue, HasNoNumberForInfinity) {
  EXPECT_EQ(plain_value("motion.stop", "inf"), Json::parse(R"({"value": null, "unit": "s"})"));
}

TEST(PlainValue, KeepsNamesAndListsAsText) {
  EXPECT_EQ(plain_value("surface.material", "acrylic"), Json::parse(R"({"text": "acrylic"})"));
  EXPECT_EQ(plain_value("motion.pivot", Json::parse("[0.004, \"1 mm\"]")), Json::parse(R"j({"text": "(4 mm, 1 mm)"})j"));
  EXPECT_EQ(plain_value("effects", Json::parse("{\"noise\": true}")), Json::parse(R"({"text": "{\"noise\":true}"})"));
}

TEST(Axes, SaysWhatVaries) {
  std::vector<Json> trials(2, Json::object());
  trials[0]["motion.speed"] = plain_value("motion.speed", "4 mm/s");
  trials[1]["motion.speed"] = plain_value("motion.speed", "8 mm/s");
  for (Json& trial : trials) trial["surface.material"] = plain_value("surface.material", "acrylic");
  trials[1]["friction.static"] = plain_value("friction.static", 0.5);
  const Json expected = Json::parse(R"([
    {"path": "motion.speed", "unit": "m/s", "numeric": true, "varied": true},
    {"path": "surface.material", "unit": "", "numeric": false, "varied": false},
    {"path": "friction.static", "unit": "", "numeric": true, "varied": true}])");
  EXPECT_EQ(axes(trials), expected);
}

}  // namespace
}  // namespace slipbench::report

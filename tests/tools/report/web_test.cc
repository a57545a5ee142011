// Checks of scripts and styles without a browser.
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/page/web_files.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/report/report.h"

namespace slipbench::report {
namespace {

using ::slipbench::testing::matches;
using ::slipbench::testing::unpaired_brackets;
using ::slipbench::testing::variables;

std::map<std::string, std::string> web_files(const std::string& extension) {
  return ::slipbench::testing::web_files("tools/report/web", extension);
}

// Every file of the folder is part of the page of grasps between soft skins: CMakeLists.txt lists
// all. Other pages leave out the code for grasps and skins.
TEST(ReportPage, HoldsItsFiles) {
  const std::string grasps = report_page("title", {{"grasps", Json::object()}, {"skins", Json::object()}}),
                    others = report_page("title", Json::object());
  for (const char* extension : {".js", ".css", ".txt"}) {
    for (const auto& [name, text] : web_files(extension)) {
      EXPECT_NE(grasps.find(text), std::string::npos) << name;
      EXPECT_EQ(others.find(text) == std::string::npos, name.starts_with("grasp_") || name == "skin.js") << name;
    }
  }
  EXPECT_EQ(others.find("sourceMappingURL"), std::string::npos);
  EXPECT_TRUE(begins_as_report(others));
}

TEST(Scripts, UseOnlyWhatSomeScriptDefines) {
  std::set<std::string> defined;
  for (const auto& [name, text] : ::slipbench::testing::web_files("tools/page/web", ".js"))
    defined.merge(matches(text, R"(\bsb\.(\w+) = )"));
  std::map<std::string, std::set<std::string>> used;
  for (const auto& [name, text] : web_files(".js")) {
    defined.merge(matches(text, R"(\bsb\.(\w+) = )"));
    used[name] = matches(text, R"(\bsb\.(\w+))");
  }
  ASSERT_GE(used.size(), 8U);
  for (const auto& [name, names] : used) {
    for (const std::string& member : names) EXPECT_TRUE(defined.contains(member)) << name << " uses sb." << member;
  }
}

// A sensor's peculiarities belong in its entry.
TEST(Scripts, NameNoSensor) {
  for (const Entry& sensor : pad_catalogues().sensors) {
    for (const auto& [name, text] : web_files(".js"))
      EXPECT_EQ(text.find(sensor.name), std::string::npos) << name << ": " << sensor.name;
  }
}

TEST(Scripts, HaveBalancedBrackets) {
  for (const auto& [name, text] : web_files(".js")) EXPECT_EQ(unpaired_brackets(text), "") << name;
}

// A pad with X up, Y to the right and Z away from the reader is seen from the side that it touches.
TEST(Scripts, SayFromWhereThePadIsSeen) {
  for (const auto& [name, text] : web_files(".js")) EXPECT_EQ(text.find("from above"), std::string::npos) << name;
}

// An infinite swept value has no place on a scale: each picture and table of the overview gives it
// a separate place.
TEST(Scripts, ShowEndlessValues) {
  const std::string text = web_files(".js").at("dataset.js");
  for (const char* name : {"swept", "encoding", "placesAlong", "table"}) {
    const std::size_t begin = text.find(std::string("\nfunction ") + name + "(");
    ASSERT_NE(begin, std::string::npos) << name;
    const std::string body = text.substr(begin, text.find("\n}\n", begin) - begin);
    EXPECT_NE(body.find("endless(axis, trial)"), std::string::npos) << name;
    EXPECT_NE(body.find("sb.endless(axis.unit)"), std::string::npos) << name;
  }
}

TEST(Styles, UseOnlyTheKitsColours) {
  const std::set<std::string> colours =
      variables(::slipbench::testing::web_files("tools/page/web", ".css").at("theme.css"), ":root");
  std::string all = web_files(".css").at("report.css");
  for (const auto& [name, text] : web_files(".js")) all += text;
  for (const std::string& variable : matches(all, R"(var\(--(\w+)\))")) EXPECT_TRUE(colours.contains(variable)) << variable;
  for (const std::string& variable : matches(all, R"(colour\('(\w+)'\))")) EXPECT_TRUE(colours.contains(variable)) << variable;
}

}  // namespace
}  // namespace slipbench::report

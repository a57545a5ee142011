
#include <cstddef>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <stdexcept>

#include "tests/expect.h"
#include "tests/tools/cost/example.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tests/tools/page/web_files.h"
#include "tools/cost/reading.h"
#include "tools/page/svg.h"
#include "tools/report/report.h"

namespace slipbench::cost {
namespace {

using ::slipbench::testing::matches;
using ::slipbench::testing::unpaired_brackets;
using ::slipbench::testing::variables;
using ::slipbench::testing::web_files;

Price price(const std::string& name, Errors changes) {
  Price price{.name = name, .share = 0.2, .low = 0.1, .high = 0.3, .changes = std::move(changes)};
  price.without = CpuTime{0.016, 0.015, 0.017, 9};
  return price;
}

Json combination() {
  return {{"case", "a box"},     {"integrator", "Euler"}, {"mass_kg", 0.1},   {"stiffness_scale", 1},
          {"k_normal", 7e3},     {"damping_s", 0.0},      {"omega", 264.575}, {"predicted_s", 7e-3},
          {"allowed_s", 5.6e-3}, {"measured_s", 7.5e-3},  {"ratio", 0.93}};
}

Json stability() {
  return {{"slipbench_stability", 1},
          {"text", Json::array({"what was measured"})},
          {"combinations", Json::array({combination()})},
          {"worst_ratio", 0.93},
          {"above", 0},
          {"remarks", Json::array({"none"})}};
}

// Made like the program's, so that the page reads real data: an effect that changes results, one
// whose absence changes the outcome, one that is required, and a setting that was not reached in
// time.
Json exploration(const std::string& scene = "a.yaml") {
  Exploration made = example();
  made.scene_path = scene;
  made.description = "A <scene> é </script><script>alert(1)</script>";
  made.rows.front().own = true;
  made.rows.back().why = "a <reason>";
  Row unrun = made.rows.back();
  unrun.status = Status::over_budget;
  made.rows.push_back(unrun);
  Price refused = price("noise", {});
  refused.why = "a <rule>";
  made.prices = {price("texture", onset_error(0.05)), price("stribeck", onset_error(0.5, true)), refused};
  return cost_json(made, {{"cpu", "a processor"}});
}

// Returns the page's data as a browser reads them.
Json data_of(const std::string& page) {
  const std::string begin = "id=\"slipbench-data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return Json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(CostPage, HoldsTheResultAsData) {
  Json both = exploration();
  both["stability"] = stability();
  for (const Json& result : {exploration(), stability(), both}) EXPECT_EQ(data_of(cost_page(result)), result);
}

TEST(CostPage, TextIsNeverMarkup) {
  const std::string page = cost_page(exploration("<b>.yaml"));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("<script>alert")), Not(HasSubstr("a <reason>")), Not(HasSubstr("a <rule>")),
                          Not(HasSubstr("<b>.yaml")), HasSubstr("<title>&lt;b&gt;.yaml · slipbench cost</title>")));
  EXPECT_THAT(cost_page(stability()), HasSubstr("<title>stability · slipbench cost</title>"));
  for (const auto& [name, text] : web_files("tools/cost/web", ".js")) {
    EXPECT_THAT(text, AllOf(Not(HasSubstr("innerHTML")), Not(HasSubstr(".html(")), Not(HasSubstr("insertAdjacent")))) << name;
  }
}

TEST(CostPage, LoadsNothing) {
  const std::string page = cost_page(exploration());
  EXPECT_FALSE(std::regex_search(page, std::regex(R"((src|href)\s*=\s*["']?(https?:)?//)")));
  EXPECT_FALSE(std::regex_search(page, std::regex(R"(url\(\s*["']?(https?:)?//)")));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("@import")), Not(HasSubstr("<script src")), Not(HasSubstr("sourceMappingURL"))));
}

TEST(CostPage, HoldsItsFilesAndTheSharedOnes) {
  const std::string page = cost_page(exploration());
  for (const page::Asset& file : assets()) EXPECT_NE(page.find(file.text), std::string::npos) << file.name;
  for (const char* name : {"page.css", "common.js", "chart.js", "d3.min.js", "d3_licence.txt"}) {
    EXPECT_NE(page.find(page::embedded(page::assets(), name)), std::string::npos) << name;
  }
  // The code that draws recordings is not needed here.
  EXPECT_THAT(page, AllOf(Not(HasSubstr("sb.Timeline")), Not(HasSubstr("{{"))));
}

// Every script of the folder is part of the page: CMakeLists.txt lists all.
TEST(CostPage, LeavesNoScriptOut) {
  std::set<std::string> embedded;
  for (const page::Asset& file : assets()) embedded.insert(std::string(file.name));
  for (const char* extension : {".js", ".css"}) {
    for (const auto& [name, text] : web_files("tools/cost/web", extension)) EXPECT_TRUE(embedded.contains(name)) << name;
  }
}

TEST(CostPage, IsToldFromOtherPages) {
  const std::string page = cost_page(exploration());
  // Recognised by its first 4 kB, for any title; neither this page nor a report passes for the
  // other.
  EXPECT_TRUE(page::begins_as_page(cost_page(exploration(std::string(8000, 'x'))).substr(0, 4096), page_kind.generator));
  EXPECT_FALSE(report::begins_as_report(page));
  EXPECT_FALSE(page::begins_as_page(report::report_page("title", Json::object()), page_kind.generator));
  EXPECT_TRUE(page::begins_as_object(exploration().dump(2), page_kind));
  EXPECT_TRUE(page::begins_as_object(stability().dump(2), page_kind));
  EXPECT_FALSE(page::begins_as_object(Json{{"reproduction", "a"}, {"slipbench_cost", 1}}.dump(2), page_kind));
}

TEST(CostPage, RefusesWhatIsNoResult) {
  for (const Json& other : {Json(), Json::array(), Json::object(), Json{{"scene", "a"}, {"slipbench_cost", 1}}}) {
    EXPECT_THROW(cost_page(other), std::logic_error) << other;
  }
}

struct CostFileTest : ::slipbench::testing::FolderTest {
  std::vector<std::string> write(const Json& result) const {
    return page::write_page_files(path("c.html"), page_kind, cost_page(result), result);
  }
};

TEST_F(CostFileTest, StandsBesideItsFigures) {
  EXPECT_THAT(write(exploration()), ElementsAre(path("c.html"), path("c.json")));
  EXPECT_EQ(Json::parse(bytes_of(path("c.json"))), exploration());
  EXPECT_EQ(bytes_of(path("c.html")), cost_page(exploration()));
  // It replaces its own files of either kind, and leaves no temporary one.
  write(stability());
  EXPECT_EQ(Json::parse(bytes_of(path("c.json"))), stability());
  EXPECT_THAT(names(), ElementsAre("c.html", "c.json"));
}

TEST_F(CostFileTest, OtherFilesAreKept) {
  std::ofstream(path("c.json")) << "{\"mine\": 1}";
  EXPECT_THAT(refusal_of([&] { write(exploration()); }), HasSubstr("c.json"));
  EXPECT_EQ(bytes_of(path("c.json")), "{\"mine\": 1}");
  EXPECT_THAT(names(), ElementsAre("c.json"));

  std::ofstream(path("report.html")) << report::report_page("title", Json::object());
  EXPECT_THAT(refusal_of([&] { page::check_page_files(path("report.html"), page_kind); }), HasSubstr("report.html"));
  EXPECT_THAT(refusal_of([&] { page::check_page_files(path("c.txt"), page_kind); }), mentions({".html"}));
  EXPECT_THAT(refusal_of([&] { page::check_page_files(path("no/c.html"), page_kind); }), HasSubstr("no"));
}

// Scripts may use their own definitions and those shared by all pages.
TEST(CostScripts, UseOnlyWhatSomeScriptDefines) {
  std::set<std::string> defined;
  for (const auto& [name, text] : web_files("tools/page/web", ".js")) defined.merge(matches(text, R"(\bsb\.(\w+) = )"));
  const auto scripts = web_files("tools/cost/web", ".js");
  ASSERT_GE(scripts.size(), 6U);
  for (const auto& [name, text] : scripts) {
    for (const std::string& member : matches(text, R"(\n *sb\.(\w+) = )")) {
      EXPECT_TRUE(defined.insert(member).second) << name << " defines sb." << member << " again";
    }
  }
  for (const auto& [name, text] : scripts) {
    EXPECT_EQ(unpaired_brackets(text), "") << name;
    for (const std::string& member : matches(text, R"(\bsb\.(\w+))")) {
      EXPECT_TRUE(defined.contains(member)) << name << " uses sb." << member;
    }
  }
}

// A member that a script reads under another name or in another shape would silently be empty, and
// a member that no script reads would not be shown.
TEST(CostScripts, ReadTheMembersThatThereAre) {
  std::string all;
  for (const auto& [name, text] : web_files("tools/cost/web", ".js")) all += text;
  Json data = exploration();
  data["stability"] = stability();  // of --stability alone
  data["remarks"] = Json::array();
  const std::map<std::string, Json> objects = {{"data", data},
                                               {"reference", data.at("reference")},
                                               {"row", data.at("rows").at(0)},
                                               {"cpu", data.at("rows").at(0).at("cpu_s")},
                                               {"measure", data.at("measures").at(0)},
                                               {"effect", data.at("effects").at(0)},
                                               {"change", data.at("effects").at(0).at("changes").at("onset")},
                                               {"combination", combination()},
                                               {"stability", stability()}};
  // Not shown: the scale is in the stiffness, the frequency in the prediction; a map differs from
  // an exploration by its members; the trial is in the command, the reference's own error in every
  // measure as its floor.
  const std::set<std::string> unread = {"stiffness_scale", "omega", "slipbench_stability", "trial", "own_error"};
  for (const auto& [name, object] : objects) {
    const std::set<std::string> read = matches(all, "\\b" + name + R"(\.(\w+))");
    EXPECT_THAT(read, Not(IsEmpty())) << name;
    for (const std::string& member : read) {
      EXPECT_TRUE(object.contains(member)) << name << "." << member;
    }
    for (const auto& member : object.items()) {
      EXPECT_EQ(std::regex_search(all, std::regex("\\b" + member.key() + "\\b")), !unread.contains(member.key())) << member.key();
    }
  }
}

// The names by which the page recognises failures.
TEST(CostScripts, KnowWhatWasNotRun) {
  EXPECT_THAT(web_files("tools/cost/web", ".js").at("marks.js"),
              HasSubstr("row.status === '" + std::string(status_name(Status::over_budget)) + "'"));
}

TEST(CostStyles, UseOnlyTheKitsColours) {
  const std::set<std::string> colours = variables(web_files("tools/page/web", ".css").at("theme.css"), ":root");
  std::string all = web_files("tools/cost/web", ".css").at("cost.css");
  for (const auto& [name, text] : web_files("tools/cost/web", ".js")) all += text;
  for (const std::string& variable : matches(all, R"(var\(--(\w+)\))")) EXPECT_TRUE(colours.contains(variable)) << variable;
}

// Two series differ in both colour and shape: there are as many colours as shapes.
TEST(CostStyles, HaveAColourForEachShape) {
  const std::string marks = web_files("tools/page/web", ".js").at("chart.js");
  const std::size_t begin = marks.find("const shapes = [");
  ASSERT_NE(begin, std::string::npos);
  const std::string shapes = marks.substr(begin, marks.find("];", begin) - begin);
  EXPECT_EQ(matches(shapes, R"((\w+)[,\n])").size(), page::series_count);
}

}  // namespace
}  // namespace slipbench::cost

#include <fstream>
#include <set>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/base/project/project_file.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

TEST(Reproductions, AreFoundByTheirName) {
  std::set<std::string> names;
  for (const Reproduction& one : reproductions()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_EQ(&find_reproduction(one.name), &one);
  }
}

TEST(Reproductions, UnknownNamesGetTheNearest) {
  EXPECT_THAT(refusal_of([] { find_reproduction("hd-papillarray/latancy"); }),
              mentions({"hd-papillarray/latancy", "hd-papillarray/latency"}));
}

TEST(ProjectFile, IsThereOrSaysWhereItWasLookedFor) {
  EXPECT_TRUE(project_file("scenes/papillarray/hexapod.yaml").ends_with("scenes/papillarray/hexapod.yaml"));
  EXPECT_EQ(find_project_file("nowhere/nothing.yaml"), std::nullopt);
  EXPECT_THAT(refusal_of([] { project_file("nowhere/nothing.yaml"); }), HasSubstr("nowhere/nothing.yaml"));
}

Result sample_result() {
  Result result;
  result.title = "A <title>";
  result.source = "A paper";
  result.setup = {"one thread"};
  result.tables = {{"Table & more", {"what", "value"}, {{"a < b", "1.0"}}, "a note"}};
  result.remarks = {"it differs"};
  result.figures = {{"a", 1.25}};
  return result;
}

TEST(ResultPage, ShowsEverythingAsText) {
  const std::string page = result_page("paper/table", sample_result());
  EXPECT_TRUE(page::begins_as_page(page, page_kind.generator));
  EXPECT_THAT(page, AllOf(HasSubstr("A &lt;title&gt;"), HasSubstr("Table &amp; more"), HasSubstr("<td>a &lt; b</td><td>1.0</td>"),
                          HasSubstr("a note"), HasSubstr("it differs"), HasSubstr("one thread"), HasSubstr("paper/table")));
  // Nothing is loaded from anywhere.
  EXPECT_THAT(page, AllOf(Not(HasSubstr("://")), Not(HasSubstr("src=")), Not(HasSubstr("<script"))));
}

// 0.9 to 1 in two steps of the grid, drawn between 14 and 286 px: 0.95 is in the middle.
TEST(ResultPage, DrawsCurvesWithTheirIntervals) {
  Result result = sample_result();
  result.charts = {{.title = "Curve",
                    .across = "level",
                    .up = "area",
                    .places = {"0", "8 <"},
                    .curves = {{"all", {{0.95, 0.91, 0.99}, {0.92, 0.92, 0.92}}}},
                    .bar = 0.95,
                    .bar_name = "wanted"}};
  const std::string page = result_page("paper/curve", result);
  EXPECT_THAT(page, AllOf(HasSubstr("<h2>Curve</h2>"), HasSubstr(">0.9</text>"), HasSubstr(">1</text>"), HasSubstr("8 &lt;"),
                          HasSubstr("points=\"56,150 610,"), HasSubstr(">wanted</text>"), HasSubstr(">all</text>")));
  EXPECT_THAT(page, HasSubstr("<line class=\"limit\" x1=\"56\" y1=\"150\" x2=\"610\" y2=\"150\"/>"));
  EXPECT_THAT(page, Not(HasSubstr("://")));
  EXPECT_THAT(result_page("paper/table", sample_result()), Not(HasSubstr("<svg")));
}

struct ResultFileTest : ::slipbench::testing::FolderTest {
  std::vector<std::string> write(const std::string& name) const {
    return page::write_page_files(path("r.html"), page_kind, result_page(name, sample_result()),
                                  result_json(name, sample_result()));
  }
};

TEST_F(ResultFileTest, StandsBesideItsFigures) {
  EXPECT_THAT(write("paper/table"), ElementsAre(path("r.html"), path("r.json")));
  const Json json = Json::parse(bytes_of(path("r.json")));
  EXPECT_EQ(json["reproduction"], "paper/table");
  EXPECT_EQ(json["figures"]["a"], 1.25);
  EXPECT_EQ(json["remarks"][0], "it differs");
  EXPECT_EQ(bytes_of(path("r.html")), result_page("paper/table", sample_result()));
  // Its own files are replaced.
  write("paper/other");
  EXPECT_THAT(bytes_of(path("r.json")), HasSubstr("paper/other"));
}

TEST_F(ResultFileTest, OtherFilesAreKept) {
  std::ofstream(path("r.json")) << "{\"mine\": 1}";
  EXPECT_THAT(refusal_of([&] { write("paper/table"); }), HasSubstr("r.json"));
  EXPECT_EQ(bytes_of(path("r.json")), "{\"mine\": 1}");
  EXPECT_THAT(names(), ElementsAre("r.json"));
  EXPECT_THAT(refusal_of([&] { page::check_page_files(path("r.txt"), page_kind); }), mentions({".html"}));
}

}  // namespace

}  // namespace slipbench::reproduce

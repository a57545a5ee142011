#include "tools/reproduce/result.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/core/error.h"
#include "tests/tools/dataset/test_records.h"

namespace slipbench::reproduce {
namespace {

using ::slipbench::testing::bytes_of;
using ::slipbench::testing::message_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_TRUE(begins_as_result_page(page));
  EXPECT_THAT(page, AllOf(HasSubstr("A &lt;title&gt;"), HasSubstr("Table &amp; more"), HasSubstr("<td>a &lt; b</td><td>1.0</td>"),
                          HasSubstr("a note"), HasSubstr("it differs"), HasSubstr("one thread"), HasSubstr("paper/table")));
  // Nothing is loaded from anywhere.
  EXPECT_THAT(page, AllOf(Not(HasSubstr("http")), Not(HasSubstr("src=")), Not(HasSubstr("<script"))));
}

class ResultFileTest : public ::slipbench::testing::FolderTest {};

TEST_F(ResultFileTest, StandsBesideItsFigures) {
  EXPECT_THAT(write_result(path("r.html"), "paper/table", sample_result()), ElementsAre(path("r.html"), path("r.json")));
  const Json json = Json::parse(bytes_of(path("r.json")));
  EXPECT_EQ(json["reproduction"], "paper/table");
  EXPECT_EQ(json["figures"]["a"], 1.25);
  EXPECT_EQ(json["remarks"][0], "it differs");
  EXPECT_EQ(bytes_of(path("r.html")), result_page("paper/table", sample_result()));
  // Its own files are replaced.
  write_result(path("r.html"), "paper/other", sample_result());
  EXPECT_THAT(bytes_of(path("r.json")), HasSubstr("paper/other"));
}

TEST_F(ResultFileTest, OtherFilesAreKept) {
  std::ofstream(path("r.json")) << "{\"mine\": 1}";
  EXPECT_THAT(message_of<InputError>([&] { write_result(path("r.html"), "paper/table", sample_result()); }), HasSubstr("r.json"));
  EXPECT_EQ(bytes_of(path("r.json")), "{\"mine\": 1}");
  EXPECT_THAT(names(), ElementsAre("r.json"));
  EXPECT_THAT(message_of<InputError>([&] { check_result_target(path("r.txt")); }), HasSubstr("a name that ends in .html"));
}

}  // namespace
}  // namespace slipbench::reproduce

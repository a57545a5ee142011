#include "tools/page/page.h"

#include <cmath>
#include <stdexcept>

#include "tests/expect.h"
#include "tests/tools/page/unpack.h"
#include "tests/tools/page/web_files.h"

namespace slipbench::page {
namespace {

using ::slipbench::testing::matches;
using ::slipbench::testing::unpaired_brackets;
using ::slipbench::testing::variables;
using ::slipbench::testing::web_files;

const std::string hostile = "</script><script>alert('x')</script><!-- {{title}} é 漢 \xff";
const std::vector<Asset> files = {
    {"own.css", ".own {}"}, {"own.js", "one();\n//# sourceMappingURL=own.js.map"}, {"own.txt", "free"}};

// U+202E, e2 80 ae in UTF-8, shows "gnp.exe" as "exe.png"; ESC begins a command for a terminal that
// shows the page's source.
TEST(EscapeHtml, ShowsHiddenCharacters) { EXPECT_EQ(escape_html("a\xe2\x80\xae\x1b\tb\nc"), "a\\u202e\\x1b\tb\nc"); }

// A script gets the six characters \u202e as a text, in which JSON doubles the backslash. The tag
// U+E0041 is a pair in UTF-16, d800 + (d0041 >> 10) = db40 and dc00 + 41.
TEST(ComposeDrawnPage, ShowsHiddenCharacters) {
  const std::vector<Asset> files;
  const std::string page = compose_drawn_page({"slipbench", "title"}, files,
                                              {{"name", "a\xe2\x80\xae"}, {"tag", "\xf3\xa0\x81\x81"}, {"letter", "\xc2\xb5\\"}});
  EXPECT_THAT(page, HasSubstr(R"("name":"a\\u202e")"));
  EXPECT_THAT(page, HasSubstr(R"("tag":"\\udb40\\udc41")"));
  EXPECT_THAT(page, HasSubstr(R"("letter":"\u00b5\\")"));
}

TEST(EscapeHtml, LeavesNoMarkup) { EXPECT_EQ(escape_html("<b a='1' c=\"2\">&"), "&lt;b a=&#39;1&#39; c=&quot;2&quot;&gt;&amp;"); }

TEST(DrawnPage, DataCannotEndItsElement) {
  const std::string page = compose_drawn_page({"slipbench", hostile}, files, {{"description", hostile}});
  EXPECT_THAT(page, AllOf(Not(HasSubstr("<script>alert")), Not(HasSubstr("<!-- ")), HasSubstr("<title>&lt;/script&gt;"),
                          HasSubstr("{{title}}")));
  const std::string begin = "id=\"slipbench-data\">";
  const std::size_t from = page.find(begin) + begin.size();
  // The browser reads the data that was put in; the byte that is not UTF-8 becomes the replacement
  // character.
  EXPECT_EQ(Json::parse(page.substr(from, page.find("</script>", from) - from)).at("description"),
            "</script><script>alert('x')</script><!-- {{title}} é 漢 \xef\xbf\xbd");
}

// Data that may be read later follows the scripts and also cannot end its element.
TEST(DrawnPage, FurtherDataFollowsTheScripts) {
  const std::string page =
      compose_drawn_page({"slipbench", "title"}, files, Json::object(), {{"later-1", {{"text", hostile}}}, {"later-2", 7}});
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  const std::size_t first = page.find("<script type=\"application/json\" id=\"later-1\">"), scripts = page.find("one();");
  ASSERT_NE(first, std::string::npos);
  EXPECT_LT(scripts, first);
  EXPECT_THAT(page.substr(first), HasSubstr("<script type=\"application/json\" id=\"later-2\">7</script>"));
}

// A page allows exactly its own style and script, by their content.
TEST(DrawnPage, CarriesAPolicy) {
  const std::string page = compose_drawn_page({"slipbench", "title"}, files, Json::object());
  const std::string mark = "<meta http-equiv=\"Content-Security-Policy\" content=\"";
  const std::size_t from = page.find(mark);
  ASSERT_NE(from, std::string::npos);
  EXPECT_LT(from, page.find("<style>"));
  const std::string policy = page.substr(from + mark.size(), page.find('"', from + mark.size()) - from - mark.size());
  const std::string hash = "'sha256-[A-Za-z0-9+/]{43}='";
  EXPECT_TRUE(std::regex_match(
      policy, std::regex("default-src 'none'; style-src-elem " + hash + "; style-src-attr 'unsafe-inline'; script-src " + hash +
                         "; img-src data:; base-uri 'none'; form-action 'none'")))
      << policy;
  EXPECT_THAT(compose_page({"slipbench", "title"}, "<p>text</p>"),
              AllOf(Not(HasSubstr("script-src")), Not(HasSubstr("unsafe-inline"))));
}

TEST(DrawnPage, LoadsNothing) {
  const std::string page = compose_drawn_page({"slipbench", "title"}, files, Json::object());
  // Elements and styles that would fetch something.
  EXPECT_FALSE(std::regex_search(page, std::regex(R"((src|href)\s*=\s*["']?(https?:)?//)")));
  EXPECT_FALSE(std::regex_search(page, std::regex(R"(url\(\s*["']?(https?:)?//)")));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("@import")), Not(HasSubstr("<link rel=\"stylesheet\"")), Not(HasSubstr("<script src")),
                          Not(HasSubstr("sourceMappingURL"))));
}

TEST(DrawnPage, HoldsItsFilesAfterTheKits) {
  const std::string page = compose_drawn_page({"slipbench", "title"}, files, Json::object());
  for (const auto& [before, after] :
       {std::pair{"theme.css", "page.css"}, {"page.css", "own.css"}, {"d3.min.js", "common.js"}, {"common.js", "own.js"}}) {
    const auto place = [&](std::string_view name) {
      const std::vector<Asset>& owner = name.starts_with("own") ? files : assets();
      return page.find(embedded(owner, name));
    };
    ASSERT_NE(place(after), std::string::npos) << after;
    EXPECT_LT(place(before), place(after)) << before;
  }
  EXPECT_THAT(page, AllOf(HasSubstr(embedded(assets(), "d3_licence.txt")), HasSubstr("one();\n"), HasSubstr("\nfree\n")));
  EXPECT_THROW(static_cast<void>(embedded(files, "other.js")), std::logic_error);
}

TEST(Page, IsKnownByItsGenerator) {
  // Recognised by its first 4 kB, for any title.
  const std::string page = compose_page({"slipbench cost", std::string(8000, 'x')}, "").substr(0, 4096);
  EXPECT_TRUE(begins_as_page(page, "slipbench cost"));
  EXPECT_FALSE(begins_as_page(page, "slipbench"));
  EXPECT_FALSE(begins_as_page("x" + page, "slipbench cost"));
  EXPECT_FALSE(begins_as_page("<!DOCTYPE html>", "slipbench cost"));
}

TEST(Page, NeedsNoScript) {
  const std::string page = compose_page({"slipbench", hostile}, "<p>{{body}}</p>");
  EXPECT_THAT(page,
              AllOf(HasSubstr("<p>{{body}}</p>"), Not(HasSubstr("<script")), Not(HasSubstr("http:")), Not(HasSubstr("https:"))));
}

TEST(Page, TablesAndListsAreText) {
  EXPECT_EQ(
      table_html({{"a & b"}, {{"<c>"}}}),
      "<div class=\"scroll\"><table class=\"plain\">\n<thead><tr><th>a &amp; b</th></tr>\n</thead>\n<tbody>\n<tr><td>&lt;c&gt;</td></tr>\n</tbody></table></div>\n");
  EXPECT_EQ(list_html({"<c>", "d"}), "<ul class=\"plain\">\n<li>&lt;c&gt;</li>\n<li>d</li>\n</ul>\n");
}

// Every file of the folder is embedded: CMakeLists.txt lists all.
TEST(Kit, LeavesNoFileOut) {
  for (const char* extension : {".js", ".css", ".html", ".txt"}) {
    for (const auto& [name, text] : web_files("tools/page/web", extension)) EXPECT_EQ(embedded(assets(), name), text);
  }
}

TEST(Kit, HasEveryColourInBothThemes) {
  const auto styles = web_files("tools/page/web", ".css");
  const std::set<std::string> light = variables(styles.at("theme.css"), ":root");
  const std::string& theme = styles.at("theme.css");
  EXPECT_EQ(light, variables(theme.substr(theme.find("@media")), ":root"));
  for (const auto& [name, text] : styles) {
    for (const std::string& variable : matches(text, R"(var\(--(\w+)\))"))
      EXPECT_TRUE(light.contains(variable)) << name << " " << variable;
  }
  for (const auto& [name, text] : web_files("tools/page/web", ".js")) EXPECT_EQ(unpaired_brackets(text), "") << name;
}

std::string base64_of(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// The test vectors of RFC 4648, section 10.
TEST(Base64, FollowsTheStandard) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
}

TEST(PackCurves, KeepsEveryValueToHalfAStep) {
  // Two columns; the differences between extremes wrap around 16 bits.
  const std::vector<float> values = {-8.0F, 0.001F, 8.0F, 0.002F, -8.0F, -3.0F, 0.0F, 7.999F};
  const Json packed = pack_curves(values, 2, 1);
  EXPECT_DOUBLE_EQ(packed.at("step").get<double>(), 8.0 / 32767.0);
  const auto columns = unpack(packed);
  ASSERT_EQ(columns.size(), 2U);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 2; ++column) {
      // Half a step, plus the rounding of the product itself.
      EXPECT_NEAR(columns[column][row], values[2 * row + column], 0.5 * 8.0 / 32767.0 + 1e-12);
    }
  }
}

TEST(PackCurves, MarksWhatIsNotFinite) {
  const float infinity = std::numeric_limits<float>::infinity();
  const auto columns = unpack(pack_curves(std::vector<float>{1.0F, std::nanf(""), infinity, -infinity, -1.0F}, 1, 1));
  EXPECT_DOUBLE_EQ(columns[0][0], 1.0);
  EXPECT_TRUE(std::isnan(columns[0][1]));
  EXPECT_TRUE(std::isnan(columns[0][2]));
  EXPECT_TRUE(std::isnan(columns[0][3]));
  EXPECT_DOUBLE_EQ(columns[0][4], -1.0);
}

TEST(PackCurves, ZerosStayZero) {
  EXPECT_THAT(unpack(pack_curves(std::vector<float>{0.0F, 0.0F}, 1, 1))[0], ElementsAre(0.0, 0.0));
}

TEST(PackCurves, ThinsFromTheFirstRow) {
  const auto columns = unpack(pack_curves(std::vector<float>{0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 32767.0F}, 1, 3));
  EXPECT_THAT(columns[0], ElementsAre(0.0, 3.0, 32767.0));  // rows 0, 3 and 6; the step is 1
}

TEST(PackBytes, LosesNothing) {
  const auto columns = unpack(pack_bytes(std::vector<std::uint8_t>{0, 3, 1, 2, 255, 0}, 2));
  EXPECT_THAT(columns[0], ElementsAre(0, 1, 255));
  EXPECT_THAT(columns[1], ElementsAre(3, 2, 0));
}

TEST(PackTimes, KeepsMicroseconds) {
  const auto columns = unpack(pack_times(std::vector<double>{-0.5, 0.0, 1e-3, 1799.999999}));
  EXPECT_NEAR(columns[0][0], -0.5, 1e-12);
  EXPECT_NEAR(columns[0][2], 1e-3, 1e-12);
  EXPECT_NEAR(columns[0][3], 1799.999999, 1e-9);
}

TEST(PackTimes, ReachesAnyLength) {
  // 2^31 - 1 steps reach 5000 s, so that a step is 2.33 us.
  const auto columns = unpack(pack_times(std::vector<double>{0.0, 2500.0, 5000.0}));
  EXPECT_EQ(columns[0][0], 0.0);
  EXPECT_NEAR(columns[0][1], 2500.0, 0.5 * 2.33e-6);
  EXPECT_NEAR(columns[0][2], 5000.0, 0.5 * 2.33e-6);
}

}  // namespace
}  // namespace slipbench::page

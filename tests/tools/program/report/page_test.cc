#include "tools/program/report/page.h"

#include <algorithm>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program/report/sample.h"
#include "tools/program/report/assets.h"

namespace slipbench::report {
namespace {

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from) + from.size();
  return text.substr(begin, text.find(to, begin) - begin);
}

TEST(EscapeHtml, LeavesNoMarkup) { EXPECT_EQ(escape_html("<b a='1' c=\"2\">&"), "&lt;b a=&#39;1&#39; c=&quot;2&quot;&gt;&amp;"); }

TEST(ComposePage, DataCannotEndItsElement) {
  const std::string hostile = "</script><script>alert('x')</script><!-- {{title}} é 漢 \xff";
  const std::string page = compose_page(hostile, {{"description", hostile}});
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("<!-- "), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;/script&gt;"), std::string::npos);
  const std::string data = between(page, "id=\"slipbench-data\">", "</script>");
  // What a browser reads is what was put in; the byte that is no UTF-8 becomes the replacement character.
  EXPECT_EQ(Json::parse(data).at("description"), "</script><script>alert('x')</script><!-- {{title}} é 漢 \xef\xbf\xbd");
}

TEST(ComposePage, LoadsNothing) {
  const std::string page = compose_page("title", Json::object());
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  // Elements and styles that would fetch.
  EXPECT_FALSE(std::regex_search(page, std::regex(R"((src|href)\s*=\s*["']?(https?:)?//)")));
  EXPECT_FALSE(std::regex_search(page, std::regex(R"(url\(\s*["']?(https?:)?//)")));
  for (const char* text : {"@import", "<link rel=\"stylesheet\"", "<script src", "sourceMappingURL"}) {
    EXPECT_EQ(page.find(text), std::string::npos) << text;
  }
}

TEST(ComposePage, HoldsEveryEmbeddedFile) {
  const std::string page = compose_page("title", {{"grasps", Json::object()}});
  std::size_t scripts = 0;
  for (const Asset& asset : assets()) {
    if (asset.name == "report.html") continue;
    EXPECT_FALSE(asset.text.empty()) << asset.name;
    // In full, but for the last line where that points to a source map.
    const std::size_t pointer = asset.text.find("\n//# sourceMappingURL=");
    const std::size_t comment = asset.text.find("\n/*# sourceMappingURL=");
    const std::string kept(asset.text.substr(0, std::min(pointer, comment)));
    EXPECT_NE(page.find(kept + "\n"), std::string::npos) << asset.name;
    scripts += asset.name.ends_with(".js") ? 1 : 0;
  }
  EXPECT_GE(scripts, 13U);  // two libraries and eleven of our own
}

}  // namespace
}  // namespace slipbench::report

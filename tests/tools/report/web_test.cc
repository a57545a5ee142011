// What can be checked of the scripts and styles without a browser.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/report/sample.h"

namespace slipbench::report {
namespace {

std::map<std::string, std::string> web_files(const std::string& extension) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(SLIPBENCH_SOURCE_DIR "/tools/report/web")) {
    if (entry.path().extension() == extension) files[entry.path().filename().string()] = read_text(entry.path().string());
  }
  return files;
}

// First groups of all matches.
std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), regex); it != std::sregex_iterator(); ++it)
    found.insert((*it)[1]);
  return found;
}

TEST(Scripts, UseOnlyWhatSomeScriptDefines) {
  std::set<std::string> defined;
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

// Brackets outside of strings, comments and regular expressions pair up.
TEST(Scripts, HaveBalancedBrackets) {
  for (const auto& [name, text] : web_files(".js")) {
    const std::string code =
        std::regex_replace(text, std::regex(R"(//[^\n]*|'(?:\\.|[^'\\\n])*'|"(?:\\.|[^"\\\n])*"|`[^`]*`|/\^[^\n]*?/\.exec)"), "");
    std::string open;
    for (const char c : code) {
      const std::size_t kind = std::string("([{)]}").find(c);
      if (kind == std::string::npos) continue;
      if (kind < 3) {
        open += c;
      } else {
        ASSERT_FALSE(open.empty()) << name << ": a bracket too many";
        ASSERT_EQ(open.back(), "([{"[kind - 3]) << name;
        open.pop_back();
      }
    }
    EXPECT_TRUE(open.empty()) << name << " leaves open: " << open;
  }
}

// A pad whose X points up, Y to the right and Z away from the reader is seen from the side that it touches.
TEST(Scripts, SayFromWhereThePadIsSeen) {
  for (const auto& [name, text] : web_files(".js")) EXPECT_EQ(text.find("from above"), std::string::npos) << name;
}

// A swept value that is infinite has no place on a scale: each picture and table of the overview gives it one of its own.
TEST(Scripts, ShowEndlessValues) {
  const std::string text = web_files(".js").at("dataset.js");
  for (const char* name : {"swept", "encoding", "scatter", "table"}) {
    const std::size_t begin = text.find(std::string("\nfunction ") + name + "(");
    ASSERT_NE(begin, std::string::npos) << name;
    const std::string body = text.substr(begin, text.find("\n}\n", begin) - begin);
    EXPECT_NE(body.find("endless(axis, trial)"), std::string::npos) << name;
    EXPECT_NE(body.find("sb.endless(axis.unit)"), std::string::npos) << name;
  }
}

TEST(Styles, DefineEveryColourInBothThemes) {
  const std::string css = web_files(".css").at("report.css");
  const auto block = [&](const std::string& selector) {
    const std::size_t begin = css.find(selector + " {");
    return matches(css.substr(begin, css.find('}', begin) - begin), R"(--(\w+):)");
  };
  const std::set<std::string> light = block(":root");
  std::set<std::string> dark = block(":root[data-theme=\"dark\"]");
  dark.insert("mono");  // a font
  EXPECT_EQ(light, dark);
  std::string all = css;
  for (const auto& [name, text] : web_files(".js")) all += text;
  for (const std::string& variable : matches(all, R"(var\(--(\w+)\))")) EXPECT_TRUE(light.contains(variable)) << variable;
  for (const std::string& variable : matches(all, R"(colour\('(\w+)'\))")) EXPECT_TRUE(light.contains(variable)) << variable;
}

}  // namespace
}  // namespace slipbench::report

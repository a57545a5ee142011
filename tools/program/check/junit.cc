#include "tools/program/check/check.h"

#include <string_view>

#include <fmt/format.h>

#include "tools/base/page/page.h"

namespace slipbench {
namespace {

// XML 1.0 has no place for control characters but these, escaped or not. Bytes beyond ASCII are left: scenes and paths are UTF-8.
bool allowed_in_xml(char c) { return static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n' || c == '\r'; }

// Text inside double quotes. A line end or a tab that is not escaped is read as a space.
std::string attribute(std::string_view text) {
  std::string result;
  for (const char c : page::escape_html(text)) {
    if (c == '\n' || c == '\r' || c == '\t') {
      result += fmt::format("&#{};", int{c});
    } else {
      result += allowed_in_xml(c) ? c : '?';
    }
  }
  return result;
}

// A section of text as it is. What would end it is divided between two.
std::string cdata(std::string_view text) {
  std::string result = "<![CDATA[";
  for (const char c : text) {
    if (c == '>' && result.ends_with("]]")) result += "]]><![CDATA[";
    result += allowed_in_xml(c) ? c : '?';
  }
  return result + "]]>";
}

// `message`: empty for a case that passed.
std::string test_case(const std::string& suite, const std::string& name, const std::string& message, const std::string& text) {
  const std::string head = fmt::format("    <testcase classname=\"{}\" name=\"{}\"", attribute(suite), attribute(name));
  if (message.empty()) return head + "/>\n";
  return fmt::format("{}>\n      <failure message=\"{}\" type=\"expectation\">{}</failure>\n    </testcase>\n", head,
                     attribute(message), cdata(text));
}

struct Suite {
  std::size_t tests = 0;
  std::size_t failures = 0;
  std::size_t skipped = 0;
  std::string cases;
};

Suite suite_of(const SceneCheck& check) {
  Suite suite;
  const std::string& name = check.scene_path;
  if (check.verdict == Verdict::not_checked) {
    suite.cases = fmt::format(
        "    <testcase classname=\"{}\" name=\"expect\">\n      <skipped message=\"the scene expects nothing\"/>\n"
        "    </testcase>\n",
        attribute(name));
    suite.tests = suite.skipped = 1;
    return suite;
  }
  for (const ExpectationResult& result : check.expectations) {
    ++suite.tests;
    std::string message;
    std::string text;
    if (!result.passed()) {
      ++suite.failures;
      message = failure_text(result);
      text = message + "\nreplay: " + result.replay;
      for (const std::string& failure : check.failures) text += "\n" + failure;
      for (const std::string& file : check.files) text += "\nleft: " + file;
    }
    suite.cases += test_case(name, result.name, message, text);
  }
  if (!check.control.empty()) {
    ++suite.tests;
    const bool nothing = check.verdict == Verdict::tests_nothing;
    if (nothing) ++suite.failures;
    suite.cases += test_case(name, "negative_control", nothing ? "tests nothing" : "", tests_nothing_text(check));
  }
  return suite;
}

}  // namespace

std::string junit_xml(const std::vector<SceneCheck>& checks) {
  Suite all;
  for (const SceneCheck& check : checks) {
    const Suite suite = suite_of(check);
    all.tests += suite.tests;
    all.failures += suite.failures;
    all.skipped += suite.skipped;
    all.cases +=
        fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">\n{}  </testsuite>\n",
                    attribute(check.scene_path), suite.tests, suite.failures, suite.skipped, suite.cases);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"slipbench check\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">\n{}</testsuites>\n",
      all.tests, all.failures, all.skipped, all.cases);
}

}  // namespace slipbench

// Checks of a page's scripts and styles without a browser.
#pragma once

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "tests/files.h"

namespace slipbench::testing {

// Returns the files of a project folder by name: web_files("tools/report/web", ".js").
inline std::map<std::string, std::string> web_files(const std::string& folder, const std::string& extension) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(SLIPBENCH_SOURCE_DIR "/") + folder)) {
    if (entry.path().extension() != extension) continue;
    files[entry.path().filename().string()] = bytes_of(entry.path());
  }
  return files;
}

// Returns the first groups of all matches.
inline std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), regex); it != std::sregex_iterator(); ++it)
    found.insert((*it)[1]);
  return found;
}

// Returns what is wrong with the brackets outside strings, comments and regular expressions; "" if
// they pair up.
inline std::string unpaired_brackets(const std::string& script) {
  const std::string code =
      std::regex_replace(script, std::regex(R"(//[^\n]*|'(?:\\.|[^'\\\n])*'|"(?:\\.|[^"\\\n])*"|`[^`]*`|/\^[^\n]*?/\.exec)"), "");
  std::string open;
  for (const char c : code) {
    const std::size_t kind = std::string("([{)]}").find(c);
    if (kind == std::string::npos) continue;
    if (kind < 3) {
      open += c;
      continue;
    }
    if (open.empty() || open.back() != "([{"[kind - 3]) return std::string("unexpected ") + c + " after open: " + open;
    open.pop_back();
  }
  return open.empty() ? "" : "left open: " + open;
}

// Returns the colours and other variables set by a rule of a style sheet: ":root".
inline std::set<std::string> variables(const std::string& css, const std::string& selector) {
  const std::size_t begin = css.find(selector + " {");
  return begin == std::string::npos ? std::set<std::string>()
                                    : matches(css.substr(begin, css.find('}', begin) - begin), R"(--(\w+):)");
}

}  // namespace slipbench::testing

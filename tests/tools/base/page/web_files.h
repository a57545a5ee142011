// What can be checked of a page's scripts and styles without a browser.
#pragma once

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "tests/files.h"

namespace slipbench::testing {

// The files of a folder of the project by name: web_files("tools/program/report/web", ".js").
inline std::map<std::string, std::string> web_files(const std::string& folder, const std::string& extension) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(SLIPBENCH_SOURCE_DIR "/") + folder)) {
    if (entry.path().extension() != extension) continue;
    files[entry.path().filename().string()] = bytes_of(entry.path());
  }
  return files;
}

// First groups of all matches.
inline std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), regex); it != std::sregex_iterator(); ++it)
    found.insert((*it)[1]);
  return found;
}

// What is wrong with the brackets outside of strings, comments and regular expressions; "" where they pair up.
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

// The colours and other variables that a style sheet sets in one of its rules: ":root".
inline std::set<std::string> variables(const std::string& css, const std::string& selector) {
  const std::size_t begin = css.find(selector + " {");
  return begin == std::string::npos ? std::set<std::string>()
                                    : matches(css.substr(begin, css.find('}', begin) - begin), R"(--(\w+):)");
}

}  // namespace slipbench::testing

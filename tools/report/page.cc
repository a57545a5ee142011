#include "tools/report/page.h"

#include <stdexcept>
#include <string_view>

#include "tools/report/assets.h"

namespace slipbench::report {

namespace {

std::string_view asset(std::string_view name) {
  for (const Asset& candidate : assets()) {
    if (candidate.name == name) return candidate.text;
  }
  throw std::logic_error("the report has no embedded file " + std::string(name));
}

// All embedded files of one kind, in order, without the libraries' pointers to their source maps, which a browser would fetch. What draws a
// grasp, "grasp_...", is there only with `grasps`.
std::string joined(std::string_view extension, bool grasps) {
  constexpr std::string_view pointer = "# sourceMappingURL=";
  std::string text;
  for (const Asset& candidate : assets()) {
    if (!candidate.name.ends_with(extension) || (!grasps && candidate.name.starts_with("grasp_"))) continue;
    const std::size_t found = candidate.text.find(pointer);
    // The comment that holds it is the file's last line.
    text += candidate.text.substr(0, found == std::string_view::npos ? found : candidate.text.rfind('\n', found));
    text += '\n';
  }
  return text;
}

std::string script_json(const Json& data) {
  const std::string plain = data.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(plain.size());
  for (const char c : plain) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace

bool begins_as_page(std::string_view text) {
  return text.starts_with("<!DOCTYPE html>") &&
         text.find(R"(<meta name="generator" content="slipbench">)") != std::string_view::npos;
}

std::string escape_html(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&': safe += "&amp;"; break;
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      case '"': safe += "&quot;"; break;
      case '\'': safe += "&#39;"; break;
      default: safe += c;
    }
  }
  return safe;
}

std::string compose_page(const std::string& title, const Json& data) {
  const bool grasps = data.contains("grasps");
  std::string_view rest = asset("report.html");
  std::string page;
  // Markers {{name}} are replaced in one pass, so that no inserted text is searched again.
  while (true) {
    const std::size_t open = rest.find("{{");
    page += rest.substr(0, open);
    if (open == std::string_view::npos) return page;
    const std::size_t close = rest.find("}}", open);
    const std::string_view marker = rest.substr(open + 2, close - open - 2);
    if (marker == "title") {
      page += escape_html(title);
    } else if (marker == "styles") {
      page += joined(".css", grasps);
    } else if (marker == "scripts") {
      page += joined(".js", grasps);
    } else if (marker == "licences") {
      page += asset("licences.txt");
    } else if (marker == "data") {
      page += script_json(data);
    } else {
      throw std::logic_error("report.html has an unknown marker " + std::string(marker));
    }
    rest.remove_prefix(close + 2);
  }
}

}  // namespace slipbench::report

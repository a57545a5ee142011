#include "tools/program/report/page.h"

#include <algorithm>
#include <stdexcept>

namespace slipbench::report {

namespace {

// All embedded files of one kind, in order. What draws a grasp, "grasp_...", is there only with `grasps`.
std::string joined(std::string_view extension, bool grasps) {
  std::string text;
  for (const Asset& candidate : assets()) {
    if (!candidate.name.ends_with(extension) || (!grasps && candidate.name.starts_with("grasp_"))) continue;
    text += embedded(assets(), candidate.name);
    text += '\n';
  }
  return text;
}

}  // namespace

std::string_view embedded(const std::vector<Asset>& files, std::string_view name) {
  const auto found = std::find_if(files.begin(), files.end(), [&](const Asset& file) { return file.name == name; });
  if (found == files.end()) throw std::logic_error("no embedded file " + std::string(name));
  const std::size_t pointer = found->text.find("# sourceMappingURL=");
  // The comment that holds it is the file's last line.
  return found->text.substr(0, pointer == std::string_view::npos ? pointer : found->text.rfind('\n', pointer));
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

std::string fill_page(std::string_view html, const std::vector<PagePart>& parts) {
  std::string page;
  while (true) {
    const std::size_t open = html.find("{{");
    page += html.substr(0, open);
    if (open == std::string_view::npos) return page;
    const std::size_t close = html.find("}}", open);
    const std::string_view marker = html.substr(open + 2, close - open - 2);
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const PagePart& candidate) { return candidate.marker == marker; });
    if (part == parts.end()) throw std::logic_error("a page has an unknown marker " + std::string(marker));
    page += part->text;
    html.remove_prefix(close + 2);
  }
}

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
  return fill_page(embedded(assets(), "report.html"), {{"title", escape_html(title)},
                                                       {"styles", joined(".css", grasps)},
                                                       {"scripts", joined(".js", grasps)},
                                                       {"licences", joined(".txt", grasps)},
                                                       {"data", script_json(data)}});
}

}  // namespace slipbench::report

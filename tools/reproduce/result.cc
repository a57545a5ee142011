#include "tools/reproduce/result.h"

#include <filesystem>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/dataset/output_file.h"
#include "tools/report/page.h"

namespace slipbench::reproduce {
namespace {

using report::escape_html;

constexpr std::string_view page_head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="slipbench reproduce">
)";

constexpr std::string_view style = R"(<style>
:root { color-scheme: light dark; --ground: #fff; --ink: #1b1f24; --soft: #5b6570; --line: #dde1e6; --row: #f7f8f9; }
@media (prefers-color-scheme: dark) { :root { --ground: #14171a; --ink: #e6e9ec; --soft: #a3adb7; --line: #30363c; --row: #1b1f23; } }
body { margin: 0 auto; max-width: 1120px; padding: 28px; background: var(--ground); color: var(--ink);
  font: 14px/1.5 system-ui, "Segoe UI", Arial, "DejaVu Sans", sans-serif; }
h1 { font-size: 24px; font-weight: 620; margin: 0 0 4px; }
h2 { font-size: 16px; font-weight: 620; margin: 30px 0 8px; }
p, li { max-width: 92ch; margin: 4px 0; }
.soft { color: var(--soft); font-size: 12.5px; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; }
th, td { text-align: right; padding: 5px 12px 5px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { color: var(--soft); font-weight: 550; vertical-align: bottom; }
td { white-space: nowrap; }
th:first-child, td:first-child { text-align: left; white-space: normal; }
tbody tr:hover { background: var(--row); }
@media print { body { max-width: none; padding: 0; } }
</style>
)";

template <class Out>
void append_table(Out out, const ResultTable& table) {
  fmt::format_to(out, "<h2>{}</h2>\n<div class=\"wide\"><table>\n<thead><tr>", escape_html(table.title));
  for (const std::string& cell : table.head) fmt::format_to(out, "<th>{}</th>", escape_html(cell));
  fmt::format_to(out, "</tr></thead>\n<tbody>\n");
  for (const std::vector<std::string>& row : table.rows) {
    fmt::format_to(out, "<tr>");
    for (const std::string& cell : row) fmt::format_to(out, "<td>{}</td>", escape_html(cell));
    fmt::format_to(out, "</tr>\n");
  }
  fmt::format_to(out, "</tbody></table></div>\n");
  if (!table.note.empty()) fmt::format_to(out, "<p class=\"soft\">{}</p>\n", escape_html(table.note));
}

template <class Out>
void append_list(Out out, const std::string& title, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  fmt::format_to(out, "<h2>{}</h2>\n<ul>\n", title);
  for (const std::string& line : lines) fmt::format_to(out, "<li>{}</li>\n", escape_html(line));
  fmt::format_to(out, "</ul>\n");
}

std::string json_path(const std::string& html_path) {
  return std::filesystem::path(html_path).replace_extension(".json").string();
}

}  // namespace

Json result_json(const std::string& name, const Result& result) {
  return {{"reproduction", name},  {"title", result.title},     {"source", result.source},
          {"setup", result.setup}, {"figures", result.figures}, {"remarks", result.remarks}};
}

std::string result_page(const std::string& name, const Result& result) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}<title>{}</title>\n{}</head>\n<body>\n<h1>{}</h1>\n", page_head, escape_html(name), style,
                 escape_html(result.title));
  fmt::format_to(out, "<p class=\"soft\">slipbench reproduce {}</p>\n<p>{}</p>\n", escape_html(name), escape_html(result.source));
  for (const ResultTable& table : result.tables) append_table(out, table);
  append_list(out, "What differs, and why", result.remarks);
  append_list(out, "How it was measured", result.setup);
  fmt::format_to(out, "</body>\n</html>\n");
  return fmt::to_string(text);
}

bool begins_as_result_page(std::string_view text) { return text.starts_with(page_head); }
bool begins_as_result_json(std::string_view text) { return text.starts_with("{\n  \"reproduction\": "); }

void check_result_target(const std::string& html_path) {
  if (!html_path.ends_with(".html")) {
    throw InputError(
        fmt::format("-o {}: a result is a page with its figures beside it; allowed: a name that ends in .html", html_path));
  }
  check_text_target(html_path, {}, {"result page", &begins_as_result_page});
  check_text_target(json_path(html_path), {}, {"result of a reproduction", &begins_as_result_json});
}

std::vector<std::string> write_result(const std::string& html_path, const std::string& name, const Result& result) {
  check_result_target(html_path);
  write_text_file(html_path, result_page(name, result));
  write_text_file(json_path(html_path), result_json(name, result).dump(2) + "\n");
  return {html_path, json_path(html_path)};
}

}  // namespace slipbench::reproduce

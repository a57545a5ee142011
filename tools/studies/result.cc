#include "tools/studies/result.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "tools/program/report/page.h"
#include "tools/program/report/page_files.h"

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
.chart text { fill: var(--soft); font-size: 12px; }
.chart .middle { text-anchor: middle; }
.chart .end { text-anchor: end; }
.chart line, .chart .way { fill: none; stroke-width: 1.6; }
.chart .mesh { stroke: var(--line); stroke-width: 1; }
.chart .bar { stroke: var(--soft); stroke-dasharray: 5 4; }
.c0 { stroke: #2a6fbb; } .c1 { stroke: #c2571a; } .c2 { stroke: #2e8b57; }
.c0.dot { fill: #2a6fbb; } .c1.dot { fill: #c2571a; } .c2.dot { fill: #2e8b57; }
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

// Where a chart's places and values are drawn [px].
struct ChartFrame {
  static constexpr double width = 760.0, height = 330.0, left = 56.0, right = 150.0, top = 14.0, bottom = 44.0;
  std::size_t places;
  double low, high;  // of the values

  [[nodiscard]] double x(std::size_t place) const {
    return left + (width - left - right) * static_cast<double>(place) / static_cast<double>(places - 1);
  }
  [[nodiscard]] double y(double value) const { return top + (height - top - bottom) * (high - value) / (high - low); }
};

template <class Out>
void append_curve(Out out, const ChartFrame& frame, const ResultCurve& curve, std::size_t colour) {
  std::string line;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const ResultPoint& point = curve.points[i];
    line += fmt::format("{}{:.1f},{:.1f}", i == 0 ? "" : " ", frame.x(i), frame.y(point.value));
    fmt::format_to(out, "<line class=\"c{0}\" x1=\"{1:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{3:.1f}\"/>", colour, frame.x(i),
                   frame.y(point.low), frame.y(point.high));
    fmt::format_to(out, "<circle class=\"c{} dot\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>\n", colour, frame.x(i),
                   frame.y(point.value));
  }
  fmt::format_to(out, "<polyline class=\"c{} way\" points=\"{}\"/>\n", colour, line);
}

template <class Out>
void append_chart(Out out, const ResultChart& chart) {
  constexpr double step = 0.05;  // between two lines of the grid
  double low = chart.bar, high = chart.bar;
  for (const ResultCurve& curve : chart.curves) {
    for (const ResultPoint& point : curve.points) {
      low = std::min(low, point.low);
      high = std::max(high, point.high);
    }
  }
  const int first = static_cast<int>(std::floor(low / step)), last = static_cast<int>(std::ceil(high / step));
  const ChartFrame frame{chart.places.size(), step * first, step * std::max(last, first + 1)};
  const double end = ChartFrame::width - ChartFrame::right, foot = ChartFrame::height - ChartFrame::bottom;
  fmt::format_to(out, "<h2>{}</h2>\n<div class=\"wide\"><svg class=\"chart\" width=\"{}\" height=\"{}\" role=\"img\">\n",
                 escape_html(chart.title), ChartFrame::width, ChartFrame::height);
  for (int k = first; k <= last; ++k) {
    const double y = frame.y(step * k);
    fmt::format_to(out, "<line class=\"mesh\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", ChartFrame::left, end, y, y);
    fmt::format_to(out, "<text class=\"end\" x=\"{}\" y=\"{:.1f}\">{:.2f}</text>\n", ChartFrame::left - 8.0, y + 4.0, step * k);
  }
  for (std::size_t i = 0; i < chart.places.size(); ++i) {
    fmt::format_to(out, "<text class=\"middle\" x=\"{:.1f}\" y=\"{}\">{}</text>\n", frame.x(i), foot + 18.0,
                   escape_html(chart.places[i]));
  }
  fmt::format_to(out, "<text class=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n", 0.5 * (ChartFrame::left + end), foot + 38.0,
                 escape_html(chart.across));
  fmt::format_to(out, "<text class=\"middle\" transform=\"translate(12,{}) rotate(-90)\">{}</text>\n",
                 0.5 * (ChartFrame::top + foot), escape_html(chart.up));
  fmt::format_to(out, "<line class=\"bar\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>\n", ChartFrame::left, end,
                 frame.y(chart.bar), frame.y(chart.bar));
  for (std::size_t i = 0; i < chart.curves.size(); ++i) append_curve(out, frame, chart.curves[i], i % 3);
  const auto legend = [&](std::size_t row, const std::string& mark, const std::string& name) {
    const double y = ChartFrame::top + 12.0 + 20.0 * static_cast<double>(row);
    fmt::format_to(out, "<line class=\"{}\" x1=\"{}\" x2=\"{}\" y1=\"{}\" y2=\"{}\"/><text x=\"{}\" y=\"{}\">{}</text>\n", mark,
                   end + 14.0, end + 36.0, y, y, end + 42.0, y + 4.0, escape_html(name));
  };
  for (std::size_t i = 0; i < chart.curves.size(); ++i) legend(i, fmt::format("c{} way", i % 3), chart.curves[i].name);
  legend(chart.curves.size(), "bar", chart.bar_name);
  fmt::format_to(out, "</svg></div>\n");
}

template <class Out>
void append_list(Out out, const std::string& title, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  fmt::format_to(out, "<h2>{}</h2>\n<ul>\n", title);
  for (const std::string& line : lines) fmt::format_to(out, "<li>{}</li>\n", escape_html(line));
  fmt::format_to(out, "</ul>\n");
}

constexpr report::PageKind kind{
    "a result", {"result page", &begins_as_result_page}, {"result of a reproduction", &begins_as_result_json}};

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
  for (const ResultChart& chart : result.charts) append_chart(out, chart);
  for (const ResultTable& table : result.tables) append_table(out, table);
  append_list(out, "What differs, and why", result.remarks);
  append_list(out, "How it was measured", result.setup);
  fmt::format_to(out, "</body>\n</html>\n");
  return fmt::to_string(text);
}

bool begins_as_result_page(std::string_view text) { return text.starts_with(page_head); }
bool begins_as_result_json(std::string_view text) { return text.starts_with("{\n  \"reproduction\": "); }

void check_result_target(const std::string& html_path) { report::check_page_files(html_path, kind); }

std::vector<std::string> write_result(const std::string& html_path, const std::string& name, const Result& result) {
  return report::write_page_files(html_path, kind, result_page(name, result), result_json(name, result));
}

}  // namespace slipbench::reproduce

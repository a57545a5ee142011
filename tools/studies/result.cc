#include "tools/studies/result.h"

#include <array>
#include <string_view>

#include <fmt/format.h>

#include "tools/base/page/svg.h"

namespace slipbench::reproduce {
namespace {

// Where a chart stands in its drawing [px].
constexpr double chart_width = 760.0, chart_height = 330.0, left = 56.0, right = 610.0, top = 14.0, foot = 286.0;

std::string chart_html(const ResultChart& chart) {
  constexpr double step = 0.05;  // between two lines of the grid
  std::vector<double> values{chart.bar};
  for (const ResultCurve& curve : chart.curves) {
    for (const ResultPoint& point : curve.points) values.insert(values.end(), {point.low, point.high});
  }
  const page::Axis up = page::linear_axis(values, step, foot, top);
  const page::Axis across{.high = static_cast<double>(chart.places.size() - 1), .begin = left, .end = right};
  page::Svg svg(chart_width, chart_height);
  for (const double value : up.ticks) {
    svg.line("mesh", left, up.at(value), right, up.at(value));
    svg.text("end", left - 8.0, up.at(value) + 4.0, fmt::format("{:.2f}", value));
  }
  const auto place = [&](std::size_t i) { return across.at(static_cast<double>(i)); };
  for (std::size_t i = 0; i < chart.places.size(); ++i) svg.text("middle", place(i), foot + 18.0, chart.places[i]);
  svg.text("middle", 0.5 * (left + right), foot + 38.0, chart.across);
  svg.text_upwards("middle", 12.0, 0.5 * (top + foot), chart.up);
  svg.line("limit", left, up.at(chart.bar), right, up.at(chart.bar));
  double row = top + 12.0;  // of the legend
  const auto name = [&](std::string_view kind, std::string_view text) {
    svg.line(kind, right + 14.0, row, right + 36.0, row);
    svg.text("", right + 42.0, row + 4.0, text);
    row += 20.0;
  };
  for (std::size_t k = 0; k < chart.curves.size(); ++k) {
    const std::string series = fmt::format("s{}", k % page::series_count);
    std::vector<std::array<double, 2>> way;
    for (const ResultPoint& point : chart.curves[k].points) {
      const double x = place(way.size());
      svg.line(series, x, up.at(point.low), x, up.at(point.high));
      svg.dot(series, x, up.at(point.value), 3.5);
      way.push_back({x, up.at(point.value)});
    }
    svg.polyline(series, way);
    name(series, chart.curves[k].name);
  }
  name("limit", chart.bar_name);
  return svg.element(chart.title);
}

std::string section(std::string_view title, const std::string& content, const std::string& note = "") {
  return fmt::format("<section><h2>{}</h2>\n{}{}</section>\n", page::escape_html(title), content,
                     note.empty() ? "" : fmt::format("<p class=\"note\">{}</p>\n", page::escape_html(note)));
}

}  // namespace

Json result_json(const std::string& name, const Result& result) {
  return {{"reproduction", name},  {"title", result.title},     {"source", result.source},
          {"setup", result.setup}, {"figures", result.figures}, {"remarks", result.remarks}};
}

std::string result_page(const std::string& name, const Result& result) {
  std::string body = fmt::format(
      "<header class=\"plain\"><p class=\"eyebrow\">{} {}</p>\n<h1>{}</h1>\n<p class=\"note\">{}</p></header>\n",
      page_kind.generator, page::escape_html(name), page::escape_html(result.title), page::escape_html(result.source));
  for (const ResultChart& chart : result.charts)
    body += section(chart.title, "<div class=\"scroll\">" + chart_html(chart) + "</div>\n");
  for (const ResultTable& table : result.tables)
    body += section(table.title, page::table_html(table.head, table.rows), table.note);
  if (!result.remarks.empty()) body += section("What differs, and why", page::list_html(result.remarks));
  if (!result.setup.empty()) body += section("How it was measured", page::list_html(result.setup));
  return page::compose_page({page_kind.generator, name + " · slipbench reproduce"}, body);
}

}  // namespace slipbench::reproduce

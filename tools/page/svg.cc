#include "tools/page/svg.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/core/math.h"
#include "sim/core/math/decade.h"
#include "tools/page/page.h"

namespace slipbench::page {
namespace {

// Formats a length or coordinate [px], rounded to 0.1 px.
std::string px(double value) { return fmt::format("{:.10g}", std::round(10.0 * value) / 10.0); }

std::string text_at(std::string_view kind, std::string_view place, std::string_view text) {
  return fmt::format("<text class=\"{}\" {}>{}</text>\n", kind, place, escape_html(text));
}

// Shorter steps are no longer exact, because their multiples are not normal numbers.
constexpr double finest_step = 1e-300;

// An axis with ticks at its ends alone. Equal values share it with zero.
Axis axis_of_ends(double least, double most, double begin, double end) {
  const bool apart = 0.5 * most - 0.5 * least >= finest_step;
  const double low = apart ? least : std::min(least, 0.0);
  double high = apart ? most : std::max(most, 0.0);
  if (high - low < finest_step) high = low + 1.0;
  return {.low = low, .high = high, .begin = begin, .end = end, .ticks = {low, high}};
}

}  // namespace

double Axis::at(double value) const {
  if (logarithmic) {
    const double whole = high / low, part = value / low;
    const double share = std::isfinite(whole) && std::isfinite(part)
                             ? math::log10(part) / math::log10(whole)
                             : (math::log10(value) - math::log10(low)) / (math::log10(high) - math::log10(low));
    return begin + (end - begin) * share;
  }
  // Halves, because a difference of two doubles may overflow.
  return begin + (end - begin) * ((0.5 * value - 0.5 * low) / (0.5 * high - 0.5 * low));
}

Axis linear_axis(std::span<const double> values, double step, double begin, double end) {
  constexpr double most_ticks = 1000.0, most_multiple = 1e12;
  const auto [least, most] = std::ranges::minmax(values);
  const double first = std::floor(least / step), last = std::max(std::ceil(most / step), first + 1.0);
  const bool plain = step >= finest_step && last - first <= most_ticks && std::abs(first) <= most_multiple &&
                     std::abs(last) <= most_multiple && std::isfinite(step * first) && std::isfinite(step * last);
  if (!plain) return axis_of_ends(least, most, begin, end);
  // The ends include values that a product misses by its rounding.
  Axis axis{.low = std::min(step * first, least), .high = std::max(step * last, most), .begin = begin, .end = end};
  for (double k = first; k <= last; ++k) axis.ticks.push_back(step * k);
  return axis;
}

Axis decade_axis(std::span<const double> values, double begin, double end) {
  constexpr int lowest_power = -307, highest_power = 308;  // of the normal doubles
  const auto [least, most] = std::ranges::minmax(values);
  const int lowest = decade_of(least), highest = decade_of(most);
  // If the lowest value is a power of ten, the axis begins one decade below it.
  const int first = std::clamp(power_of_ten(lowest) == least ? lowest - 1 : lowest, lowest_power, highest_power - 1);
  const int last = std::clamp(power_of_ten(highest) == most ? highest : highest + 1, first + 1, highest_power);
  Axis axis{.low = std::min(power_of_ten(first), least),
            .high = std::max(power_of_ten(last), most),
            .begin = begin,
            .end = end,
            .logarithmic = true};
  for (int k = first; k <= last; ++k) axis.ticks.push_back(power_of_ten(k));
  return axis;
}

double round_step(double range, double times) {
  constexpr double largest_step = 1e307;
  const double rough = range > 0.0 ? std::clamp(range / times, finest_step, largest_step) : 1.0;
  const double decade = power_of_ten(decade_of(rough));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (rough <= step * decade) return step * decade;
  }
  return 10.0 * decade;
}

Axis round_axis(std::span<const double> values, double times, double begin, double end) {
  const auto [least, most] = std::ranges::minmax(values);
  // Values that differ only by rounding are equal.
  const bool apart = most - least > 1e-9 * std::max(std::abs(least), std::abs(most));
  return linear_axis(values, round_step(apart ? most - least : 0.0, times), begin, end);
}

Svg chart(const Frame& frame, const std::string& title, const Axis& across, const std::string& across_name, const Axis& up,
          const std::string& up_name) {
  const auto& [width, height, left, right, top, foot] = frame;
  Svg svg(width, height);
  svg.text("name", left, top - 13.0, title);
  for (const double tick : across.ticks) {
    svg.line("mesh", across.at(tick), top, across.at(tick), foot);
    svg.text("small middle", across.at(tick), foot + 14.0, fmt::format("{:.6g}", tick));
  }
  for (const double tick : up.ticks) {
    svg.line("mesh", left, up.at(tick), right, up.at(tick));
    svg.text("small end", left - 6.0, up.at(tick) + 4.0, fmt::format("{:.6g}", tick));
  }
  svg.text("middle", 0.5 * (left + right), foot + 32.0, across_name);
  svg.text_upwards("middle", 14.0, 0.5 * (top + foot), up_name);
  return svg;
}

Svg::Svg(double width, double height) : width_(width), height_(height) {}

void Svg::line(std::string_view kind, double x1, double y1, double x2, double y2) {
  marks_ += fmt::format("<line class=\"{}\" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"/>\n", kind, px(x1), px(y1), px(x2), px(y2));
}

void Svg::polyline(std::string_view kind, std::span<const std::array<double, 2>> points) {
  marks_ += fmt::format("<polyline class=\"{}\" points=\"", kind);
  for (const auto& [x, y] : points) marks_ += fmt::format("{}{},{}", marks_.ends_with('"') ? "" : " ", px(x), px(y));
  marks_ += "\"/>\n";
}

void Svg::dot(std::string_view kind, double x, double y, double radius) {
  marks_ += fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n", kind, px(x), px(y), px(radius));
}

void Svg::bar(std::string_view kind, double x, double y, double width, double height) {
  marks_ += fmt::format("<rect class=\"bar {}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", kind, px(x), px(y), px(width),
                        px(height));
}

void Svg::text(std::string_view kind, double x, double y, std::string_view text) {
  marks_ += text_at(kind, fmt::format("x=\"{}\" y=\"{}\"", px(x), px(y)), text);
}

void Svg::text_upwards(std::string_view kind, double x, double y, std::string_view text) {
  marks_ += text_at(kind, fmt::format("transform=\"translate({},{}) rotate(-90)\"", px(x), px(y)), text);
}

std::string Svg::element(std::string_view title) const {
  return fmt::format("<svg class=\"drawing\" width=\"{}\" height=\"{}\" role=\"img\" aria-label=\"{}\">\n{}</svg>\n", px(width_),
                     px(height_), escape_html(title), marks_);
}

std::string Svg::file(std::string_view title) const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"drawing\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\">\n"
      "<title>{2}</title>\n<style>\n{3}\n{4}</style>\n<rect class=\"page\" width=\"{0}\" height=\"{1}\" rx=\"6\"/>\n{5}</svg>\n",
      px(width_), px(height_), escape_html(title), embedded(assets(), "theme.css"), embedded(assets(), "drawing.css"), marks_);
}

}  // namespace slipbench::page

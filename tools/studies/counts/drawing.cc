#include "tools/studies/counts/drawing.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "tools/base/page/svg.h"

namespace slipbench::counts {
namespace {

// In pixels.
constexpr double width = 760.0, top = 46.0, row = 24.0, bar_height = 14.0, names_end = 140.0;
constexpr double label_room = 52.0;  // for the number after the longest bar

// Three significant digits (two below 1), without an exponent: "3.04", "183", "4,610".
std::string short_number(double value) {
  if (value < 1.0) return fmt::format("{:.2g}", value);
  if (value < 999.5) return fmt::format("{:.3g}", value);
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  const std::string digits = fmt::format("{:.0f}", std::round(value / step) * step);
  std::string out;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) out += ',';
    out += digits[i];
  }
  return out;
}

// Bars of one kind of value, beside the names of their scenes, on an axis of whole decades.
void add_bars(page::Svg& svg, const std::vector<double>& values, double begin, double end, std::string_view title,
              std::string_view kind) {
  const page::Axis axis = page::decade_axis(values, begin, end - label_room);
  svg.text("name", begin, 20.0, title);
  for (const double decade : axis.ticks) {
    const double x = axis.at(decade);
    svg.line("mesh", x, top - 4.0, x, top + row * static_cast<double>(values.size()));
    svg.text("small middle", x, 38.0, short_number(decade));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double y = top + row * static_cast<double>(i) + 0.5 * (row - bar_height), reach = axis.at(values[i]);
    svg.bar(kind, begin, y, reach - begin, bar_height);
    svg.text("name", reach + 5.0, y + 11.0, short_number(values[i]));
  }
}

std::string joined(const Facts& facts, std::initializer_list<std::string_view> names) {
  std::string out;
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(facts, name, &Facts::value_type::first);
    if (found != facts.end()) out += (out.empty() ? "" : ", ") + found->second;
  }
  return out;
}

}  // namespace

std::string drawing(const Results& results) {
  std::vector<double> counts;
  std::vector<double> times;
  for (const SceneCount& scene : results.scenes) {
    counts.push_back(scene.instructions_per_second() * 1e-6);
    times.push_back(scene.times_real_time());
  }
  const double bottom = top + row * static_cast<double>(results.scenes.size());
  page::Svg svg(width, bottom + 44.0);
  for (std::size_t i = 0; i < results.scenes.size(); ++i) {
    svg.text("name end", names_end, top + row * static_cast<double>(i) + 16.0, scene_name(results.scenes[i].scene));
  }
  add_bars(svg, counts, 150.0, 440.0, "million instructions per simulated second", "s0");
  add_bars(svg, times, 460.0, 745.0, "times real time, one core", "s2");
  svg.text("small", 14.0, bottom + 18.0, joined(results.build, {"compiler", "flags", "sources", "instruction set"}));
  svg.text("small", 14.0, bottom + 33.0, joined(results.context, {"processor", "system", "commit"}));
  return svg.file("What the reference scenes cost");
}

}  // namespace slipbench::counts

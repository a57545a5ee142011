#include "tools/calibrate/calibrate_page.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "tools/calibrate/calibrate.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"
#include "tools/page/svg.h"

namespace slipbench::calibrate {
namespace {

using page::Axis;
using page::escape_html;
using page::Svg;

constexpr std::string_view generator = "slipbench calibrate";
constexpr page::PageKind page_kind{
    "a calibration", generator, "page of slipbench calibrate", "result of slipbench calibrate", {result_key}};

// A drawing and the positions of its axes [px].
constexpr double left = 54.0, right = 290.0, top = 26.0, foot = 150.0;
constexpr page::Frame frame{300.0, 190.0, left, right, top, foot};
// A page with more recordings would open slowly; the JSON file has all.
constexpr std::size_t most_drawn = 12;

std::string number(const Json& value) { return fmt::format("{:.4g}", value.get<double>()); }
std::string text(const Json& value) { return value.get<std::string>(); }

FitKey key_of(const Json& parameter) {
  const std::string unit = text(parameter.at("unit"));
  return {.path = text(parameter.at("key")),
          .min = parameter.at("min").get<double>(),
          .max = parameter.at("max").get<double>(),
          .logarithmic = parameter.at("draw") == "log_uniform",
          .quantity = unit.empty() ? Quantity::none : quantity_of("1 " + unit)};
}

std::string path_of(const std::string& scene, const char* extension) {
  return std::filesystem::path(scene).replace_extension(extension).string();
}

Axis axis_for(const std::vector<double>& values, double begin, double end) { return page::round_axis(values, 4.0, begin, end); }

// Returns an axis whose range contains the values of both.
Axis axis_for_both(const std::vector<double>& real, const std::vector<double>& synthetic) {
  std::vector<double> values = real;
  values.insert(values.end(), synthetic.begin(), synthetic.end());
  return axis_for(values, foot, top);
}

std::string correlations_html(const Json& result) {
  std::vector<std::string> together;
  for (const Json& pair : result.at("correlations"))
    together.push_back(fmt::format("{} and {} are correlated ({:.2f}): their combination is known better than each",
                                   text(pair.at("first")), text(pair.at("second")), pair.at("correlation").get<double>()));
  return together.empty() ? "" : page::list_html(together);
}

std::string profiles_html(const Json& result) {
  std::string html;
  for (const Json& parameter : result.at("parameters")) {
    if (parameter.value("profile", Json::array()).empty())
      continue;  // keys with `each` and keys of the electronics have no profile
    const FitKey key = key_of(parameter);
    // A rise of 3.84 is the end of a 95 % interval; values far above it carry no more information.
    constexpr double most = 40.0;
    const Json& profile = parameter.at("profile");
    const double low = profile.front().at(0).get<double>(), high = profile.back().at(0).get<double>();
    const Axis across{.low = low, .high = high, .begin = left, .end = right, .ticks = {}};
    const Axis up{.low = 0.0, .high = most, .begin = foot, .end = top, .ticks = {0.0, 10.0, 20.0, 30.0, 40.0}};
    Svg svg = page::chart(frame, key.path, across, key.text(low, 5) + " to " + key.text(high, 5), up);
    std::vector<std::array<double, 2>> way;
    for (const Json& point : profile)
      way.push_back({across.at(point.at(0).get<double>()), up.at(std::clamp(point.at(1).get<double>(), 0.0, most))});
    svg.line("limit", left, up.at(3.84), right, up.at(3.84));
    svg.polyline("s0", way);
    svg.dot("s0", across.at(parameter.at("value").get<double>()), foot, 3.5);
    html += svg.element("Rise of the squared residuals when " + key.path + " is fixed");
  }
  return "<div>" + html + "</div>\n";
}

std::string residuals_html(const Json& result) {
  page::TextTable table{{"", "residual / repeatability", "step between samples, real / synthetic",
                         "sd of gains, found / expected", "sd of offsets, found / expected"}};
  for (const Json& one : result.at("residuals")) {
    const auto pair = [&](const char* found, const char* expected, const std::string& unit) {
      return fmt::format("{} / {}{}", number(one.at(found)), number(one.at(expected)), unit);
    };
    const std::string unit = " " + text(one.at("unit"));
    table.rows.push_back({fmt::format("{} {} {}", text(one.at("sensor")), text(one.at("channel")), text(one.at("component"))),
                          pair("residual", "repeatability", unit), pair("noise", "noise_expected", unit),
                          pair("gain_scatter", "gain_scatter_expected", ""),
                          pair("offset_scatter", "offset_scatter_expected", unit)});
  }
  return page::table_html(table);
}

std::string curve_drawing(const Json& recording, const Json& curve) {
  const double begin = recording.at("begin_s").get<double>(), step = recording.at("step_s").get<double>();
  const auto real = curve.at("real").get<std::vector<double>>(), synthetic = curve.at("synthetic").get<std::vector<double>>();
  std::vector<double> times;
  for (std::size_t k = 0; k < real.size(); ++k) times.push_back(begin + step * (static_cast<double>(k) + 0.5));
  const Axis across = axis_for(times, left, right), up = axis_for_both(real, synthetic);
  const std::string source = curve.at("of").is_string() ? "mean" : fmt::format("unit {}", curve.at("of").get<std::size_t>());
  const std::string shown =
      fmt::format("{} {} [{}], {}", text(curve.at("channel")), text(curve.at("component")), text(curve.at("unit")), source);
  Svg svg = page::chart(frame, shown, across, "time [s]", up);
  const auto draw = [&](const char* kind, const std::vector<double>& line) {
    std::vector<std::array<double, 2>> way;
    for (std::size_t k = 0; k < line.size(); ++k) way.push_back({across.at(times[k]), up.at(line[k])});
    svg.polyline(kind, way);
  };
  draw("s0", real);
  draw("s1", synthetic);
  return svg.element(shown + ", real and synthetic");
}

// Returns a table of residuals with one figure per row and one group per column.
std::string group_residuals_html(const Json& result) {
  const Json& groups = result.at("groups");
  page::TextTable table{{""}};
  for (const Json& group : groups) {
    const auto refused = group.at("refused").get<std::size_t>();
    table.head.push_back(fmt::format("{} ({} / {}{})", text(group.at("name")), group.at("recordings").get<std::size_t>(),
                                     group.at("trials").get<std::size_t>(),
                                     refused > 0 ? fmt::format(", {} refused", refused) : ""));
    for (std::size_t k = 0; k < group.at("statistics").size(); ++k) {
      const Json& one = group.at("statistics").at(k);
      if (table.rows.size() <= k)
        table.rows.push_back({fmt::format("{} {} {} {}", text(one.at("sensor")), text(one.at("channel")),
                                          text(one.at("component")), text(one.at("statistic")))});
      table.rows[k].push_back(fmt::format("{:.2f}", one.at("residual").get<double>()));
    }
  }
  return page::table_html(table);
}

std::string group_drawing(const Json& one) {
  const auto real = one.at("real").get<std::vector<double>>(), synthetic = one.at("synthetic").get<std::vector<double>>();
  std::vector<double> units;
  for (std::size_t unit = 0; unit < real.size(); ++unit) units.push_back(static_cast<double>(unit));
  const Axis across = axis_for(units, left, right), up = axis_for_both(real, synthetic);
  const std::string shown = fmt::format("{} {} {} [{}]", text(one.at("channel")), text(one.at("component")),
                                        text(one.at("statistic")), text(one.at("unit")));
  Svg svg = page::chart(frame, shown, across, "unit", up);
  for (std::size_t unit = 0; unit < real.size(); ++unit) {
    svg.dot("s0", across.at(units[unit]), up.at(real[unit]), 2.5);
    svg.dot("s1", across.at(units[unit]), up.at(synthetic[unit]), 2.5);
  }
  return svg.element(shown + ", real and synthetic");
}

// Returns the first elements of `all`, each as a heading followed by the drawings of its `parts`.
std::string drawings(const Json& all, const char* parts, const std::function<std::string(const Json&, const Json&)>& draw) {
  std::string html;
  for (std::size_t k = 0; k < std::min(most_drawn, all.size()); ++k) {
    html += fmt::format("<h3>{}</h3>\n<div>", escape_html(text(all.at(k).at("name"))));
    for (const Json& part : all.at(k).at(parts)) html += draw(all.at(k), part);
    html += "</div>\n";
  }
  return html;
}

std::string groups_html(const Json& groups) {
  std::string html = drawings(groups, "statistics", [](const Json&, const Json& one) { return group_drawing(one); });
  if (groups.size() > most_drawn) html += fmt::format("<p>The first {} of {} groups are drawn.</p>\n", most_drawn, groups.size());
  return html;
}

}  // namespace

page::TextTable parameter_table(const Json& result) {
  const bool truth = result.at("synthetic_truth").get<bool>();
  page::TextTable table{{"key", "value", "95 % interval", "bounds", ""}};
  if (truth) table.head.insert(table.head.end(), {"drawn", "error"});
  for (const Json& parameter : result.at("parameters")) {
    const FitKey key = key_of(parameter);
    const auto add = [&](const std::string& name, const Json& one, const std::string& remark) {
      const bool known = one.at("determined").get<bool>();
      std::vector<std::string> row{
          name, known ? key.text(one.at("value").get<double>()) : "not determined",
          known ? "+- " + key.text(0.5 * (one.at("high").get<double>() - one.at("low").get<double>()), 2) : "",
          key.text(key.min) + " to " + key.text(key.max),
          one.at("at_bound").get<bool>() ? "at its bound: widen the bounds" : remark};
      if (truth)
        row.insert(row.end(), {key.text(one.at("truth").get<double>()), known ? key.text(one.at("error").get<double>(), 2) : ""});
      table.rows.push_back(std::move(row));
    };
    if (!parameter.at("each").get<bool>()) {
      add(key.path, parameter, "");
      continue;
    }
    for (std::size_t r = 0; r < parameter.at("by_recording").size(); ++r)
      add(fmt::format("{}, recording {}", key.path, r), parameter.at("by_recording").at(r), "");
    const std::string scatter =
        key.logarithmic ? number(parameter.at("scatter")) + " (logarithm)" : key.text(parameter.at("scatter").get<double>());
    table.rows.push_back({key.path + ", all", key.text(parameter.at("value").get<double>()), "", "", "scatter sd " + scatter});
    table.rows.back().resize(table.head.size());
  }
  return table;
}

std::string residual_text(const Json& result) {
  const bool groups = result.contains("groups");
  return fmt::format("residuals are {:.3g} times the {}",
                     result.at(groups ? "residual_over_scatter" : "residual_over_repeatability").get<double>(),
                     groups ? "scatter of recordings and devices" : "sensor's repeatability");
}

std::string calibration_page(const Json& result) {
  const std::string scene = text(result.at("scene"));
  const bool groups = result.contains("groups");
  const std::string found = fmt::format("{}, seed {}; {}", counted(result.at("recordings").size(), "recording"),
                                        result.at("seed").get<std::uint64_t>(), residual_text(result));
  std::string body = page::head_html(generator, scene, {found}, text(result.at("command")));
  body += page::section_html(
      "Parameters",
      "Not determined: the 95 % interval covers half of the bounds or more, or the fit is as good at one of the bounds." +
          std::string(
              groups ? "" : " Stiffness is as measured by the sensor: the gains of a component have the mean 1 over its units."),
      page::table_html(parameter_table(result)) + correlations_html(result));
  body += page::section_html(
      "Profiles",
      "Rise of the squared residuals when one parameter is fixed and the others are fitted again. Dashed: 3.84, the end of a 95 % interval. "
      "Dot: the fit.",
      profiles_html(result));
  if (groups) {
    body += page::section_html(
        "Residuals",
        "Difference between the real and synthetic means of a group, divided by their scatter; RMS over the units. Heading: recordings / trials, and the number of draws that failed. Level: mean. Trend: second half "
        "minus first half. Times: logarithm of the step between consecutive means over that time. A value much above 1 shows an error of the model.",
        group_residuals_html(result));
    body += page::section_html("Real and synthetic", "Means over a group, by unit. Blue: recorded; orange: the fitted scene.",
                               groups_html(result.at("groups")));
  } else {
    const Json& recordings = result.at("recordings");
    body += page::section_html(
        "Residuals",
        "Repeatability: the residual that the scene's electronics cause with an exact model. A residual well above it shows an error of the model.",
        residuals_html(result));
    body += page::section_html(
        "Real and synthetic",
        "Blue: recorded; orange: the fitted scene with fitted gains and offsets. Mean of all units, and the unit that fits worst." +
            (recordings.size() > most_drawn
                 ? fmt::format(" The first {} recordings; the JSON file next to this page has all.", most_drawn)
                 : ""),
        drawings(recordings, "curves", curve_drawing));
  }
  return page::compose_page({generator, std::filesystem::path(scene).filename().string() + " · slipbench calibrate"}, body);
}

void check_calibration_target(const std::string& path, const std::vector<std::string>& inputs) {
  if (!path.ends_with(".yaml")) reject("calibrate: -o {}: the fitted scene is a YAML file, whose name must end with .yaml", path);
  check_text_target(path, inputs, {"scene of slipbench calibrate", [](std::string_view text) {
                                     return text.starts_with("# slipbench calibrate ");
                                   }});
  page::check_page_files(path_of(path, ".html"), page_kind);
}

std::vector<std::string> write_calibration(const std::string& path, const std::string& fitted, const Json& result) {
  check_calibration_target(path, {});
  std::vector<std::string> files = page::write_page_files(path_of(path, ".html"), page_kind, calibration_page(result), result);
  write_text_file(path, fitted);
  files.insert(files.begin(), path);
  return files;
}

}  // namespace slipbench::calibrate

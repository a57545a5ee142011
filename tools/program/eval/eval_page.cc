#include "tools/program/eval/eval_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "tools/base/page/page.h"
#include "tools/base/page/page_files.h"
#include "tools/base/page/svg.h"
#include "tools/program/eval/evaluate.h"
#include "tools/program/eval/metrics.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench::eval {
namespace {

using page::Axis;
using page::escape_html;
using page::Svg;

constexpr std::string_view generator = "slipbench eval";

constexpr page::PageKind page_kind{
    "an evaluation", {"page of slipbench eval", &begins_as_eval_page}, {"result of slipbench eval", &begins_as_eval_json}};

// A drawing and where its axes lie in it [px].
constexpr double width = 420.0, height = 300.0, left = 62.0, right = 404.0, top = 30.0, foot = 248.0;
constexpr double ms = 1e3;

std::string shown(const Json& value, Figure::Unit unit) {
  if (value.is_null()) return "–";
  const double number = value.get<double>();
  switch (unit) {
    case Figure::Unit::share: return fmt::format("{:.1f} %", 100.0 * number);
    case Figure::Unit::time: return fmt::format("{:.1f} ms", ms * number);
    case Figure::Unit::rate: return fmt::format("{:.2f}", number);
    case Figure::Unit::number: return fmt::format("{:.3f}", number);
  }
  return {};
}

std::string interval_of(const Json& figure, Figure::Unit unit) {
  return figure.at("low").is_null() ? "–" : shown(figure.at("low"), unit) + " to " + shown(figure.at("high"), unit);
}

// 1, 2 or 5 times a power of ten, some five of which make up `range`.
double step_of(double range) {
  const double rough = range > 0.0 ? range / 5.0 : 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (rough <= step * decade) return step * decade;
  }
  return 10.0 * decade;
}

Axis axis_for(std::span<const double> values, double begin, double end) {
  const auto [least, most] = std::ranges::minmax(values);
  return page::linear_axis(values, step_of(most - least), begin, end);
}

Axis share_axis(double begin, double end) {
  return {.low = 0.0, .high = 1.0, .begin = begin, .end = end, .ticks = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}};
}

// An empty chart with its axes.
Svg chart(const std::string& title, const Axis& across, const std::string& across_name, const Axis& up,
          const std::string& up_name) {
  Svg svg(width, height);
  svg.text("name", left, 16.0, title);
  for (const double tick : across.ticks) {
    svg.line("mesh", across.at(tick), top, across.at(tick), foot);
    svg.text("small middle", across.at(tick), foot + 14.0, fmt::format("{:.6g}", tick));
  }
  for (const double tick : up.ticks) {
    svg.line("mesh", left, up.at(tick), right, up.at(tick));
    svg.text("small end", left - 6.0, up.at(tick) + 4.0, fmt::format("{:.6g}", tick));
  }
  svg.text("middle", 0.5 * (left + right), foot + 34.0, across_name);
  svg.text_upwards("middle", 14.0, 0.5 * (top + foot), up_name);
  return svg;
}

std::string roc_drawing(const Json& result) {
  const Axis across = share_axis(left, right), up = share_axis(foot, top);
  const std::string area = shown(result.at("all").at("figures").at("auc").at("value"), Figure::Unit::number);
  Svg svg = chart("ROC, area " + area, across, "share of frames without slip called slip", up, "share of slip called so");
  svg.line("limit", left, foot, right, top);
  std::vector<std::array<double, 2>> way;
  for (const Json& point : result.at("roc")) way.push_back({across.at(point[1].get<double>()), up.at(point[2].get<double>())});
  svg.polyline("s0", way);
  return svg.element("ROC, area " + area);
}

std::string calibration_drawing(const Json& result) {
  const Axis across = share_axis(left, right), up = share_axis(foot, top);
  Svg svg = chart("Calibration", across, "probability of slip said", up, "share that slips");
  svg.line("limit", left, foot, right, top);
  std::vector<std::array<double, 2>> way;
  for (const Json& bin : result.at("calibration")) {
    way.push_back({across.at(bin.at("mean").get<double>()), up.at(bin.at("share").get<double>())});
    svg.dot("s0", way.back()[0], way.back()[1], 3.5);
  }
  svg.polyline("s0", way);
  return svg.element("Calibration: share that slips against the probability said");
}

std::string histogram(const std::vector<double>& delays) {
  constexpr std::size_t bars = 30;
  const Axis across = axis_for(delays, left, right);
  std::array<double, bars> counts{};
  for (const double delay : delays) {
    const auto place = static_cast<std::size_t>((delay - across.low) / (across.high - across.low) * bars);
    counts.at(std::min(place, bars - 1)) += 1.0;
  }
  const std::array<double, 2> ends{0.0, *std::ranges::max_element(counts)};
  const Axis up = page::linear_axis(ends, std::max(1.0, step_of(ends[1])), foot, top);
  Svg svg = chart(fmt::format("Delay of the {} trials seen", delays.size()), across, "delay from the true first slip [ms]", up,
                  "trials");
  const double bar = (right - left) / static_cast<double>(bars);
  for (std::size_t k = 0; k < bars; ++k) {
    const double high = up.at(counts[k]);
    if (counts[k] > 0.0) svg.bar("s0", left + bar * static_cast<double>(k) + 0.5, high, bar - 1.0, foot - high);
  }
  return svg.element(fmt::format("Histogram of the delays of the {} trials seen", delays.size()));
}

// A dot a trial that was seen, and at the upper edge one for each that was missed.
std::string scatter(const Json& result, const char* key, double scale, const std::string& name, bool decades) {
  struct Dot {
    double x;
    std::optional<double> delay;  // ms; empty: missed
  };
  std::vector<Dot> dots;
  std::vector<double> places, delays;
  for (const Json& trial : result.at("trials")) {
    const std::string detection = trial.at("detection").get<std::string>();
    if (trial.at(key).is_null() || (detection != "seen" && detection != "missed")) continue;
    if (detection == "seen" && trial.at("delay_s").is_null()) continue;  // of one sample, which has no delay
    const double x = scale * trial.at(key).get<double>();
    if (decades && !(x > 0.0)) continue;  // a pad at rest has no place on decades; its delay is in the histogram
    dots.push_back({x, std::nullopt});
    places.push_back(x);
    if (detection == "seen") delays.push_back(*(dots.back().delay = ms * trial.at("delay_s").get<double>()));
  }
  if (places.empty() || delays.empty() || std::ranges::min(places) == std::ranges::max(places)) return {};
  const Axis across = decades ? page::decade_axis(places, left, right) : axis_for(places, left, right);
  const Axis up = axis_for(delays, foot, top + 12.0);
  Svg svg = chart("Delay against " + name.substr(0, name.find(" [")), across, name, up, "delay [ms]");
  for (const Dot& dot : dots) svg.dot(dot.delay ? "s0" : "s1", across.at(dot.x), dot.delay ? up.at(*dot.delay) : top + 3.0, 2.5);
  if (dots.size() > delays.size())
    svg.text("small end", right, top - 4.0, fmt::format("{} missed: at the upper edge", dots.size() - delays.size()));
  return svg.element("Delay [ms] against the " + name);
}

std::string section(const std::string& title, const std::string& content, const std::string& note = "") {
  return fmt::format("<section><h2>{}</h2>\n{}{}</section>\n", escape_html(title), content,
                     note.empty() ? "" : fmt::format("<p class=\"note\">{}</p>\n", escape_html(note)));
}

std::string headline(const Json& all) {
  std::string html = "<div class=\"figures\">\n";
  const auto add = [&html](const std::string& name, const std::string& value, const std::string& note) {
    html += fmt::format("<div><div class=\"k\">{}</div><div class=\"v\">{}</div><div class=\"s\">{}</div></div>\n",
                        escape_html(name), escape_html(value), escape_html(note));
  };
  constexpr std::array<std::pair<std::string_view, const char*>, 6> first{{{"recall_of_slip", "recall of slip"},
                                                                           {"balanced_slip_accuracy", "balanced accuracy"},
                                                                           {"delay_median_s", "median delay"},
                                                                           {"early", "early"},
                                                                           {"missed", "missed"},
                                                                           {"false_alarms_per_minute", "false alarms a minute"}}};
  for (const auto& [key, name] : first) {
    const auto figure = std::ranges::find(figures, key, &Figure::key);
    const Json& found = all.at("figures").at(std::string(key));
    add(name, shown(found.at("value"), figure->unit), interval_of(found, figure->unit));
  }
  return html + "</div>\n";
}

std::string figures_html(const Json& all) {
  std::vector<std::vector<std::string>> rows;
  for (const Figure& figure : figures) {
    const std::string key(figure.key);
    const Json& found = all.at("figures").at(key);
    if (found.at("value").is_null()) continue;
    rows.push_back({std::string(figure.name), shown(found.at("value"), figure.unit), interval_of(found, figure.unit),
                    all.at("constant").contains(key) ? shown(all.at("constant").at(key), figure.unit) : ""});
  }
  return page::table_html({"", "value", "95 % by trial", "best constant answer"}, rows);
}

std::string called_html(const Json& all) {
  constexpr std::array<std::pair<const char*, const char*>, 4> states{
      {{"no_contact", "no contact"}, {"non_slip", "non-slip"}, {"incipient", "incipient"}, {"gross", "gross"}}};
  std::vector<std::vector<std::string>> rows;
  for (const auto& [key, name] : states) {
    const Json& row = all.at("called").at(key);
    double sum = 0.0;
    for (const Json& samples : row) sum += samples.get<double>();
    std::vector<std::string> cells{name, fmt::format("{:.0f}", sum)};
    for (const auto& [called, called_name] : states) {
      cells.push_back(sum > 0.0 ? fmt::format("{:.1f} %", 100.0 * row.at(called).get<double>() / sum) : "–");
    }
    rows.push_back(std::move(cells));
  }
  return page::table_html({"true state", "samples", "called no contact", "called non-slip", "called incipient", "called gross"},
                          rows);
}

std::string drawings(const Json& result) {
  std::string html;
  if (result.contains("roc")) html += roc_drawing(result);
  if (result.contains("calibration")) html += calibration_drawing(result);
  std::vector<double> delays;
  for (const Json& trial : result.at("trials")) {
    if (!trial.at("delay_s").is_null()) delays.push_back(ms * trial.at("delay_s").get<double>());
  }
  if (!delays.empty()) html += histogram(delays);
  html += scatter(result, "speed_m_s", 1e3, "commanded speed [mm/s]", true);
  html += scatter(result, "friction", 1.0, "static friction", false);
  return html;
}

std::string groups_html(const Json& by) {
  constexpr std::array<std::string_view, 6> columns{"recall_of_slip", "balanced_slip_accuracy", "delay_median_s", "early",
                                                    "missed",         "false_alarms_per_minute"};
  std::vector<std::vector<std::string>> rows;
  for (const Json& group : by.at("groups")) {
    std::vector<std::string> row{group.at("name").get<std::string>(), fmt::format("{}", group.at("trials").get<std::size_t>())};
    for (const std::string_view column : columns) {
      const auto figure = std::ranges::find(figures, column, &Figure::key);
      const Json& found = group.at("figures").at(std::string(column));
      row.push_back(shown(found.at("value"), figure->unit));
    }
    rows.push_back(std::move(row));
  }
  return page::table_html({by.at("by").get<std::string>(), "trials", "recall of slip", "balanced accuracy", "median delay",
                           "early", "missed", "false alarms a minute"},
                          rows);
}

// A file name as the target of a link.
std::string link_path(const std::filesystem::path& path) {
  std::string link;
  for (const char c : path.generic_string()) {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos;
    link += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return link;
}

// Recordings without a truth have no report that could be opened.
std::string worst_html(const Json& result, const std::string& html_path) {
  namespace fs = std::filesystem;
  const std::string dataset = result.at("dataset").get<std::string>();
  const fs::path report = fs::path(dataset).replace_extension(".html");
  const std::string link = link_path(fs::absolute(report).lexically_relative(fs::absolute(html_path).parent_path()));
  std::string html = "<ul class=\"plain\">\n";
  for (const Json& worst : result.at("worst")) {
    const auto trial = worst.at("trial").get<std::size_t>();
    const std::string why = escape_html(worst.at("why").get<std::string>());
    if (!truth_note(result).empty()) {
      html += fmt::format("<li>trial {}: {}</li>\n", trial, why);
      continue;
    }
    html += fmt::format("<li><a href=\"{}#trial-{}\">trial {}</a>: {} · <code>slipbench report {} --trial {}</code></li>\n",
                        escape_html(link), trial, trial, why, escape_html(shell_word(dataset)), trial);
  }
  return html + "</ul>\n";
}

}  // namespace

bool begins_as_eval_page(std::string_view text) { return page::begins_as_page(text, generator); }

bool begins_as_eval_json(std::string_view text) { return text.starts_with(fmt::format("{{\n  \"{}\": ", result_key)); }

std::string eval_page(const Json& result, const std::string& html_path) {
  const Json& all = result.at("all");
  const std::string type = result.at("detector").at("type").get<std::string>(), dataset = result.at("dataset").get<std::string>();
  const auto count = [&all](const char* key) { return all.at(key).get<std::size_t>(); };
  std::string body = fmt::format(
      "<header class=\"plain\"><p class=\"eyebrow\">{}</p>\n<h1>{} on {}</h1>\n<p class=\"note\">sensor {} ({}), labels {}, {} trials, {} "
      "samples</p>\n<p class=\"note\"><code>{}</code></p></header>\n",
      generator, escape_html(type), escape_html(dataset), escape_html(result.at("sensor").at("name").get<std::string>()),
      escape_html(result.at("sensor").at("type").get<std::string>()), escape_html(result.at("labels").get<std::string>()),
      count("trials"), count("frames"), escape_html(result.at("command").get<std::string>()));
  if (const std::string note = truth_note(result); !note.empty())
    body += fmt::format("<p class=\"note\">{}</p>\n", escape_html(note));
  body += headline(all);
  const std::size_t left_out = result.at("left_out").size();
  body += section(
      "Figures", figures_html(all),
      fmt::format(
          "Of {} trials that slip: seen {}, early {}, missed {}; of {} that do not: false alarms {}.{} The first alarm of a trial "
          "decides. Balanced accuracy of slip or not is 50 % for any constant answer.",
          count("slipping"), count("seen"), count("early"), count("missed"), count("trials") - count("slipping"),
          count("false_alarms"), left_out > 0 ? fmt::format(" {} trials on which it was trained are left out.", left_out) : ""));
  body += section("What was called what", called_html(all), "Each row is a true state; shares are of its samples.");
  if (const std::string drawn = drawings(result); !drawn.empty()) body += section("Curves", "<div>" + drawn + "</div>\n");
  for (const Json& by : result.at("by")) body += section("By " + by.at("by").get<std::string>(), groups_html(by));
  if (!result.at("worst").empty()) {
    body += section("Look first at", worst_html(result, html_path),
                    truth_note(result).empty() ? "A link opens the dataset's report, once its command has made it." : "");
  }
  return page::compose_page({generator, type + " on " + std::filesystem::path(dataset).filename().string() + " · slipbench eval"},
                            body);
}

void check_eval_target(const std::string& html_path) { page::check_page_files(html_path, page_kind); }

std::vector<std::string> write_eval(const std::string& html_path, const Json& result) {
  return page::write_page_files(html_path, page_kind, eval_page(result, html_path), result);
}

}  // namespace slipbench::eval

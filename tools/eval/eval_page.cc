#include "tools/eval/eval_page.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "sim/api/pad_state_names.h"
#include "sim/core/counted.h"
#include "tools/dataset/reader.h"
#include "tools/eval/evaluate.h"
#include "tools/eval/metrics.h"
#include "tools/eval/recorded_trial.h"
#include "tools/page/svg.h"
#include "tools/page/timeline.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::eval {
namespace {

using page::Axis;
using page::escape_html;
using page::Svg;

// A drawing and the position of its axes [px].
constexpr double left = 62.0, right = 404.0, top = 30.0, foot = 248.0;
constexpr page::Frame frame{420.0, 300.0, left, right, top, foot};
constexpr double ms = 1e3, mm = 1e3;

std::string shown(const Json& value, Figure::Unit unit) {
  if (value.is_null()) return "–";
  const double number = value.get<double>();
  switch (unit) {
    case Figure::Unit::share: return fmt::format("{:.1f} %", 100.0 * number);
    case Figure::Unit::time: return fmt::format("{:.1f} ms", ms * number);
    case Figure::Unit::length: return fmt::format("{:.3f} mm", mm * number);
    case Figure::Unit::rate: return fmt::format("{:.2f}", number);
    case Figure::Unit::number: return fmt::format("{:.3f}", number);
  }
  return {};
}

std::string interval_of(const Json& figure, Figure::Unit unit) {
  return figure.at("low").is_null() ? "–" : shown(figure.at("low"), unit) + " to " + shown(figure.at("high"), unit);
}

Axis axis_for(std::span<const double> values, double begin, double end) { return page::round_axis(values, 5.0, begin, end); }

Axis share_axis(double begin, double end) {
  return {.low = 0.0, .high = 1.0, .begin = begin, .end = end, .ticks = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}};
}

std::string roc_drawing(const Json& result) {
  const Axis across = share_axis(left, right), up = share_axis(foot, top);
  const std::string area = shown(result.at("all").at("figures").at("auc").at("value"), Figure::Unit::number);
  Svg svg = page::chart(frame, "ROC, area " + area, across, "share of frames without slip that are classified as slip", up,
                        "share of slip that is classified as slip");
  svg.line("limit", left, foot, right, top);
  std::vector<std::array<double, 2>> way;
  for (const Json& point : result.at("roc")) way.push_back({across.at(point[1].get<double>()), up.at(point[2].get<double>())});
  svg.polyline("s0", way);
  return svg.element("ROC, area " + area);
}

std::string calibration_drawing(const Json& result) {
  const Axis across = share_axis(left, right), up = share_axis(foot, top);
  Svg svg = page::chart(frame, "Calibration", across, "reported probability of slip", up, "share that slips");
  svg.line("limit", left, foot, right, top);
  std::vector<std::array<double, 2>> way;
  for (const Json& bin : result.at("calibration")) {
    way.push_back({across.at(bin.at("mean").get<double>()), up.at(bin.at("share").get<double>())});
    svg.dot("s0", way.back()[0], way.back()[1], 3.5);
  }
  svg.polyline("s0", way);
  return svg.element("Calibration: share that slips against the reported probability");
}

// Recall or delay against false alarms, with the detector's own operating point.
std::string alarms_drawing(const Json& result, const char* key, double scale, const std::string& name) {
  constexpr const char* rate = "false_alarms_per_minute";
  const Json& own = result.at("all").at("figures");
  std::vector<std::array<double, 2>> points;
  std::vector<double> rates, values;
  const auto add = [&](const Json& at_rate, const Json& value) {
    if (at_rate.is_null() || value.is_null()) return;
    points.push_back({at_rate.get<double>(), scale * value.get<double>()});
    rates.push_back(points.back()[0]);
    values.push_back(points.back()[1]);
  };
  for (const Json& point : result.at("alarms")) add(point.at(rate), point.at(key));
  const std::size_t curve = points.size();
  add(own.at(rate).at("value"), own.at(key).at("value"));
  if (curve == 0 || std::ranges::min(rates) == std::ranges::max(rates)) return {};
  const Axis across = axis_for(rates, left, right), up = axis_for(values, foot, top);
  Svg svg = page::chart(frame, name + " against false alarms", across, "false alarms per minute of true stick", up, name);
  for (std::array<double, 2>& point : points) point = {across.at(point[0]), up.at(point[1])};
  svg.polyline("s0", std::span(points).first(curve));
  if (points.size() > curve) svg.dot("s1", points.back()[0], points.back()[1], 4.5);
  return svg.element(name + " against false alarms per minute; dot: as evaluated here");
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
  const Axis up = page::linear_axis(ends, std::max(1.0, page::round_step(ends[1], 5.0)), foot, top);
  Svg svg = page::chart(frame, fmt::format("Delay in {} with detected slip", counted(delays.size(), "trial")), across,
                        "delay after the true onset [ms]", up, "trials");
  const double bar = (right - left) / static_cast<double>(bars);
  for (std::size_t k = 0; k < bars; ++k) {
    const double high = up.at(counts[k]);
    if (counts[k] > 0.0) svg.bar("s0", left + bar * static_cast<double>(k) + 0.5, high, bar - 1.0, foot - high);
  }
  return svg.element(fmt::format("Histogram of the delays in {} with detected slip", counted(delays.size(), "trial")));
}

// One dot per seen trial, and at the upper edge one per missed trial.
std::string scatter(const Json& result, const char* key, double scale, const std::string& name, bool decades) {
  struct Dot {
    double x;
    std::optional<double> delay;  // ms; empty: missed
  };
  std::vector<Dot> dots;
  std::vector<double> places, delays;
  for (const Json& trial : result.at("trials")) {
    const Json& detection = trial.at("detection");
    if (trial.at(key).is_null() || (detection != "seen" && detection != "missed")) continue;
    if (detection == "seen" && trial.at("delay_s").is_null()) continue;  // a trial of one sample has no delay
    const double x = scale * trial.at(key).get<double>();
    if (decades && !(x > 0.0)) continue;  // a logarithmic axis cannot show a pad at rest; its delay is in the histogram
    dots.push_back({x, std::nullopt});
    places.push_back(x);
    if (detection == "seen") delays.push_back(*(dots.back().delay = ms * trial.at("delay_s").get<double>()));
  }
  if (places.empty() || delays.empty() || std::ranges::min(places) == std::ranges::max(places)) return {};
  const Axis across = decades ? page::decade_axis(places, left, right) : axis_for(places, left, right);
  const Axis up = axis_for(delays, foot, top + 12.0);
  Svg svg = page::chart(frame, "Delay against " + name.substr(0, name.find(" [")), across, name, up, "delay [ms]");
  for (const Dot& dot : dots) svg.dot(dot.delay ? "s0" : "s1", across.at(dot.x), dot.delay ? up.at(*dot.delay) : top + 3.0, 2.5);
  if (dots.size() > delays.size())
    svg.text("small end", right, top - 4.0, fmt::format("{} missed: at the upper edge", dots.size() - delays.size()));
  return svg.element("Delay [ms] against the " + name);
}

// The most important figures with their names.
constexpr std::array<std::pair<std::string_view, const char*>, 6> first_figures{
    {{"recall_of_slip", "recall of slip"},
     {"balanced_slip_accuracy", "balanced accuracy"},
     {"delay_median_s", "median delay"},
     {"early", "early"},
     {"missed", "missed"},
     {"false_alarms_per_minute", "false alarms per minute"}}};

Figure::Unit unit_of(std::string_view key) { return std::ranges::find(figures, key, &Figure::key)->unit; }

std::string headline(const Json& all) {
  std::string html = "<div class=\"figures\">\n";
  for (const auto& [key, name] : first_figures) {
    const Json& found = all.at("figures").at(std::string(key));
    html += fmt::format("<div><div class=\"k\">{}</div><div class=\"v\">{}</div><div class=\"s\">{}</div></div>\n", name,
                        shown(found.at("value"), unit_of(key)), interval_of(found, unit_of(key)));
  }
  return html + "</div>\n";
}

page::TextTable figures_table(const Json& result) {
  const Json& all = result.at("all");
  const Json* yardstick = result.contains("yardstick") ? &result.at("yardstick") : nullptr;
  page::TextTable table{{"", "value", "95 % by trial", "best constant detector"}, {}};
  if (yardstick != nullptr) table.head.push_back("best yardstick, " + yardstick->at("type").get<std::string>());
  for (const Figure& figure : figures) {
    const std::string key(figure.key);
    const Json& found = all.at("figures").at(key);
    const Json none, &other = yardstick != nullptr ? yardstick->at("all").at("figures").at(key).at("value") : none;
    if (found.at("value").is_null() && other.is_null()) continue;
    table.rows.push_back({std::string(figure.name), shown(found.at("value"), figure.unit), interval_of(found, figure.unit),
                          all.at("constant").contains(key) ? shown(all.at("constant").at(key), figure.unit) : ""});
    if (yardstick != nullptr) table.rows.back().push_back(shown(other, figure.unit));
  }
  return table;
}

page::TextTable called_table(const Json& all) {
  page::TextTable table{{"true state", "samples"}, {}};
  for (const PadStateName& called : pad_states) table.head.push_back(fmt::format("detected {}", called.title));
  for (const PadStateName& truth : pad_states) {
    const Json& row = all.at("called").at(truth.name);
    double sum = 0.0;
    for (const Json& samples : row) sum += samples.get<double>();
    std::vector<std::string>& cells = table.rows.emplace_back(std::vector<std::string>{truth.title, fmt::format("{:.0f}", sum)});
    for (const PadStateName& called : pad_states)
      cells.push_back(sum > 0.0 ? fmt::format("{:.1f} %", 100.0 * row.at(called.name).get<double>() / sum) : "–");
  }
  return table;
}

std::string drawings(const Json& result) {
  std::string html;
  if (result.contains("roc")) html += roc_drawing(result);
  if (result.contains("calibration")) html += calibration_drawing(result);
  if (result.contains("alarms")) {
    html += alarms_drawing(result, "recall_of_slip", 100.0, "recall of slip [%]");
    html += alarms_drawing(result, "delay_median_s", ms, "median delay [ms]");
  }
  std::vector<double> delays;
  for (const Json& trial : result.at("trials")) {
    if (!trial.at("delay_s").is_null()) delays.push_back(ms * trial.at("delay_s").get<double>());
  }
  if (!delays.empty()) html += histogram(delays);
  html += scatter(result, "speed_m_s", 1e3, "commanded speed [mm/s]", true);
  html += scatter(result, "friction", 1.0, "static friction", false);
  return html;
}

page::TextTable groups_table(const Json& by) {
  page::TextTable table{{by.at("by").get<std::string>(), "trials"}, {}};
  for (const auto& [key, name] : first_figures) table.head.emplace_back(name);
  for (const Json& group : by.at("groups")) {
    table.rows.push_back({group.at("name").get<std::string>(), fmt::format("{}", group.at("trials").get<std::size_t>())});
    for (const auto& [key, name] : first_figures)
      table.rows.back().push_back(shown(group.at("figures").at(std::string(key)).at("value"), unit_of(key)));
  }
  return table;
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

std::string worst_html(const Json& result, const std::string& dataset_path, const std::string& html_path) {
  namespace fs = std::filesystem;
  const std::string dataset = result.at("dataset").get<std::string>();
  const fs::path report = fs::path(dataset_path).replace_extension(".html");
  const std::string link = link_path(fs::absolute(report).lexically_relative(fs::absolute(html_path).parent_path()));
  std::string html = "<ul class=\"plain\">\n";
  for (const Json& worst : result.at("worst")) {
    const auto trial = worst.at("trial").get<std::size_t>();
    html += fmt::format("<li><a href=\"{}#trial-{}\">trial {}</a>: {} · <code>slipbench report {} --trial {}</code></li>\n",
                        escape_html(link), trial, trial, escape_html(worst.at("why").get<std::string>()),
                        escape_html(shell_word(dataset)), trial);
  }
  return html + "</ul>\n";
}

page::TimelineMarks marks_of(const RecordedTrial& trial, LabelRule rule) {
  page::TimelineMarks marks{.probability = trial.replayed.probability,
                            .seen = trial.replayed.seen,
                            .labels = trial.truth(rule).state,
                            .labels_name = labels_title(rule)};
  for (const SeenAlarm& alarm : alarms_of(trial.sensor().time, trial.replayed)) marks.alarms.push_back({alarm.begin, alarm.end});
  return marks;
}

// The worst trials over time. Their samples are read from the dataset, since the result does not
// contain them.
std::string worst_timelines(const Json& result, const std::string& dataset_path, const DetectorScene& detector) {
  const DatasetReader reader(dataset_path);
  const LabelRule rule = parse_label_rule(result.at("labels").get<std::string>());
  const std::string sensor = result.at("sensor").at("name").get<std::string>();
  const Catalogues catalogues = program_catalogues();
  std::string html;
  const Json& all = result.at("worst");
  for (std::size_t place = 0; place < std::min(drawn_trials, all.size()); ++place) {
    const Json& worst = all[place];
    const RecordedTrial trial = recorded_trial(reader, worst.at("trial").get<std::size_t>(), detector, sensor, catalogues,
                                               result.at("resample").get<bool>());
    html += page::section_html(fmt::format("Trial {}", trial.record.trial), worst.at("why").get<std::string>(),
                               page::timeline_html(trial.sensor(), marks_of(trial, rule), drawn_channels));
  }
  return html;
}

}  // namespace

Tables tables_of(const Json& result) {
  Tables tables{figures_table(result), called_table(result.at("all")), {}};
  for (const Json& by : result.at("by")) tables.by.push_back(groups_table(by));
  return tables;
}

std::string eval_page(const Json& result, const std::string& dataset_path, const std::string& html_path,
                      const DetectorScene& detector) {
  const Json& all = result.at("all");
  const Tables tables = tables_of(result);
  const std::string name = detector_name(result.at("detector")), dataset = result.at("dataset").get<std::string>();
  const auto count = [&all](const char* key) { return all.at(key).get<std::size_t>(); };
  const auto text = [](const Json& value) { return value.get<std::string>(); };
  std::vector<std::string> notes{fmt::format("sensor {} ({}), labels {}, {}, {}", text(result.at("sensor").at("name")),
                                             text(result.at("sensor").at("type")), text(result.at("labels")),
                                             counted(count("trials"), "trial"), counted(count("frames"), "sample"))};
  if (const std::string note = truth_note(result); !note.empty()) notes.push_back(note);
  std::ranges::move(frame_notes(result), std::back_inserter(notes));
  for (const Json& warning : result.at("warnings")) notes.push_back("warning: " + text(warning));
  std::string body =
      page::head_html(page_kind.generator, name + " on " + dataset, notes, text(result.at("command"))) + headline(all);
  const std::size_t left_out = result.at("left_out").size();
  body += page::section_html(
      "Figures",
      fmt::format(
          "Slipping trials: {}, detected {}, early {}, missed {}. Trials without slip: {}, false alarms {}.{} The first alarm of a trial "
          "counts. A constant detector has a balanced accuracy (slip or no slip) of 50 %.",
          count("slipping"), count("seen"), count("early"), count("missed"), count("trials") - count("slipping"),
          count("false_alarms"),
          left_out > 0
              ? fmt::format(" Left out: {} of the detector's training.", counted(static_cast<std::size_t>(left_out), "trial"))
              : "") +
          (result.contains("yardstick") ? " " + yardstick_note(result) + "." : ""),
      page::table_html(tables.figures));
  body += page::section_html("Confusion matrix", "Rows are true states; shares are of the samples of the row.",
                             page::table_html(tables.called));
  if (const std::string drawn = drawings(result); !drawn.empty())
    body += page::section_html("Curves", "", "<div>" + drawn + "</div>\n");
  for (const page::TextTable& by : tables.by) body += page::section_html("By " + by.head.front(), "", page::table_html(by));
  if (!result.at("worst").empty()) {
    body += page::section_html(
                "Worst trials",
                "A link opens the report that the command next to it writes. The trials are drawn below, with shaded alarms.",
                worst_html(result, dataset_path, html_path)) +
            worst_timelines(result, dataset_path, detector);
  }
  return page::compose_page(
      {page_kind.generator, name + " on " + std::filesystem::path(dataset).filename().string() + " · slipbench eval"}, body);
}

}  // namespace slipbench::eval

#include "tools/benchmark/board_page.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/counted.h"
#include "tools/benchmark/benchmark.h"
#include "tools/page/svg.h"

namespace slipbench::benchmark {
namespace {

constexpr double percent = 100.0, ms = 1e3;

std::string points(const Json& value) { return value.is_null() ? "–" : fmt::format("{:.1f}", percent * value.get<double>()); }

std::string shown(const Json& value, double scale, const char* unit, int digits) {
  return value.is_null() ? "–" : fmt::format("{:.{}f}{}", scale * value.get<double>(), digits, unit);
}

std::string share_of(const Json& row, const char* key) {
  return shown(row.at("figures").at("figures").at(key).at("value"), percent, " %", 0);
}

bool is_detector(const Json& row) {
  return row.at("kind") != "control" && row.at("kind") != "yardstick" && row.at("kind") != "known signal" &&
         row.at("kind") != "oracle";
}

// Draws scores with their intervals, the best on top.
std::string drawing(const Json& set) {
  constexpr double width = 640.0, left = 190.0, right = 620.0, line = 20.0, top = 12.0;
  const Json& rows = set.at("rows");
  const double foot = top + line * static_cast<double>(rows.size());
  const bool needless = !rows.empty() && rows[0].contains("needless");  // scores go down to -2
  const page::Axis across =
      needless ? page::Axis{.low = -2.0, .high = 1.0, .begin = left, .end = right, .ticks = {-2.0, -1.0, 0.0, 1.0}}
               : page::Axis{.low = -1.0, .high = 1.0, .begin = left, .end = right, .ticks = {-1.0, -0.5, 0.0, 0.5, 1.0}};
  page::Svg svg(width, foot + 40.0);
  for (const double tick : across.ticks) {
    svg.line("mesh", across.at(tick), top, across.at(tick), foot);
    svg.text("small middle", across.at(tick), foot + 14.0, fmt::format("{:.0f}", percent * tick));
  }
  svg.line("limit", across.at(0.0), top, across.at(0.0), foot);
  double y = top + 0.5 * line;
  for (const Json& row : rows) {
    const Json& score = row.at("score");
    const bool detects = is_detector(row);
    svg.text("small end", left - 8.0, y + 4.0, row.at("detector").get<std::string>());
    if (!score.at("low").is_null())
      svg.line(detects ? "s0" : "s1", across.at(score.at("low").get<double>()), y, across.at(score.at("high").get<double>()), y);
    if (!score.at("value").is_null()) svg.dot(detects ? "s0" : "s1", across.at(score.at("value").get<double>()), y, 4.0);
    y += line;
  }
  svg.text("middle", 0.5 * (left + right), foot + 32.0, "score");
  svg.dot("s0", right - 190.0, foot + 28.0, 4.0);
  svg.text("small", right - 181.0, foot + 32.0, "detectors");
  svg.dot("s1", right - 110.0, foot + 28.0, 4.0);
  svg.text("small", right - 101.0, foot + 32.0, "yardsticks, controls");
  return "<div class=\"scroll\">" + svg.element("Scores of the detectors, with 95 % intervals") + "</div>\n";
}

std::string groups_html(const Json& set) {
  std::string html;
  for (const Json& by : set.at("by")) {
    page::TextTable table{{by.at("by").get<std::string>()}};
    for (const Json& group : by.at("groups"))
      table.head.push_back(fmt::format("{} ({})", group.at("name").get<std::string>(), group.at("trials").get<std::size_t>()));
    for (std::size_t k = 0; k < set.at("rows").size(); ++k) {
      table.rows.push_back({set.at("rows")[k].at("detector").get<std::string>()});
      for (const Json& group : by.at("groups")) table.rows.back().push_back(points(group.at("scores")[k]));
    }
    html += page::table_html(table);
  }
  return html;
}

std::string set_html(const Json& set) {
  const BoardTable table = board_table(set);
  std::string html = drawing(set) + page::table_html(table.cells);
  if (!table.left_out.empty()) html += "<h3>Detectors without a score</h3>\n" + page::list_html(table.left_out);
  if (const std::string groups = groups_html(set); !groups.empty())
    html += "<details><summary>Score by condition (trials)</summary>\n" + groups + "</details>\n";
  const std::string from = set.contains("scene") ? set.at("scene").get<std::string>() : set.at("file").get<std::string>();
  const std::string note =
      fmt::format("{}; labels {}; data {}", from, set.at("labels").get<std::string>(), set.at("data_sha256").get<std::string>());
  return page::section_html(table.title, note, html);
}

double score_of(const Json& row) { return row.at("score").at("value").get<double>(); }

// Returns the best row of a kind (empty: of any detector); nullptr if there is none.
const Json* best(const Json& set, const std::string& kind) {
  for (const Json& row : set.at("rows")) {
    if (kind.empty() ? is_detector(row) : row.at("kind") == kind) return &row;
  }
  return nullptr;
}

// Draws for each sensor the best detector on open recordings with its interval, the best yardstick,
// and the row `signal known`.
std::string sensors_drawing(const Json& sets) {
  constexpr double width = 720.0, left = 300.0, right = 700.0, line = 22.0, top = 12.0;
  std::vector<const Json*> open;
  for (const Json& set : sets) {
    if (set.contains("domain") && !set.contains("disturbance")) open.push_back(&set);
  }
  const double foot = top + line * static_cast<double>(open.size());
  const page::Axis across{.low = -0.5, .high = 1.0, .begin = left, .end = right, .ticks = {-0.5, 0.0, 0.5, 1.0}};
  page::Svg svg(width, foot + 58.0);
  for (const double tick : across.ticks) {
    svg.line("mesh", across.at(tick), top, across.at(tick), foot);
    svg.text("small middle", across.at(tick), foot + 14.0, fmt::format("{:.0f}", percent * tick));
  }
  const auto place = [&across](double score) { return across.at(std::max(score, across.low)); };
  double y = top + 0.5 * line;
  for (const Json* set : open) {
    const Json* detector = best(*set, "");
    std::string name = fmt::format("{}, {}", set->at("sensor").get<std::string>(), set->at("domain").get<std::string>());
    if (detector != nullptr) name += ": " + detector->at("detector").get<std::string>();
    svg.text("small end", left - 8.0, y + 4.0, name);
    if (const Json* known = best(*set, "known signal")) svg.dot("s2", place(score_of(*known)), y, 5.0);
    if (const Json* yardstick = best(*set, "yardstick")) svg.dot("s3", place(score_of(*yardstick)), y, 4.0);
    if (detector != nullptr) {
      const Json& score = detector->at("score");
      if (!score.at("low").is_null())
        svg.line("s0", place(score.at("low").get<double>()), y, place(score.at("high").get<double>()), y);
      svg.dot("s0", place(score_of(*detector)), y, 4.0);
    }
    y += line;
  }
  double x = left;
  for (const auto& [kind, text] : {std::pair{"s0", "best detector"}, {"s2", "signal known"}, {"s3", "best yardstick"}}) {
    svg.dot(kind, x, foot + 40.0, 4.0);
    svg.text("small", x + 9.0, foot + 44.0, text);
    x += 105.0;
  }
  return "<div class=\"scroll\">" + svg.element("Scores on open recordings by sensor, with 95 % intervals") + "</div>\n";
}

// Draws the specificity of each detector (row) under each disturbance (column).
std::string disturbances_drawing(const Json& sets) {
  constexpr double left = 270.0, line = 22.0, top = 24.0, column = 88.0;
  std::vector<std::string> columns, rows;
  std::map<std::pair<std::string, std::string>, const Json*> cells;
  for (const Json& set : sets) {
    if (!set.contains("disturbance")) continue;
    const std::string disturbance = set.at("disturbance").get<std::string>();
    if (std::ranges::find(columns, disturbance) == columns.end()) columns.push_back(disturbance);
  }
  for (const Json& set : sets) {
    if (!set.contains("disturbance")) continue;
    for (const Json& row : set.at("rows")) {
      if (!is_detector(row) && row.at("kind") != "yardstick") continue;
      const std::string name = fmt::format("{}: {}", set.at("sensor").get<std::string>(), row.at("detector").get<std::string>());
      cells[{name, set.at("disturbance").get<std::string>()}] = &row;
    }
  }
  for (const auto& [key, row] : cells) {
    if (std::ranges::find(rows, key.first) == rows.end()) rows.push_back(key.first);
  }
  page::Svg svg(left + column * static_cast<double>(columns.size()), top + line * static_cast<double>(rows.size()) + 8.0);
  for (std::size_t c = 0; c < columns.size(); ++c)
    svg.text("small middle", left + column * (static_cast<double>(c) + 0.5), top - 8.0, columns[c]);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double y = top + line * static_cast<double>(r);
    svg.text("small end", left - 8.0, y + 15.0, rows[r]);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto cell = cells.find({rows[r], columns[c]});
      if (cell == cells.end() || cell->second->at("specificity").is_null()) continue;
      const double share = cell->second->at("specificity").get<double>();
      const double x = left + column * static_cast<double>(c);
      svg.bar(fmt::format("level{}", share < 0.5 ? 0 : share < 0.8 ? 1 : share < 0.95 ? 2 : 3), x, y, column - 2.0, line - 2.0);
      svg.text("small middle name", x + 0.5 * column, y + 15.0, fmt::format("{:.0f} %", percent * share));
    }
  }
  return "<div class=\"scroll\">" + svg.element("Share of disturbed recordings without an alarm") + "</div>\n";
}

// Returns the overview by sensor and disturbance; empty for a board without disturbed recordings.
std::string overview_html(const Json& sets) {
  const auto disturbed = [](const Json& set) { return set.contains("disturbance"); };
  if (std::ranges::none_of(sets, disturbed)) return "";
  return page::section_html("Score by sensor", "open recordings: the best detector with its 95 % interval by trial",
                            sensors_drawing(sets)) +
         page::section_html(
             "Specificity",
             "share of the recordings without an alarm; nothing slips, but the hand moves, the grip or the load changes, "
             "another motor runs, or the box is pushed",
             disturbances_drawing(sets));
}

// Returns what is known of each sensor on the board from real recordings.
std::string real_html(const Json& result) {
  std::set<std::string> sensors;
  for (const Json& set : result.at("sets")) sensors.insert(set.at("sensor").get<std::string>());
  std::vector<std::string> lines;
  for (const auto& [sensor, known] : result.at("protocol").at("real").items()) {
    if (sensors.contains(sensor)) lines.push_back(fmt::format("{}: {}", sensor, known.get<std::string>()));
  }
  if (lines.empty()) return "";
  return page::section_html("Real recordings",
                            "what is known of the shipped detectors from recordings of real sensors "
                            "(docs/results/real_recordings.md); the scores of this page are of simulations",
                            page::list_html(lines));
}

constexpr const char* opening =
    "Scores of slip detectors with 95 % intervals by trial. 100 is the best possible score; a detector that never reports slip has 0.";

// One paragraph for each kind of set.
constexpr std::array rules{
    "Yardsticks are rules of one line without training (detectors/yardstick). In the first open recordings of a sensor, the threshold of each has the best "
    "score on the other half of the trials. The best of them enters the other sets with the threshold that is best on all of these recordings.",
    "Open recordings: score = credit − share of the recordings without slip in which slip is reported. Recordings come in pairs with the same motion, one with slip "
    "and one without, so a rule that does not feel the pad earns at most 0.",
    "The credit of a recording that slips is half_slip_distance / (half_slip_distance + s), where s is the path that the object has slipped over the pad at "
    "the alarm; in a recording of a real sensor it is half_delay / (half_delay + delay). It is 0 if the alarm is early or missing. A recording is evaluated from the "
    "start of its motion; a recording that slips by less than least_slip_distance counts as one without slip.",
    "Recordings of a real sensor: score = credit − share of the time without slip in which slip is reported.",
    "Disturbed recordings: the score is the share of the recordings without an alarm. They have no ranks.",
    "Closed loop: score = credit − share of the time without slip in which slip is reported − needless force. The credit of a grasp is 1 for the smallest "
    "force that holds the box. It is 0 for force_ratio times this force or more, and if the box is dropped or not lifted.",
    "Boxes that the preset force holds have no credit. The mean needless force on these boxes is subtracted: 0 for the force of a controller "
    "that never tightens, 1 for force_ratio times this force or more.",
    "Oracle: reports a slip at its first instant. Signal known: reports a slip when its effect on all values exceeds three standard deviations of the "
    "sensor's noise."};

// Columns of a table, which depend on the track.
struct BoardColumns {
  bool grasps, needless, windows;
  std::vector<std::string> more;  // heads of the columns after those of every track
};

BoardColumns columns_of(const Json& set) {
  const Json& rows = set.at("rows");
  const auto has = [&](const char* key) { return !rows.empty() && rows[0].contains(key); };
  BoardColumns columns{
      .grasps = has("grasps"), .needless = has("grasps") && has("needless"), .windows = has("windows"), .more = {}};
  if (columns.grasps)
    columns.more = {"credit", "recall", "dropped", "not lifted", "force/least", "slip"};
  else if (!set.contains("disturbance"))
    columns.more = {"credit", "recall", "median delay", "median slip", "before gross slip", "early", "missed"};
  if (columns.needless) columns.more.emplace_back("needless force");
  if (columns.windows) {
    const double length = rows[0].at("windows").at("length_s").get<double>();
    columns.more.push_back(fmt::format("{:g} s windows: recall", length));
    columns.more.emplace_back("specificity");
  }
  return columns;
}

// Name of a detector in a table, of a yardstick with its thresholds.
std::string row_name(const Json& row) {
  std::vector<std::string> thresholds;
  if (row.contains("thresholds")) {
    for (const Json& threshold : row.at("thresholds")) thresholds.push_back(fmt::format("{:.3g}", threshold.get<double>()));
  } else if (row.at("kind") == "yardstick") {
    thresholds.push_back(row.at("parameters").at("threshold").get<std::string>());
  }
  const std::string name = row.at("detector").get<std::string>();
  return thresholds.empty() ? name : fmt::format("{}, threshold {}", name, fmt::join(thresholds, " or "));
}

std::vector<std::string> cells_of(const Json& row, const BoardColumns& columns) {
  const Json& score = row.at("score");
  std::vector<std::string> cells{row_name(row),
                                 row.at("rank").is_null() ? "–" : fmt::format("{}", row.at("rank").get<std::size_t>()),
                                 row.at("kind").get<std::string>(),
                                 points(score.at("value")),
                                 score.at("low").is_null() ? "–" : points(score.at("low")) + " to " + points(score.at("high")),
                                 shown(row.at("false_alarms_per_minute"), 1.0, "", 1),
                                 shown(row.at(row.contains("false_share") ? "false_share" : "reported_share"), percent, " %", 1)};
  if (columns.more.empty()) return cells;
  cells.push_back(points(row.at("credit")));
  cells.push_back(share_of(row, "recall_of_slip"));
  if (columns.grasps) {
    const Json& grasp = row.at("grasps");
    for (const char* lost : {"dropped", "not_lifted"})
      cells.push_back(fmt::format("{} of {}", grasp.at(lost).get<std::size_t>(), grasp.at("trials").get<std::size_t>()));
    cells.push_back(shown(grasp.at("force_ratio"), 1.0, "", 2));
    cells.push_back(shown(grasp.at("slip_m"), ms, " mm", 1));
    if (columns.needless) cells.push_back(points(row.at("needless")));
    return cells;
  }
  const Json& figures = row.at("figures").at("figures");
  cells.push_back(shown(figures.at("delay_median_s").at("value"), ms, " ms", 0));
  cells.push_back(shown(figures.at("slip_distance_median_m").at("value"), ms, " mm", 3));
  for (const char* share : {"before_gross_slip", "early", "missed"}) cells.push_back(share_of(row, share));
  if (columns.windows) {
    for (const char* share : {"recall", "specificity"}) cells.push_back(shown(row.at("windows").at(share), percent, " %", 0));
  }
  return cells;
}

}  // namespace

BoardTable board_table(const Json& set) {
  BoardTable table;
  const std::string domain = set.contains("domain") ? ", " + set.at("domain").get<std::string>() : "";
  const std::string disturbance = set.contains("disturbance") ? " by " + set.at("disturbance").get<std::string>() : "";
  const std::size_t trials = set.at("trials").get<std::size_t>();
  table.title = fmt::format("{}{}{}, {}: {}", set.at("track").get<std::string>(), domain, disturbance,
                            set.at("sensor").get<std::string>(), counted(trials, "trial"));
  if (!disturbance.empty() && !set.at("rows").empty())
    table.title += fmt::format(", {} of them without slip", set.at("rows")[0].at("judged").get<std::size_t>());
  const BoardColumns columns = columns_of(set);
  table.cells.head = {"", "rank", "kind", "score", "95 %", "false alarms/min", "false slip"};
  table.cells.head.insert(table.cells.head.end(), columns.more.begin(), columns.more.end());
  for (const Json& row : set.at("rows")) table.cells.rows.push_back(cells_of(row, columns));
  std::vector<std::string> of_others;
  for (const Json& one : set.at("left_out")) {
    const std::string name = one.at("detector").get<std::string>();
    if (one.at("reads_another").get<bool>())
      of_others.push_back(name);
    else
      table.left_out.push_back(name + ": " + one.at("why").get<std::string>());
  }
  if (!of_others.empty()) table.left_out.push_back(fmt::format("detectors of other sensors: {}", fmt::join(of_others, "; ")));
  return table;
}

std::string board_page(const Json& result) {
  const Json& protocol = result.at("protocol");
  const std::string name = protocol.at("name").get<std::string>(), part = protocol.at("whole").get<bool>() ? "" : "a part of ";
  std::string body = page::head_html(page_kind.generator, "Slip detectors on " + part + name, {opening});
  body += overview_html(result.at("sets"));
  body += real_html(result);
  for (const Json& set : result.at("sets")) body += set_html(set);
  if (result.contains("transfer")) body += page::section_html("transfer", result.at("transfer").get<std::string>(), "");
  const std::vector<std::vector<std::string>> constants{
      {"half_delay", fmt::format("{:g} ms", ms * protocol.at("half_delay_s").get<double>())},
      {"half_slip_distance", fmt::format("{:g} mm", ms * protocol.at("half_slip_distance_m").get<double>())},
      {"least_slip_distance", fmt::format("{:g} mm", ms * protocol.at("least_slip_distance_m").get<double>())},
      {"force_ratio", fmt::format("{:g}", protocol.at("force_ratio").get<double>())},
      {"protocol", protocol.at("sha256").get<std::string>()}};
  const std::vector<std::string> rules_list(rules.begin(), rules.end());
  body +=
      page::section_html("How the score is computed", "", page::list_html(rules_list) + page::table_html({{"", ""}, constants}));
  std::vector<std::vector<std::string>> machine;
  for (const auto& [key, value] : result.at("machine").items())
    machine.push_back({key, value.is_string() ? value.get<std::string>() : value.dump()});
  body += page::section_html(
      "Machine",
      "The output of a network may differ in the last bits on another processor; everything else is the same everywhere.",
      page::table_html({{"", ""}, machine}));
  return page::compose_page({page_kind.generator, "slip detectors on " + name}, body);
}

}  // namespace slipbench::benchmark

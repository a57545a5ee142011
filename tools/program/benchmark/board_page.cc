#include "tools/program/benchmark/benchmark.h"

#include <fmt/format.h>

#include "tools/base/page/svg.h"

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

// Scores with their intervals, the best on top.
std::string drawing(const Json& set) {
  constexpr double width = 640.0, left = 190.0, right = 620.0, line = 20.0, top = 12.0;
  const Json& rows = set.at("rows");
  const double foot = top + line * static_cast<double>(rows.size());
  const bool needless = !rows.empty() && rows[0].contains("needless");  // which takes a score to -2
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
    const bool is_detector = row.at("kind") != "control" && row.at("kind") != "oracle";
    svg.text("small end", left - 8.0, y + 4.0, row.at("detector").get<std::string>());
    if (!score.at("low").is_null())
      svg.line(is_detector ? "s0" : "s1", across.at(score.at("low").get<double>()), y, across.at(score.at("high").get<double>()),
               y);
    svg.dot(is_detector ? "s0" : "s1", across.at(score.at("value").get<double>()), y, 4.0);
    y += line;
  }
  svg.text("middle", 0.5 * (left + right), foot + 32.0, "score");
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
  if (!table.left_out.empty()) html += "<h3>Not on this board</h3>\n" + page::list_html(table.left_out);
  if (const std::string groups = groups_html(set); !groups.empty()) html += "<h3>Score by condition (trials)</h3>\n" + groups;
  const std::string from = set.contains("scene") ? set.at("scene").get<std::string>() : set.at("file").get<std::string>();
  const std::string note =
      fmt::format("{}; labels {}; data {}", from, set.at("labels").get<std::string>(), set.at("data_sha256").get<std::string>());
  return page::section_html(table.title, note, html);
}

constexpr const char* opening =
    "Scores of slip detectors, each with its 95 % interval by trial: 100 is the best there can be, 0 is what never saying slip earns.";

constexpr const char* rule =
    "Score, at most 100: credit × min(1, limit / false alarms a minute) − time wrongly called slip. An open recording's credit is half_delay / "
    "(half_delay + delay) of a slip that is seen from its true beginning on, and 0 of one that is missed or alarmed early. A grasp's is 1 with the "
    "least force that holds, 0 from force_ratio times that on or when the box is dropped or not lifted; boxes that the preset force holds have none to earn, and "
    "false alarms have their price in force, not in the limit. From slip-2 on the mean needless force on boxes that the preset holds is taken off: "
    "0 of the force of who never tightens, 1 from force_ratio times that on. Early alarms are false alarms. Never to say slip gives 0, always to say it "
    "nearly the least there is. Intervals: 95 %, by trial.";

}  // namespace

BoardTable board_table(const Json& set) {
  BoardTable table;
  const std::string domain = set.contains("domain") ? ", " + set.at("domain").get<std::string>() : "";
  const std::string disturbance = set.contains("disturbance") ? " by " + set.at("disturbance").get<std::string>() : "";
  table.title = fmt::format("{}{}{}, {}: {} trials", set.at("track").get<std::string>(), domain, disturbance,
                            set.at("sensor").get<std::string>(), set.at("trials").get<std::size_t>());
  const bool grasps = !set.at("rows").empty() && set.at("rows")[0].contains("grasps");
  const bool needless = grasps && set.at("rows")[0].contains("needless");
  table.cells.head = {"", "rank", "kind", "score", "95 %", "credit", "false alarms/min", "wrongly slip", "recall"};
  const std::vector<std::string> events =
      grasps ? std::vector<std::string>{"dropped", "not lifted", "force/least", "slip"}
             : std::vector<std::string>{"median delay", "slipped, median", "before gross slip", "early", "missed"};
  table.cells.head.insert(table.cells.head.end(), events.begin(), events.end());
  if (needless) table.cells.head.emplace_back("needless force");
  for (const Json& row : set.at("rows")) {
    const Json& score = row.at("score");
    std::vector<std::string> cells{row.at("detector").get<std::string>(),
                                   row.at("rank").is_null() ? "–" : fmt::format("{}", row.at("rank").get<std::size_t>()),
                                   row.at("kind").get<std::string>(),
                                   points(score.at("value")),
                                   score.at("low").is_null() ? "–" : points(score.at("low")) + " to " + points(score.at("high")),
                                   points(row.at("credit")),
                                   shown(row.at("false_alarms_per_minute"), 1.0, "", 1),
                                   shown(row.at("said"), percent, " %", 1),
                                   share_of(row, "recall_of_slip")};
    if (grasps) {
      const Json& grasp = row.at("grasps");
      for (const char* lost : {"dropped", "not_lifted"})
        cells.push_back(fmt::format("{} of {}", grasp.at(lost).get<std::size_t>(), grasp.at("trials").get<std::size_t>()));
      cells.push_back(shown(grasp.at("force_ratio"), 1.0, "", 2));
      cells.push_back(shown(grasp.at("slip_m"), ms, " mm", 1));
      if (needless) cells.push_back(points(row.at("needless")));
    } else {
      cells.push_back(shown(row.at("figures").at("figures").at("delay_median_s").at("value"), ms, " ms", 0));
      cells.push_back(shown(row.at("figures").at("figures").at("slip_distance_median_m").at("value"), ms, " mm", 3));
      cells.push_back(share_of(row, "before_gross_slip"));
      cells.push_back(share_of(row, "early"));
      cells.push_back(share_of(row, "missed"));
    }
    table.cells.rows.push_back(std::move(cells));
  }
  for (const Json& one : set.at("left_out"))
    table.left_out.push_back(one.at("detector").get<std::string>() + ": " + one.at("why").get<std::string>());
  return table;
}

std::string board_page(const Json& result) {
  const Json& protocol = result.at("protocol");
  const std::string name = protocol.at("name").get<std::string>(),
                    part = protocol.at("whole").get<bool>() ? "" : ", a part of it";
  std::string body = page::head_html(page_kind.generator, "Slip detectors on " + name + part, {opening});
  for (const Json& set : result.at("sets")) body += set_html(set);
  if (result.contains("transfer")) body += page::section_html("transfer", result.at("transfer").get<std::string>(), "");
  const std::vector<std::vector<std::string>> constants{
      {"half_delay", fmt::format("{:g} ms", ms * protocol.at("half_delay_s").get<double>())},
      {"limit", fmt::format("{:g} false alarms a minute", protocol.at("alarms_per_minute").get<double>())},
      {"force_ratio", fmt::format("{:g}", protocol.at("force_ratio").get<double>())},
      {"protocol", protocol.at("sha256").get<std::string>()}};
  body += page::section_html("How the score is made", rule, page::table_html({{"", ""}, constants}));
  std::vector<std::vector<std::string>> machine;
  for (const auto& [key, value] : result.at("machine").items())
    machine.push_back({key, value.is_string() ? value.get<std::string>() : value.dump()});
  body += page::section_html(
      "Machine", "A network's answers may differ in their last bits on another processor; all else is the same everywhere.",
      page::table_html({{"", ""}, machine}));
  return page::compose_page({page_kind.generator, "slip detectors on " + name}, body);
}

}  // namespace slipbench::benchmark

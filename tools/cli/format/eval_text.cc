#include "tools/cli/format/eval_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "tools/cost/reading.h"
#include "tools/eval/eval_page.h"
#include "tools/eval/evaluate.h"

namespace slipbench {
namespace {

std::string loop_text(const Json& loop) {
  const std::string detector = printable(loop.at("detector").get<std::string>());
  if (!loop.at("same").get<bool>()) {
    return fmt::format("  the dataset was recorded with the detector {} in the loop, which detected other classes\n", detector);
  }
  std::string text =
      fmt::format("  the dataset was recorded with this detector in the loop ({}): the same class in every sample\n", detector);
  if (!loop.contains("dropped")) return text;
  const auto median = [&loop](const char* key, double scale, const char* unit) {
    return loop.at(key).is_null() ? std::string("-") : fmt::format("{:.3g}{}", scale * loop.at(key).get<double>(), unit);
  };
  return text +
         fmt::format(
             "  in the loop: {} of {} dropped, {} not lifted; medians: slip {}, rotation {}, maximum/ideal force {}, reaction {}\n",
             loop.at("dropped").get<std::size_t>(), loop.at("trials").get<std::size_t>(),
             loop.at("not_lifted").get<std::size_t>(), median("slip_translation_m", 1e3, " mm"),
             median("slip_rotation_rad", 57.29577951308232, " deg"), median("force_ratio", 1.0, ""),
             median("reaction_time_s", 1e3, " ms"));
}

using cost::Exploration;
using cost::Price;
using cost::Row;

// Measures in a terminal line, for lack of space. The page and --json have all.
constexpr std::array shown{Measure::onset, Measure::force, Measure::label, Measure::creep, Measure::outcome, Measure::detector};

// Number of settings listed per reason for not running.
constexpr std::size_t most_named = 3;

std::vector<Measure> measures_of(const Exploration& exploration) {
  std::vector<Measure> measures;
  std::ranges::copy_if(shown, std::back_inserter(measures),
                       [&](const Measure measure) { return at(exploration.own().errors, measure).has_value(); });
  return measures;
}

std::string number_text(double number) { return number < 100.0 ? fmt::format("{:.2g}", number) : cost::ratio_text(number); }

std::string error_text(const Errors& errors, Measure measure) {
  const std::optional<MeasureError>& error = at(errors, measure);
  if (!error) return "";
  if (error->different) return "other";
  return error->worst == 0.0 ? "0" : number_text(info_of(measure).factor * error->worst);
}

std::string head_of(Measure measure) { return fmt::format("{} [{}]", info_of(measure).name, info_of(measure).unit); }

void add_row(const Exploration& exploration, const Row& row, const std::vector<Measure>& measures, Table& table) {
  std::vector<std::string> cells{"  " + row.setting.label};
  if (row.ok()) {
    cells.push_back(cost::ratio_text(1.0 / exploration.cost(row)));
    cells.push_back(cost::ratio_text(1e3 * row.cpu->median));
    const double spread = 50.0 * (row.cpu->high - row.cpu->low) / row.cpu->median;
    cells.push_back(std::isnan(spread) ? "" : fmt::format("{:.0f} %", spread));
  } else {
    cells.insert(cells.end(), {std::string(cost::status_name(row.status)), "", ""});
  }
  for (const Measure measure : measures) cells.push_back(row.ok() ? error_text(row.errors, measure) : "");
  table.add(std::move(cells));
}

std::string settings_text(const Exploration& exploration, const Style& style) {
  const std::vector<Measure> measures = measures_of(exploration);
  std::vector<std::string> head{"setting", "times real time", "CPU ms", "+-"};
  for (const Measure measure : measures) head.push_back(head_of(measure));
  Table table(head);
  for (const cost::Series& series : cost::all_series()) {
    bool first = true;
    for (const Row& row : exploration.rows) {
      if (row.setting.series != series.name) continue;
      if (first)
        table.add([&] {
          std::vector<std::string> line(head.size());
          line.front() = series.title;
          return line;
        }());
      first = false;
      add_row(exploration, row, measures, table);
    }
  }
  return table.text(style);
}

// Each reason once, with the first few settings that it affects.
std::string failures_text(const Exploration& exploration, std::size_t width) {
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const Row& row : exploration.rows) {
    if (row.ok()) continue;
    auto reason = std::ranges::find(reasons, row.why, &std::pair<std::string, std::vector<std::string>>::first);
    if (reason == reasons.end()) reason = reasons.insert(reasons.end(), {row.why, {}});
    reason->second.push_back(fmt::format("{} {}", row.setting.series, row.setting.label));
  }
  std::string text;
  for (auto& [why, rows] : reasons) {
    if (rows.size() > most_named) {
      const std::string more = fmt::format("{} more", rows.size() - most_named);
      rows.resize(most_named);
      rows.push_back(more);
    }
    text += wrap_text(fmt::format("{}: {}", fmt::join(rows, "; "), why), width, 2);
  }
  return text;
}

std::string prices_text(const Exploration& exploration, const Style& style) {
  std::vector<Measure> measures = measures_of(exploration);
  measures.push_back(Measure::signal);
  std::vector<std::string> head{"without", "CPU saved", "quartiles"};
  for (const Measure measure : measures) head.push_back(head_of(measure));
  Table table(head);
  for (const Price& price : exploration.prices) {
    std::vector<std::string> cells{price.name};
    if (price.why.empty()) {
      cells.push_back(fmt::format("{:.1f} %", 100.0 * price.share));
      cells.push_back(std::isnan(price.low) ? "" : fmt::format("{:.1f} to {:.1f}", 100.0 * price.low, 100.0 * price.high));
    } else {
      cells.insert(cells.end(), {"does not run", ""});
    }
    for (const Measure measure : measures) cells.push_back(price.why.empty() ? error_text(price.changes, measure) : "");
    table.add(std::move(cells));
  }
  return table.text(style);
}

}  // namespace

std::string eval_text(const Json& result, const Style& style) {
  const Json& all = result.at("all");
  const Json& sensor = result.at("sensor");
  const auto count = [&all](const char* key) { return all.at(key).get<std::size_t>(); };
  std::string text = style.heading(
      fmt::format("{} on {} ({}), labels {}: {}, {}", printable(eval::detector_name(result.at("detector"))),
                  printable(sensor.at("name").get<std::string>()), printable(sensor.at("type").get<std::string>()),
                  result.at("labels").get<std::string>(), counted(count("trials"), "trial"), counted(count("frames"), "sample")));
  text += "\n";
  if (const std::string note = eval::truth_note(result); !note.empty()) text += fmt::format("  {}\n", printable(note));
  if (const std::size_t left_out = result.at("left_out").size(); left_out > 0) {
    text += fmt::format("  {} of the detector's training left out; --all includes them\n", counted(left_out, "trial"));
  }
  for (const std::string& note : eval::frame_notes(result)) text += fmt::format("  {}\n", printable(note));
  for (const Json& warning : result.at("warnings")) text += fmt::format("  warning: {}\n", printable(warning.get<std::string>()));
  if (const std::size_t failed = result.at("failed").get<std::size_t>(); failed > 0)
    text += fmt::format("  {} failed and not evaluated\n", counted(failed, "trial"));
  const eval::Tables tables = eval::tables_of(result);
  text += Table(tables.figures).text(style);
  text += fmt::format("  slipping trials: {}, detected {}, early {}, missed {}; trials without slip: {}, false alarms {}\n",
                      count("slipping") - count("undated"), count("seen"), count("early"), count("missed"),
                      count("trials") - count("slipping"), count("false_alarms"));
  if (const std::size_t undated = count("undated"); undated > 0) {
    text += fmt::format("  {} with a slip whose onset is unknown: no delay, and neither detected, early nor missed\n",
                        counted(undated, "trial"));
  }
  if (const std::size_t unlabelled = count("unlabelled"); unlabelled > 0)
    text += fmt::format("  {} with unknown labels only, in no figure\n", counted(unlabelled, "trial"));
  if (const std::string note = eval::yardstick_note(result); !note.empty()) text += fmt::format("  {}\n", note);
  if (result.contains("loop")) text += loop_text(result.at("loop"));
  text += "\n" + Table(tables.called).text(style);
  for (const page::TextTable& by : tables.by) text += "\n" + Table(by).text(style);
  if (!result.at("worst").empty()) {
    text += "\n" + style.heading("worst trials") + "\n";
    for (const Json& worst : result.at("worst")) {
      text += fmt::format("  trial {}: {}\n", worst.at("trial").get<std::size_t>(), worst.at("why").get<std::string>());
    }
  }
  return text;
}

std::string cost_text(const Exploration& exploration, const Style& style, std::size_t width) {
  std::string text =
      fmt::format("{}\n", style.heading(exploration.description.empty() ? exploration.scene_path : exploration.description));
  for (const std::string& sentence : cost::sentences(exploration)) text += wrap_text(sentence, width, 2);
  text += fmt::format("\n{}", settings_text(exploration, style));
  if (const std::string failures = failures_text(exploration, width); !failures.empty()) {
    text += fmt::format("\n{}\n{}", style.heading("settings without a result"), failures);
  }
  if (!exploration.prices.empty()) {
    text += fmt::format("\n{}\n{}", style.heading("cost and influence of each effect and part of the electronics"),
                        prices_text(exploration, style));
  }
  return text;
}

}  // namespace slipbench

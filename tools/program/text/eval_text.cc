#include "tools/program/text/eval_text.h"

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/program/cli/table.h"
#include "tools/program/eval/evaluate.h"
#include "tools/program/eval/metrics.h"

namespace slipbench {
namespace {

std::string value_text(const Json& value, eval::Figure::Unit unit) {
  if (value.is_null()) return "-";
  const double number = value.get<double>();
  switch (unit) {
    case eval::Figure::Unit::share: return fmt::format("{:.2f} %", 100.0 * number);
    case eval::Figure::Unit::time: return fmt::format("{:.1f} ms", 1e3 * number);
    case eval::Figure::Unit::rate: return fmt::format("{:.2f}", number);
    case eval::Figure::Unit::number: return fmt::format("{:.3f}", number);
  }
  return {};
}

std::string interval_text(const Json& figure, eval::Figure::Unit unit) {
  if (figure.at("low").is_null()) return "-";
  return value_text(figure.at("low"), unit) + " to " + value_text(figure.at("high"), unit);
}

// Figures that exist, with their intervals and, where there is one, the best constant answer.
std::string figures_table(const Json& summary, const Style& style) {
  Table table({"", "value", "95 % by trial", "constant answer"});
  for (const eval::Figure& figure : eval::figures) {
    const std::string key(figure.key);
    const Json& found = summary.at("figures").at(key);
    if (found.at("value").is_null()) continue;
    const Json& constant = summary.at("constant");
    table.add({std::string(figure.name), value_text(found.at("value"), figure.unit), interval_text(found, figure.unit),
               constant.contains(key) ? value_text(constant.at(key), figure.unit) : ""});
  }
  return table.text(style);
}

std::string called_table(const Json& summary, const Style& style) {
  constexpr std::array<std::pair<const char*, const char*>, 4> states{
      {{"no_contact", "no contact"}, {"non_slip", "non-slip"}, {"incipient", "incipient"}, {"gross", "gross"}}};
  std::vector<std::string> head{"true state"};
  for (const auto& [key, name] : states) head.push_back(std::string("called ") + name);
  Table table(std::move(head));
  for (const auto& [key, name] : states) {
    std::vector<std::string> row{name};
    for (const auto& [called, called_name] : states)
      row.push_back(fmt::format("{}", summary.at("called").at(key).at(called).get<std::size_t>()));
    table.add(std::move(row));
  }
  return table.text(style);
}

// One breakdown: its groups by the figures that come first.
std::string groups_table(const Json& by, const Style& style) {
  constexpr std::array<std::string_view, 6> columns{"recall_of_slip", "balanced_slip_accuracy", "delay_median_s", "early",
                                                    "missed",         "false_alarms_per_minute"};
  Table table({"by " + by.at("by").get<std::string>(), "trials", "recall of slip", "slip or not, balanced", "median delay",
               "early", "missed", "false alarms/min"});
  for (const Json& group : by.at("groups")) {
    std::vector<std::string> row{printable(group.at("name").get<std::string>()),
                                 fmt::format("{}", group.at("trials").get<std::size_t>())};
    for (const std::string_view column : columns) {
      for (const eval::Figure& figure : eval::figures) {
        if (figure.key == column) row.push_back(value_text(group.at("figures").at(std::string(column)).at("value"), figure.unit));
      }
    }
    table.add(std::move(row));
  }
  return table.text(style);
}

std::string loop_text(const Json& loop) {
  const std::string detector = printable(loop.at("detector").get<std::string>());
  if (!loop.at("same").get<bool>()) {
    return fmt::format("  the dataset's own loop had the detector {} and saw other classes: its trials say nothing of this one\n",
                       detector);
  }
  std::string text = fmt::format("  the dataset's own loop had this detector ({}): the same classes in every sample\n", detector);
  if (!loop.contains("dropped")) return text;
  const auto median = [&loop](const char* key, double scale, const char* unit) {
    return loop.at(key).is_null() ? std::string("-") : fmt::format("{:.3g}{}", scale * loop.at(key).get<double>(), unit);
  };
  return text + fmt::format(
                    "  in the loop: dropped {} of {}; medians: slip {}, turn {}, greatest force over the least {}, reaction {}\n",
                    loop.at("dropped").get<std::size_t>(), loop.at("trials").get<std::size_t>(),
                    median("slip_translation_m", 1e3, " mm"), median("slip_rotation_rad", 57.29577951308232, " deg"),
                    median("force_ratio", 1.0, ""), median("reaction_time_s", 1e3, " ms"));
}

}  // namespace

std::string eval_text(const Json& result, const Style& style) {
  const Json& all = result.at("all");
  const Json& sensor = result.at("sensor");
  const auto count = [&all](const char* key) { return all.at(key).get<std::size_t>(); };
  std::string text = style.heading(fmt::format(
      "{} on {} ({}), labels {}: {} trials, {} samples", printable(result.at("detector").at("type").get<std::string>()),
      printable(sensor.at("name").get<std::string>()), printable(sensor.at("type").get<std::string>()),
      result.at("labels").get<std::string>(), count("trials"), count("frames")));
  text += "\n";
  if (const std::string note = eval::truth_note(result); !note.empty()) text += fmt::format("  {}\n", printable(note));
  if (const std::size_t left_out = result.at("left_out").size(); left_out > 0) {
    text += fmt::format("  {} trials on which it was trained are left out; --all judges them too\n", left_out);
  }
  if (const std::size_t failed = result.at("failed").get<std::size_t>(); failed > 0)
    text += fmt::format("  {} trials of the dataset failed and are not judged\n", failed);
  text += figures_table(all, style);
  text += fmt::format("  of {} trials that slip: seen {}, early {}, missed {}; of {} that do not: false alarms {}\n",
                      count("slipping"), count("seen"), count("early"), count("missed"), count("trials") - count("slipping"),
                      count("false_alarms"));
  if (result.contains("loop")) text += loop_text(result.at("loop"));
  text += "\n" + called_table(all, style);
  for (const Json& by : result.at("by")) text += "\n" + groups_table(by, style);
  if (!result.at("worst").empty()) {
    text += "\n" + style.heading("look first at") + "\n";
    for (const Json& worst : result.at("worst")) {
      text += fmt::format("  trial {}: {}\n", worst.at("trial").get<std::size_t>(), worst.at("why").get<std::string>());
    }
  }
  return text;
}

}  // namespace slipbench

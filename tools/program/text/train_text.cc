#include "tools/program/text/train_text.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/base/statistics/confusion.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/cli/table.h"
#include "tools/program/train/hd_json.h"

namespace slipbench {
namespace {

constexpr std::array<std::pair<const char*, PadState>, 3> classes{
    {{"non-slip", PadState::non_slip}, {"incipient", PadState::incipient}, {"gross", PadState::gross}}};

std::string percent(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", 100.0 * value); }
std::string percent(const MeanSd& value) { return fmt::format("{} +- {}", percent(value.mean), percent(value.sd)); }
std::string milliseconds(double value) { return std::isnan(value) ? "-" : fmt::format("{:.1f}", 1e3 * value); }

// Accuracy comes last: it goes by what is common.
struct Figure {
  const char* name;
  double (*of)(const Confusion&);
  Confusion Evaluation::*frames;
};
constexpr std::array figures{Figure{"recall of slip", recall_of_slip, &Evaluation::all},
                             Figure{"balanced accuracy", balanced_accuracy, &Evaluation::all},
                             Figure{"balanced accuracy of a constant answer", constant_balanced_accuracy, &Evaluation::all},
                             Figure{"moving frames: recall of slip", recall_of_slip, &Evaluation::moving},
                             Figure{"moving frames: balanced accuracy", balanced_accuracy, &Evaluation::moving},
                             Figure{"accuracy", accuracy, &Evaluation::all},
                             Figure{"accuracy of the best constant answer", constant_accuracy, &Evaluation::all}};

}  // namespace

std::string draws_text(const HdSummary& summary, const Style& style) {
  Table table({"in %", "by sequence", "draw 0", "by frame"});
  for (const Figure& row : figures) {
    const auto figure = [&](const Evaluation& e) { return row.of(e.*row.frames); };
    table.add({row.name, percent(over_draws(summary.by_sequence, figure)), percent(figure(summary.by_sequence.front())),
               percent(over_draws(summary.by_frame, figure))});
  }
  return table.text(style);
}

std::string confusion_text(const Confusion& confusion, const Style& style) {
  Table table({"true class", "called non-slip", "called incipient", "called gross", "recall in %"});
  for (const auto& [name, truth] : classes) {
    std::vector<std::string> row{name};
    for (const auto& [other, called] : classes) {
      row.push_back(std::to_string(confusion[static_cast<std::size_t>(truth)][static_cast<std::size_t>(called)]));
    }
    row.push_back(percent(recall(confusion, truth)));
    table.add(std::move(row));
  }
  return table.text(style);
}

std::string delays_text(const Delays& delays) {
  return fmt::format(
      "  delay from the true onset: median {} ms, quartiles {} and {} ms, of the {} sequences seen\n"
      "  of {} that slip: seen {}, early {} (called slip before the onset), missed {}; of {} that do not: false alarms {}\n",
      milliseconds(median(delays.delay)), milliseconds(quantile(delays.delay, 0.25)), milliseconds(quantile(delays.delay, 0.75)),
      delays.delay.size(), delays.slipping, delays.delay.size(), delays.early, delays.missed, delays.sequences - delays.slipping,
      delays.false_alarms);
}

}  // namespace slipbench

#include "tools/program/text/recipe_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/quantity.h"
#include "tools/base/statistics/confusion.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/train/hd_json.h"

namespace slipbench {
namespace {

constexpr const char* hd_summary = "The hyperdimensional detector of a PapillArray, taught in a single pass; writes a folder";

std::string input_text(const network::Input& input) {
  std::vector<std::string> names;
  for (const network::ChannelPick& pick : input.channels)
    names.push_back(pick.values.empty() ? pick.name : fmt::format("{} values of {}", pick.values.size(), pick.name));
  std::string text =
      fmt::format("{} of a {} at {}", fmt::join(names, ", "), input.sensor, format_quantity(input.rate, Quantity::frequency));
  if (input.median > 1) text += fmt::format(", median of {}", input.median);
  text += fmt::format("; a frame of {} sample{} every {}", input.window, input.window == 1 ? "" : "s", input.stride);
  if (input.centre) text += ", less its mean";
  const std::string band =
      fmt::format("{} to {}", format_quantity(input.low, Quantity::frequency), format_quantity(input.high, Quantity::frequency));
  if (input.transform == network::Transform::log_psd) text += fmt::format(", log10 of its power spectral density, {}", band);
  if (input.transform == network::Transform::amplitude) text += fmt::format(", amplitude of its spectrum, {}", band);
  if (input.transform == network::Transform::units)
    text +=
        ", or of any sensor of three-axis units at 200 Hz or more, as many ms each; each unit for itself: force, ratio, changes";
  if (!input.pixels.empty()) text += fmt::format(", as an image of {} pixels", input.pixels.size());
  return text;
}

std::string scaling_text(train::Scaling scaling) {
  switch (scaling) {
    case train::Scaling::standard: return "each feature to mean 0 and standard deviation 1";
    case train::Scaling::common: return "all features alike, to mean 0 and standard deviation 1";
    case train::Scaling::range: return "each feature to 0 to 1";
  }
  return {};
}

std::string classes_text(const train::Recipe& recipe) {
  std::vector<std::string> names;
  for (const network::Class& one : train::classes_of(recipe.classes, recipe.labels)) names.push_back(one.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string training_text(const train::TrainingOptions& training) {
  std::string text = fmt::format("{} at {:g}, falling to {:g}; {} steps of {} clips of {} answers; {}",
                                 training.optimiser == train::Optimiser::adam ? "Adam" : "RMSProp", training.learning_rate,
                                 training.learning_rate * training.final_rate, training.steps, training.batch, training.clip,
                                 training.balance == train::Balance::drawing ? "classes drawn alike" : "classes weighted alike");
  if (training.onset_frames > 0)
    text += fmt::format("; of a slip the first {} frames and each tenth teach", training.onset_frames);
  if (training.label_smoothing > 0.0) text += fmt::format("; label smoothing {:g}", training.label_smoothing);
  if (training.change_penalty > 0.0)
    text += fmt::format("; change of the logits times {:g} from step {} on", training.change_penalty, training.change_from);
  if (training.patience > 0) text += fmt::format("; ends after {} validations without a better one", training.patience);
  return text;
}

// What is said of a recipe, in order.
std::vector<std::pair<std::string, std::string>> facts_of(const train::Recipe& recipe) {
  return {{"Input", input_text(recipe.input)},
          {"Scaling", scaling_text(recipe.scaling)},
          {"Layers", train::layers_text(recipe.network.layers)},
          {"Networks", fmt::format("{}, of {} parameters", recipe.members, train::parameter_count(recipe.network))},
          {"Answer", fmt::format("{} from {} frame{}{}", classes_text(recipe), train::history_of(recipe.network),
                                 train::history_of(recipe.network) == 1 ? "" : "s",
                                 train::carries_state(recipe.network) ? " and a state carried" : "")},
          {"Training", training_text(recipe.training)},
          {"Labels", hd::name_of(train::label_words, recipe.labels)},
          {"Split", hd::name_of(train::split_words, recipe.split)},
          {"Source", recipe.source},
          {"Assumed", recipe.assumed}};
}

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

std::vector<std::string> recipe_names() {
  std::vector<std::string> names{hd_recipe};
  for (const train::Recipe& recipe : train::recipes()) names.push_back(recipe.name);
  return names;
}

std::string recipe_list_text(const Style& style, std::size_t width) {
  std::size_t column = 0;
  for (const std::string& name : recipe_names()) column = std::max(column, name.size());
  std::string text = fmt::format("{}  {}\n", style.heading("recipes"), style.dim("slipbench train --recipe"));
  const auto add = [&](const std::string& name, const std::string& summary) {
    std::string lines = wrap_text(summary, width, column + 4);
    lines.replace(0, column + 4, fmt::format("  {}{}  ", name, std::string(column - name.size(), ' ')));
    text += lines;
  };
  add(hd_recipe, hd_summary);
  for (const train::Recipe& recipe : train::recipes()) add(recipe.name, recipe.summary);
  return text;
}

Json recipe_list_json() {
  Json list = Json::array();
  list.push_back({{"name", hd_recipe}, {"summary", hd_summary}});
  for (const train::Recipe& recipe : train::recipes()) list.push_back({{"name", recipe.name}, {"summary", recipe.summary}});
  return list;
}

std::string recipe_text(const train::Recipe& recipe, const Style& style, std::size_t width) {
  std::string text =
      fmt::format("{}  {}\n{}", style.heading(recipe.name), style.dim("recipe"), wrap_text(recipe.summary, width, 2));
  for (const auto& [name, fact] : facts_of(recipe)) text += fmt::format("\n{}\n{}", style.bold(name), wrap_text(fact, width, 2));
  text += fmt::format("\n{}\n  slipbench train DATA.h5 --recipe {} -o detector.onnx\n", style.bold("On the command line"),
                      recipe.name);
  return text;
}

Json recipe_json(const train::Recipe& recipe) {
  Json json{{"kind", "recipe"}, {"name", recipe.name}, {"summary", recipe.summary}};
  for (const auto& [name, fact] : facts_of(recipe)) {
    std::string key = name;
    key.front() = static_cast<char>(key.front() - 'A' + 'a');
    json[key] = fact;
  }
  json["parameters"] = train::parameter_count(recipe.network);
  return json;
}

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

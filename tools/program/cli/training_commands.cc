#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/cli/commands.h"
#include "tools/program/cli/table.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/train/train.h"
#include "tools/program/train/training_text.h"
#include "tools/program/train/training_words.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench {
namespace {

constexpr std::array<std::pair<const char*, PadState>, 3> classes{
    {{"non-slip", PadState::non_slip}, {"incipient", PadState::incipient}, {"gross", PadState::gross}}};

std::string percent(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", 100.0 * value); }
std::string percent(const MeanSd& value) { return fmt::format("{} +- {}", percent(value.mean), percent(value.sd)); }
std::string milliseconds(double value) { return std::isnan(value) ? "-" : fmt::format("{:.1f}", 1e3 * value); }

std::string draws_text(const TrainSummary& summary, const Style& style) {
  Table table({"accuracy in %", "by sequence", "draw 0", "by frame"});
  const auto add = [&](const char* name, auto&& figure) {
    table.add({name, percent(over_draws(summary.by_sequence, figure)), percent(figure(summary.by_sequence.front())),
               percent(over_draws(summary.by_frame, figure))});
  };
  add("all frames", [](const Evaluation& e) { return e.all.accuracy(); });
  add("balanced", [](const Evaluation& e) { return e.all.balanced_accuracy(); });
  add("moving frames", [](const Evaluation& e) { return e.moving.accuracy(); });
  add("moving, balanced", [](const Evaluation& e) { return e.moving.balanced_accuracy(); });
  return table.text(style);
}

std::string confusion_text(const ConfusionMatrix& confusion, const Style& style) {
  Table table({"true class", "called non-slip", "called incipient", "called gross", "recall in %"});
  for (const auto& [name, truth] : classes) {
    std::vector<std::string> row{name};
    for (const auto& [other, called] : classes) row.push_back(std::to_string(confusion.count(truth, called)));
    row.push_back(percent(confusion.recall(truth)));
    table.add(std::move(row));
  }
  return table.text(style);
}

std::string delays_text(const Delays& delays) {
  return fmt::format(
      "  first slip called after the true onset: median {} ms, quartiles {} and {} ms, of {} sequences\n"
      "  early {}, missed {}, of {} that slip; false alarms before the onset in {} of {} sequences\n",
      milliseconds(median(delays.delay)), milliseconds(quantile(delays.delay, 0.25)), milliseconds(quantile(delays.delay, 0.75)),
      delays.delay.size(), delays.early, delays.missed, delays.slipping, delays.false_alarms, delays.sequences);
}

std::string result_text(const reproduce::Result& result, const Style& style, std::size_t width) {
  std::string text = style.bold(result.title) + '\n' + wrap_text(result.source, width, 2);
  for (const reproduce::ResultTable& part : result.tables) {
    text += fmt::format("\n{}\n", style.heading(part.title));
    Table table(part.head);
    for (const std::vector<std::string>& row : part.rows) table.add(row);
    text += table.text(style);
    if (!part.note.empty()) text += wrap_text(part.note, width, 2);
  }
  for (const auto& [title, lines] :
       {std::pair{"What differs, and why", &result.remarks}, {"How it was measured", &result.setup}}) {
    if (lines->empty()) continue;
    text += fmt::format("\n{}\n", style.heading(title));
    for (const std::string& line : *lines) text += wrap_text(line, width, 2);
  }
  return text;
}

int list_reproductions(const Options& options) {
  const std::vector<reproduce::Reproduction>& all = reproduce::reproductions();
  if (options.json) {
    nlohmann::ordered_json entries = nlohmann::ordered_json::array();
    for (const reproduce::Reproduction& one : all) entries.push_back({{"name", one.name}, {"summary", one.summary}});
    fmt::print("{}\n", nlohmann::ordered_json{{"reproductions", entries}}.dump());
    return exit_good;
  }
  for (const reproduce::Reproduction& one : all) fmt::print("{:<26}  {}\n", one.name, one.summary);
  return exit_good;
}

// An option that this reproduction has no use for would be a misunderstanding.
void check_reproduce_options(const Options& options, const reproduce::Reproduction& reproduction) {
  const std::array<std::pair<const char*, bool>, 7> given{{{"--data", !options.data.empty()},
                                                           {"--seed", options.seed.has_value()},
                                                           {"--jobs", options.jobs.has_value()},
                                                           {"--synthesise", options.synthesise},
                                                           {"--trials", options.trials.has_value()},
                                                           {"--only", !options.only.empty()},
                                                           {"--memories", !options.memories.empty()}}};
  for (const auto& [name, there] : given) {
    const std::vector<std::string>& takes = reproduction.options;
    if (!there || std::find(takes.begin(), takes.end(), name) != takes.end()) continue;
    throw InputError(fmt::format("reproduce: {} does not take {}; allowed: {}", reproduction.name, name,
                                 takes.empty() ? "--output, --json, --quiet" : fmt::format("{}", fmt::join(takes, ", "))));
  }
}

}  // namespace

int train_command(const Options& options) {
  TrainOptions training;
  training.dataset = options.dataset;
  training.sequences = {options.slip_rule, options.sensor};
  training.model = options.model;
  training.model.compat = options.hd_compat.value_or(training.model.compat);
  training.model.ties = options.hd_ties.value_or(training.model.ties);
  training.quantiser = options.quantiser;
  training.seed = options.seed.value_or(training.seed);
  training.jobs = options.jobs.value_or(0);
  training.output = options.output;
  const TrainSummary summary = train_dataset(training);
  if (options.json) {
    fmt::print("{}\n", train_json(summary, training).dump());
    return exit_good;
  }
  const Style style = style_for(stdout);
  const Evaluation sum = pooled(std::span(summary.by_sequence).subspan(1));
  fmt::print("{}\n{}\n{}\n{}{}\n{} {}\n{} slipbench eval {} --memories {}\n",
             style.heading(fmt::format("{}, labels {}: {} sequences, {} frames", model_name(training.model),
                                       slip_rule_name(training.sequences.labels), summary.sequences, summary.samples)),
             draws_text(summary, style), style.heading("by sequence, the tests of the five draws together"),
             confusion_text(sum.all, style), delays_text(sum.delays), style.good("written:"), training.output, style.dim("next:"),
             training.dataset, training.output);
  return exit_good;
}

int eval_command(const Options& options) {
  EvalOptions judging;
  judging.dataset = options.dataset;
  judging.sequences = {options.slip_rule, options.sensor};
  judging.memories = options.memories;
  judging.jobs = options.jobs.value_or(0);
  const EvalSummary summary = eval_dataset(judging);
  if (options.json) {
    fmt::print("{}\n", eval_json(summary, judging).dump());
    return exit_good;
  }
  const Style style = style_for(stdout);
  const Evaluation& result = summary.evaluation;
  Table table({"accuracy in %", "all frames", "moving frames"});
  table.add({"plain", percent(result.all.accuracy()), percent(result.moving.accuracy())});
  table.add({"balanced", percent(result.all.balanced_accuracy()), percent(result.moving.balanced_accuracy())});
  fmt::print("{}\n  trained on: {}\n{}\n{}{}",
             style.heading(fmt::format("{}, labels {}: {} sequences, {} frames", model_name(summary.model.model),
                                       slip_rule_name(judging.sequences.labels), summary.sequences, result.all.total())),
             summary.model.trained, table.text(style), confusion_text(result.all, style), delays_text(result.delays));
  return exit_good;
}

int reproduce_command(const Options& options) {
  if (options.name.empty() || options.name == "list") return list_reproductions(options);
  const reproduce::Reproduction& reproduction = reproduce::find_reproduction(options.name);
  check_reproduce_options(options, reproduction);
  if (!options.output.empty()) reproduce::check_result_target(options.output);
  reproduce::ReproduceOptions reproducing;
  reproducing.data = options.data;
  reproducing.seed = options.seed;
  reproducing.jobs = options.jobs.value_or(0);
  reproducing.synthesise = options.synthesise;
  reproducing.trials = options.trials.value_or(0);
  reproducing.only = options.only;
  reproducing.memories = options.memories;
  if (!options.quiet && !options.json) {
    reproducing.say = [](const std::string& what) { say(stderr, fmt::format("slipbench: {}\n", what)); };
  }
  reproduce::Result result;
  try {
    result = reproduction.run(reproducing);
  } catch (const reproduce::Interrupted&) {
    say(stderr, "slipbench: interrupted; nothing is kept\n");
    return exit_interrupted;
  }
  std::vector<std::string> files;
  if (!options.output.empty()) files = reproduce::write_result(options.output, reproduction.name, result);
  if (options.json) {
    fmt::print("{}\n", reproduce::result_json(reproduction.name, result).dump());
    return exit_good;
  }
  const Style style = style_for(stdout);
  fmt::print("{}", result_text(result, style, terminal_width(stdout)));
  for (const std::string& file : files) fmt::print("{} {}\n", style.good("written:"), file);
  return exit_good;
}

}  // namespace slipbench

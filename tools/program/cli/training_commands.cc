#include "tools/program/cli/training_commands.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/statistics/confusion.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/table.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/train/training_text.h"
#include "tools/program/train/training_words.h"

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

std::string draws_text(const TrainSummary& summary, const Style& style) {
  Table table({"in %", "by sequence", "draw 0", "by frame"});
  for (const Figure& row : figures) {
    const auto figure = [&](const Evaluation& e) { return row.of(e.*row.frames); };
    table.add({row.name, percent(over_draws(summary.by_sequence, figure)), percent(figure(summary.by_sequence.front())),
               percent(over_draws(summary.by_frame, figure))});
  }
  return table.text(style);
}

std::string figures_text(const Evaluation& evaluation, const Style& style) {
  Table table({"", "in %"});
  for (const Figure& row : figures) table.add({row.name, percent(row.of(evaluation.*row.frames))});
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

// How both read a dataset.
void declare_sequences(Arguments& arguments, SequenceOptions& options) {
  arguments.read("--labels RULE", fmt::format("Truth to learn: {} (default: paper)", fmt::join(slip_rule_names(), ", ")),
                 [&options](const std::string& name) { options.labels = parse_slip_rule(name); });
  arguments.text("--sensor NAME", options.sensor, "The scene's name of the sensor (default: the only one)");
}

}  // namespace

void TrainCommand::declare(Arguments& arguments) {
  arguments.about("train", "Train a slip detector on a dataset", R"(
Trains the hyperdimensional slip detector in a single pass. Six draws are made first, by sequence and, to compare, by frame: within each
compression and speed as many sequences are drawn with replacement as there are; those never drawn are the test. Draw 0 is for
choosing options, the other five make the figures. Then all sequences train the classifier that is saved.

Encoders: shdc (pillars of one frame), sthdc (over a window), gsthdc (with graphs, over a window). --context is gsthdc's default only.
Bundles: paper starts afresh with every frame, published_core keeps the counts of the pillars over a window, as the gripper's core does.
Labels: strict and micro are the truth (a pillar slips as a whole, or in part), paper is the published rule of tip speed;
with has_slipped a pillar that slipped so counts until it loses contact, whether it still moves or not.

Examples:
  slipbench train hexapod.h5 -o memories
  slipbench train hexapod.h5 --encoder shdc --labels strict -o plain)");
  hd::Model& model = options.model;
  arguments.text("FILE", options.dataset, "Dataset (HDF5) with a PapillArray on a stage").required();
  arguments.folder("-o,--output DIR", options.output, "Folder for the memories; always needed").required();
  arguments.word("--encoder NAME", model.encoding, "{} (default: gsthdc)", encoder_words);
  arguments.flag("--context", context, "Bind with the context of the centre pillar's compression (default with gsthdc)");
  arguments.flag("--no-context", no_context, "Do not (default with shdc and sthdc)");
  arguments.number("--dimension D", model.dimension, "Bits of a hypervector, 8 to 65535 (default: 1000)", 8, 65535);
  arguments.number("--window N", model.window, "Frames at 100 Hz, 1 to 1000 (default: 15)", 1, 1000);
  arguments.word("--compat NAME", model.compat, "Whose bundle: {} (default: paper)", hd::compat_words);
  arguments.word("--ties RULE", model.ties, "What an even bundle gives: {} (default: one)", hd::ties_words);
  arguments.word("--quantiser NAME", options.quantiser, "How displacements become levels: {} (default: fixed_point)",
                 hd::quantiser_words);
  arguments.number("--seed N", options.seed, "Seed of item memories and draws (default: 1)", 0);
  declare_sequences(arguments, options.sequences);
  arguments.jobs(options.jobs);
  arguments.then([this, &model] {
    if (context && no_context) throw InputError("train: --context and --no-context exclude each other");
    model.context_driven = context || (model.encoding == hd::Encoding::graph_spatial_temporal && !no_context);
  });
}

int TrainCommand::run() {
  const TrainSummary summary = train_dataset(options);
  if (json) {
    fmt::print("{}\n", train_json(summary, options).dump());
    return exit_good;
  }
  const Style style = style_for(stdout);
  const Evaluation sum = pooled(std::span(summary.by_sequence).subspan(1));
  fmt::print("{}\n{}\n{}\n{}{}\n{} {}\n{} slipbench eval {} --memories {}\n",
             style.heading(fmt::format("{}, labels {}: {} sequences, {} frames", model_name(options.model),
                                       slip_rule_name(options.sequences.labels), summary.sequences, summary.samples)),
             draws_text(summary, style), style.heading("by sequence, the tests of the five draws together"),
             delays_text(sum.delays), confusion_text(sum.all, style), style.good("written:"), options.output, style.dim("next:"),
             options.dataset, options.output);
  return exit_good;
}

void EvalCommand::declare(Arguments& arguments) {
  arguments.about("eval", "Judge a trained slip detector on a dataset", R"(
Judges a trained classifier on every sequence of a dataset, also those that it was trained on, if they are there.
DIR is what `slipbench train` wrote; cl_gst_hd, where no folder has that name, is the classifier that ships with the program.

Examples:
  slipbench eval hexapod.h5 --memories memories
  slipbench eval hexapod.h5 --memories cl_gst_hd
  slipbench eval hexapod.h5 --memories memories --labels strict --json)");
  arguments.text("FILE", options.dataset, "Dataset (HDF5) with a PapillArray on a stage").required();
  arguments.text("--memories DIR", options.memories, "Folder of the classifier, or cl_gst_hd").required();
  declare_sequences(arguments, options.sequences);
  arguments.jobs(options.jobs);
}

int EvalCommand::run() {
  const EvalSummary summary = eval_dataset(options);
  if (json) {
    fmt::print("{}\n", eval_json(summary, options).dump());
    return exit_good;
  }
  const Style style = style_for(stdout);
  const Evaluation& result = summary.evaluation;
  fmt::print(
      "{}\n  trained on: {}\n{}{}\n{}",
      style.heading(fmt::format("{}, labels {}: {} sequences, {} frames", model_name(summary.model.model),
                                slip_rule_name(options.sequences.labels), summary.sequences, samples_in_contact(result.all))),
      printable(summary.model.trained), figures_text(result, style), delays_text(result.delays),
      confusion_text(result.all, style));
  return exit_good;
}

}  // namespace slipbench

#include "sim/core/counted.h"
#include "tools/cli/commands/detectors/detector_commands.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "detectors/hd/words.h"
#include "sim/core/choice.h"
#include "sim/core/quantity.h"
#include "tools/cli/arguments.h"
#include "tools/cli/format/describe.h"
#include "tools/cli/terminal.h"
#include "tools/files/reject.h"
#include "tools/learning_data/label_rules.h"
#include "tools/train/recipe_list.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/workers/python_package/python_package.h"

namespace slipbench {
namespace {

// Returns false alarms per minute from a text such as "1/min".
double alarms_a_minute(const std::string& text) {
  double rate = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  const std::string_view unit(end, text.data() + text.size());
  if (error == std::errc() && rate >= 0.0 && std::isfinite(rate)) {
    if (unit == "/min") return rate;
    if (unit == "/h") return rate / 60.0;
  }
  reject("train: --alarms is {}; expected a rate of 0 or more with its unit, such as 1/min or 10/h", quote(text));
}

// Returns lowest and highest rate [Hz] of a text such as "50 Hz..1 kHz", or "50..1000 Hz" with one unit
// for both.
std::array<double, 2> range_of_rates(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots != std::string::npos) {
    const std::string high = text.substr(dots + 2);
    std::string low = text.substr(0, dots);
    if (low.find_first_not_of("0123456789. ") == std::string::npos)
      low += " " + high.substr(std::min(high.size(), high.find_first_not_of("0123456789. ")));
    try {
      const std::array rates{parse_quantity(low, Quantity::frequency), parse_quantity(high, Quantity::frequency)};
      if (rates[0] > 0.0 && rates[0] <= rates[1] && std::isfinite(rates[1])) return rates;
    } catch (const std::invalid_argument&) {
      // Reported below.
    }
  }
  reject("train: --rates is {}; expected the lowest and the highest rate, such as 50 Hz..1 kHz", quote(text));
}

// Returns `given`. Throws InputError unless it is one of `names`.
std::string checked_labels(const std::string& given, const std::string& recipe, LabelUse use) {
  const std::vector<std::string> names = label_rule_names(use);
  if (std::ranges::find(names, given) != names.end()) return given;
  reject("train: --labels is {} with the recipe {}{}", quote(given), recipe, allowed_names(given, names));
}

// Returns the command that evaluates the trained detector on unseen data. `unseen`: a dataset with
// unseen trials; empty: every trial was used. `part`: the part of the dataset's own split with these
// trials; empty: the dataset has no split.
std::string next_text(const Style& style, const std::string& output, const std::string& unseen, const std::string& part,
                      const std::string& options) {
  const std::string eval = style.dim("next:") + " " + as_called("slipbench eval " + shell_word(output));
  if (!unseen.empty()) return eval + " " + shell_word(unseen) + options + (part.empty() ? "" : " --split " + part);
  return eval + " NEW.h5" + options + "  # NEW.h5: trials outside the training, such as a sweep with another --seed";
}

}  // namespace

void TrainCommand::declare(Arguments& arguments) {
  arguments.about("train", "Train a slip detector on a dataset",
                  fmt::format(R"(
Trains the hyperdimensional detector of a PapillArray (recipe gst_hd, the default) or a network
(all other recipes of `slipbench list recipes`). The output records the trials that it was trained
on, and `eval` leaves them out.

Data: if the dataset has a split, gst_hd trains on the part train. A network trains on train, chooses
its state on valid (or on a fifth of train, if valid is empty) and is tested on test. Without a split,
or with --all, a fifth of the trials is held out for the test of a network, and a fifth of the rest
for validation. With --split, a fifth of the materials, objects or octaves of speed is held out.

gst_hd makes one pass over the data. It first draws six random partitions by sequence and, for
comparison, six by frame. A draw takes from each combination of compression and speed as many
sequences as there are, with replacement; sequences that are not drawn are the test set. Use draw 0
to choose options; draws 1 to 5 give the printed figures. The saved classifier is trained on all
sequences. --epochs adds passes that correct misclassified frames; the paper has no such passes.
--encoder: shdc encodes the pillars of one frame, sthdc the pillars of a window, gsthdc graphs of
the pillars over a window. --compat: paper bundles each frame anew, published_core keeps the counts
of the pillars over a window.

The output of a network is an ONNX file with the complete detector, including its operating point:
the threshold, the consecutive frames that begin and end an alarm, and the minimum duration of an
alarm. On the validation trials, training chooses the operating point with the highest balanced
accuracy and at most --alarms false alarms. With --score it chooses the operating point with which
the first FILE has the highest score of the open recordings of slip-3 (`slipbench benchmark`). The
score depends on the distance that the object has slipped at the alarm. The choice is limited to
operating points that raise no alarm in --specificity percent of the trials without slip, in each
FILE (also of --with) with 20 such validation trials or more. If there is no such point, the nearest
one is chosen. For gst_hd these options choose only the frames that begin and end an alarm, on draw
0. A network is trained on one thread. --resume continues a killed training with a bit-identical
result.

Labels of gst_hd:
{}
Labels of networks:
{}
Examples:
  slipbench train hexapod.h5 -o memories
  slipbench train hexapod.h5 --encoder shdc --labels strict -o plain
  slipbench train hexapod.h5 --recipe papillarray_gru --steps 20 -o detector.onnx)",
                              label_rules_text(LabelUse::pillars), label_rules_text(LabelUse::training)));
  arguments.input("FILE", options.dataset, "Dataset (HDF5); gst_hd: with a PapillArray on a stage or in a grasp", ".h5")
      .required();
  arguments.file("-o,--output PATH", options.output, "Folder for the memories of gst_hd, or ONNX file for a network (required)")
      .required();
  arguments.text("--recipe NAME", recipe_, "What to train: `slipbench list recipes` (default: gst_hd)")
      .offers(train::recipe_names);
  arguments.text(
      "--labels RULE", labels_,
      fmt::format("Labels. gst_hd: {} (default: paper). Network: {} (default: of the recipe)",
                  fmt::join(label_rule_names(LabelUse::pillars), ", "), fmt::join(label_rule_names(LabelUse::training), ", ")));
  arguments.text("--sensor NAME", options.sequences.sensor,
                 "Name of the sensor in the scene (default: the only one; network: every sensor that fits)");
  arguments.number("--seed N", options.seed, "Seed of weights, memories and draws (default: 1)", 0);
  arguments.word("--split FACT", split_,
                 "Network: property by which training and test are separated: {} (default: of the recipe)", train::split_words);
  arguments.number("--held-out PERCENT", held_out_, "Network: share of the trials for the test, 0 to 50 (default: 20)", 0, 50);
  arguments.number("--steps N", steps_, "Network: training steps (default: of the recipe)", 1, 10'000'000);
  arguments.number("--turned N", turned_, "Network of a Myrmex: copies of each trial with rotated images, 0 to 11 (default: 0)",
                   0, 11);
  arguments.text("--rates LOW..HIGH", rates_,
                 "Network: draw the rate of each trial from this range, e.g. '50 Hz..1 kHz' (default: rate of the recipe)");
  arguments.text("--alarms RATE", alarms_,
                 "Maximum rate of false alarms on the validation trials (default: 1/min; gst_hd: no operating point is chosen)");
  arguments.flag("--score", score_, "Instead of --alarms: operating point with the highest score of open recordings");
  arguments.number("--specificity N", specificity_,
                   "With --score: least percentage of trials without slip that raise no alarm, 0 to 100 (default: 95)", 0, 100);
  arguments.lines("--with FILE", with_, "Another dataset for training, e.g. of grasps; repeatable");
  arguments.flag("--all", all_,
                 "Ignore the split of the dataset (/mask): gst_hd trains on all trials, a network divides them anew");
  arguments.flag("--resume", resume_, "Network: continue a killed training from OUTPUT.checkpoint-0");
  arguments.word("--encoder NAME", encoding_, "gst_hd: {} (default: gsthdc)", encoder_words);
  arguments.flag("--context", context_, "gst_hd: use the compression of the centre pillar as context (default with gsthdc)");
  arguments.flag("--no-context", no_context_, "gst_hd: use no context (default with shdc and sthdc)");
  arguments.number("--dimension D", dimension_, "gst_hd: bits of a hypervector, 8 to 65535 (default: 1000)", 8, 65535);
  arguments.number("--window N", window_, "gst_hd: frames in a window at 100 Hz, 1 to 1000 (default: 15)", 1, 1000);
  arguments.number("--epochs N", epochs_,
                   "gst_hd: additional passes that correct misclassified frames (not in the paper), 0 to 1000 (default: 0)", 0,
                   1000);
  arguments.word("--compat NAME", compat_, "gst_hd: bundling: {} (default: paper)", hd::compat_words);
  arguments.word("--ties RULE", ties_, "gst_hd: bit of a bundle whose sum is zero: {} (default: one)", hd::ties_words);
  arguments.word("--quantiser NAME", quantiser_, "gst_hd: quantisation of displacements to levels: {} (default: fixed_point)",
                 hd::quantiser_words);
  arguments.jobs(jobs_, "gst_hd: worker threads, 1 to 1024 (default: one per hardware thread)");
  arguments.then([this] {
    if (score_ && !alarms_.empty()) throw InputError("train: give either --score or --alarms");
    if (specificity_ && !score_) throw InputError("train: --specificity needs --score");
    recipe_.empty() || recipe_ == train::hd_recipe ? read_hd() : read_network();
  });
}

void TrainCommand::read_hd() {
  for (const auto& [given, name] : {std::pair{split_.has_value(), "--split"},
                                    {held_out_.has_value(), "--held-out"},
                                    {steps_.has_value(), "--steps"},
                                    {turned_.has_value(), "--turned"},
                                    {!rates_.empty(), "--rates"},
                                    {resume_, "--resume"}}) {
    if (given) reject("train: {} applies only to networks, that is to recipes other than gst_hd", name);
  }
  if (context_ && no_context_) throw InputError("train: give either --context or --no-context");
  if (!labels_.empty()) options.sequences.labels = parse_label_rule(checked_labels(labels_, train::hd_recipe, LabelUse::pillars));
  hd::Model& model = options.model;
  model.encoding = encoding_.value_or(model.encoding);
  model.dimension = dimension_.value_or(model.dimension);
  model.window = window_.value_or(model.window);
  model.compat = compat_.value_or(model.compat);
  model.ties = ties_.value_or(model.ties);
  options.quantiser = quantiser_.value_or(options.quantiser);
  options.epochs = epochs_.value_or(options.epochs);
  options.with = with_;
  options.all = all_;
  options.point = score_ || !alarms_.empty();
  if (!alarms_.empty()) options.alarms = alarms_a_minute(alarms_);
  if (specificity_) options.specificity = static_cast<double>(*specificity_) / 100.0;
  options.jobs = jobs_.value_or(options.jobs);
  model.context_driven = context_ || (model.encoding == hd::Encoding::graph_spatial_temporal && !no_context_);
}

void TrainCommand::read_network() {
  train::check_recipe(recipe_);
  for (const auto& [given, name] : {std::pair{encoding_.has_value(), "--encoder"},
                                    {context_, "--context"},
                                    {no_context_, "--no-context"},
                                    {dimension_.has_value(), "--dimension"},
                                    {window_.has_value(), "--window"},
                                    {epochs_.has_value(), "--epochs"},
                                    {compat_.has_value(), "--compat"},
                                    {ties_.has_value(), "--ties"},
                                    {quantiser_.has_value(), "--quantiser"},
                                    {jobs_.has_value(), "--jobs"}}) {
    if (given) reject("train: {} applies only to gst_hd, not to --recipe {}", name, recipe_);
  }
  std::vector<std::string> datasets{options.dataset};
  datasets.insert(datasets.end(), with_.begin(), with_.end());
  request = Json{{"datasets", datasets},
                 {"recipe", recipe_},
                 {"labels", Json()},
                 {"split", Json()},
                 {"held_out", Json()},
                 {"sensor", options.sequences.sensor},
                 {"all", all_},
                 {"seed", options.seed},
                 {"steps", or_null(steps_)},
                 {"turned", or_null(turned_)},
                 {"rates", rates_.empty() ? Json() : Json(range_of_rates(rates_))},
                 {"alarms", Json()},
                 {"by_score", score_},
                 {"specificity", Json()},
                 {"output", options.output},
                 {"resume", resume_}};
  if (!labels_.empty()) request["labels"] = checked_labels(labels_, recipe_, LabelUse::training);
  if (split_) request["split"] = choice_name(train::split_words, *split_);
  if (held_out_) request["held_out"] = 0.01 * static_cast<double>(*held_out_);
  if (!alarms_.empty()) request["alarms"] = alarms_a_minute(alarms_);
  if (specificity_) request["specificity"] = static_cast<double>(*specificity_) / 100.0;
  if (!options.output.ends_with(".onnx"))
    reject("train: -o {}: a network is an ONNX file, whose name must end with .onnx", options.output);
}

int TrainCommand::run() {
  if (request.is_null()) return train_hd();
  const PythonModule module("slipbench._train", "train --recipe " + recipe_, "");
  take_stdout_back();
  request["json"] = json;
  module.start(request);
}

int TrainCommand::train_hd() {
  const HdSummary summary = slipbench::train_hd(options);
  if (json) return print_json(train_json(summary, options));
  const Style style = style_for(stdout);
  const Evaluation sum = pooled(std::span(summary.by_sequence).subspan(1));
  const std::string point =
      options.point
          ? fmt::format(
                "operating point: slip is reported after {} of slip in succession, for at least {}, until {} in succession without slip (not included above)\n",
                counted(static_cast<std::size_t>(summary.alarm.on), "frame"), summary.alarm.least,
                counted(static_cast<std::size_t>(summary.alarm.off), "frame"))
          : "";
  const std::string learnt =
      summary.own_split ? fmt::format("trained on {} of {}, the part train of the dataset's split; --all trains on all trials\n",
                                      summary.sequences, counted(summary.trials, "trial"))
                        : "";
  print_text(
      "{}\n{}\n{}\n{}{}\n{}{}{} {}\n{}\n",
      style.heading(fmt::format("{}, labels {}: {}, {}", model_name(options.model), label_rule_name(options.sequences.labels),
                                counted(summary.sequences, "sequence"), counted(summary.samples, "frame"))),
      draws_text(summary, style), style.heading("by sequence, tests of draws 1 to 5 together"), delays_text(sum.delays),
      confusion_text(sum.all, style), learnt, point, style.good("written:"), options.output,
      next_text(style, options.output, summary.test, "test",
                fmt::format(" --sensor {} --labels {}", shell_word(summary.sensor), label_rule_name(options.sequences.labels))));
  return exit_good;
}

}  // namespace slipbench

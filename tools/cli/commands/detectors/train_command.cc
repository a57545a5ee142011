#include "tools/cli/commands/detectors/detector_commands.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "detectors/hd/words.h"
#include "sim/core/choice.h"
#include "tools/cli/arguments.h"
#include "tools/cli/format/describe.h"
#include "tools/cli/terminal.h"
#include "tools/files/reject.h"
#include "tools/train/recipe_list.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/workers/python_package/python_package.h"

namespace slipbench {
namespace {

// False alarms a minute, of a text as 1/min.
double alarms_a_minute(const std::string& text) {
  double rate = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  const std::string_view unit(end, text.data() + text.size());
  if (error == std::errc() && rate >= 0.0 && std::isfinite(rate)) {
    if (unit == "/min") return rate;
    if (unit == "/h") return rate / 60.0;
  }
  reject("train: --alarms is {}; allowed: a number from 0 on and its unit, as 1/min or 10/h", quote(text));
}

// One of `names`.
std::string checked_labels(const std::string& given, const std::string& recipe, const std::vector<std::string>& names) {
  if (std::ranges::find(names, given) != names.end()) return given;
  reject("train: --labels is {} with the recipe {}{}", quote(given), recipe, allowed_names(given, names));
}

// The command that judges what was trained, on data that it has not seen. `unseen`: a dataset with
// such trials; empty: there is none. `part`: of the dataset's own split, which they are; empty: it
// has none.
std::string next_text(const Style& style, const std::string& output, const std::string& unseen, const std::string& part,
                      const std::string& options) {
  const std::string eval = style.dim("next:") + " " + as_called("slipbench eval " + shell_word(output));
  if (!unseen.empty()) return eval + " " + shell_word(unseen) + options + (part.empty() ? "" : " --split " + part);
  return eval + " NEW.h5" + options + "  # NEW.h5: trials not learnt from, such as those of a sweep with another --seed";
}

}  // namespace

void TrainCommand::declare(Arguments& arguments) {
  arguments.about("train", "Train a slip detector on a dataset", R"(
Without --recipe, and with --recipe gst_hd, trains the hyperdimensional slip detector of a PapillArray in a single pass. Six
draws are made first, by sequence and, to compare, by frame: within each compression and speed as many sequences are drawn with
replacement as there are; those never drawn are the test. Draw 0 is for choosing options, the other five make the figures. Then all
sequences train the classifier that is saved. With --epochs mistakes teach in place of that single pass: every epoch judges all frames in a
drawn order, adds those called wrongly, or rightly by a small margin, to their class and takes them from the nearest other. The paper has
none. With --score or --alarms draw 0 chooses how many frames in a row begin and end an alarm.

Encoders: shdc (pillars of one frame), sthdc (over a window), gsthdc (with graphs, over a window). --context is gsthdc's default only.
Bundles: paper starts afresh with every frame, published_core keeps the counts of the pillars over a window, as the gripper's core does.

A dataset's own split counts: gst_hd learns from its part train alone; a network learns from train, validates on valid (a fifth of train where
valid is empty) and is judged on test. --all does without it. What is trained records the trials that it has seen, and `eval` leaves them out.

Any other recipe (`slipbench list recipes`) is a network. With --all, or of a dataset without a split, what judges is held out first: a fifth of the trials, or of the materials,
objects or octaves of speed that --split names. A fifth of the rest chooses the best state and the operating point: threshold, frames in a row
that begin and end an alarm and the least it lasts, of the greatest balanced accuracy with no more false alarms a minute than --alarms, or of
the greatest score of open recordings (`slipbench benchmark`) with --score. The ONNX file is a whole detector, and says what it has seen. A killed training goes on with --resume, to the same bytes. One thread, one network at a time.

Labels: strict and micro are the truth (a unit slips as a whole, or in part), paper is the rule of the sensor's paper. Of networks:
latched is micro, and slip until contact is lost; masked leaves out frames that stick again after a slip, tightened does so on a stage alone. Of gst_hd: with has_slipped
a pillar that slipped by the paper's rule so counts until it loses contact.

Examples:
  slipbench train hexapod.h5 -o memories
  slipbench train hexapod.h5 --encoder shdc --labels strict -o plain
  slipbench train hexapod.h5 --recipe papillarray_gru --steps 20 -o detector.onnx)");
  arguments.input("FILE", options.dataset, "Dataset (HDF5); of gst_hd with a PapillArray, on a stage or in a grasp", ".h5")
      .required();
  arguments.file("-o,--output PATH", options.output, "Folder for the memories of gst_hd, ONNX file of a network; always needed")
      .required();
  arguments.text("--recipe NAME", recipe_, "What is taught: `slipbench list recipes` (default: gst_hd)")
      .offers(train::recipe_names);
  arguments.text(
      "--labels RULE", labels_,
      "Truth to learn: paper, has_slipped, strict, micro of gst_hd (default: paper); micro, strict, paper, latched, masked, tightened, recorded of a network "
      "(default: the recipe's)");
  arguments.text("--sensor NAME", options.sequences.sensor,
                 "The scene's name of the sensor (default: the only one; of a network every one that fits)");
  arguments.number("--seed N", options.seed, "Seed of weights, memories and draws (default: 1)", 0);
  arguments.word("--split FACT", split_, "Network: what learns and judges differ in: {} (default: the recipe's)",
                 train::split_words);
  arguments.number("--held-out PERCENT", held_out_, "Network: trials that judge, 0 to 50 (default: 20)", 0, 50);
  arguments.number("--steps N", steps_, "Network: steps of training (default: the recipe's)", 1, 10'000'000);
  arguments.number("--turned N", turned_,
                   "Network of a Myrmex: copies of each trial with its images turned, 0 to 11 (default: 0)", 0, 11);
  arguments.text("--alarms RATE", alarms_,
                 "False alarms that are tolerated in the trials that validate (default: 1/min; of gst_hd none is chosen)");
  arguments.flag("--score", score_, "In place of --alarms, the operating point of the greatest score of open recordings");
  arguments.lines("--with FILE", with_, "One more dataset, such as of grasps beside a stage; may be repeated");
  arguments.flag("--all", all_,
                 "Learn from every trial, whatever a dataset's own split (/mask) says; a network divides them anew");
  arguments.flag("--resume", resume_, "Network: go on where a killed training left OUTPUT.checkpoint-0");
  arguments.word("--encoder NAME", encoding_, "gst_hd: {} (default: gsthdc)", encoder_words);
  arguments.flag("--context", context_, "gst_hd: bind with the context of the centre pillar's compression (default with gsthdc)");
  arguments.flag("--no-context", no_context_, "gst_hd: do not (default with shdc and sthdc)");
  arguments.number("--dimension D", dimension_, "gst_hd: bits of a hypervector, 8 to 65535 (default: 1000)", 8, 65535);
  arguments.number("--window N", window_, "gst_hd: frames at 100 Hz, 1 to 1000 (default: 15)", 1, 1000);
  arguments.number("--epochs N", epochs_, "gst_hd: passes over the mistakes in place of the paper's one, 0 to 1000 (default: 0)",
                   0, 1000);
  arguments.word("--compat NAME", compat_, "gst_hd: whose bundle: {} (default: paper)", hd::compat_words);
  arguments.word("--ties RULE", ties_, "gst_hd: what an even bundle gives: {} (default: one)", hd::ties_words);
  arguments.word("--quantiser NAME", quantiser_, "gst_hd: how displacements become levels: {} (default: fixed_point)",
                 hd::quantiser_words);
  arguments.jobs(jobs_, "gst_hd: worker threads, 1 to 1024 (default: one a hardware thread)");
  arguments.then([this] {
    if (score_ && !alarms_.empty()) throw InputError("train: --score and --alarms are two choices; allowed: one of them");
    recipe_.empty() || recipe_ == train::hd_recipe ? read_hd() : read_network();
  });
}

void TrainCommand::read_hd() {
  for (const auto& [given, name] : {std::pair{split_.has_value(), "--split"},
                                    {held_out_.has_value(), "--held-out"},
                                    {steps_.has_value(), "--steps"},
                                    {turned_.has_value(), "--turned"},
                                    {resume_, "--resume"}}) {
    if (given) reject("train: {} is of networks; allowed: it with another --recipe than gst_hd", name);
  }
  if (context_ && no_context_) throw InputError("train: --context and --no-context exclude each other");
  if (!labels_.empty()) options.sequences.labels = parse_slip_rule(checked_labels(labels_, train::hd_recipe, slip_rule_names()));
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
    if (given) reject("train: {} is of gst_hd; allowed: it without --recipe {}", name, recipe_);
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
                 {"alarms", Json()},
                 {"by_score", score_},
                 {"output", options.output},
                 {"resume", resume_}};
  if (!labels_.empty()) request["labels"] = checked_labels(labels_, recipe_, choice_names(train::label_words));
  if (split_) request["split"] = choice_name(train::split_words, *split_);
  if (held_out_) request["held_out"] = 0.01 * static_cast<double>(*held_out_);
  if (!alarms_.empty()) request["alarms"] = alarms_a_minute(alarms_);
  if (!options.output.ends_with(".onnx"))
    reject("train: -o {}: a network is an ONNX file; allowed: a name that ends with .onnx", options.output);
}

int TrainCommand::run() {
  if (request.is_null()) return train_hd();
  const PythonModule module("slipbench._train", "train --recipe " + recipe_, "");
  take_stdout_back();
  request["json"] = json;
  module.start(request.dump());
}

int TrainCommand::train_hd() {
  const HdSummary summary = slipbench::train_hd(options);
  if (json) return print_json(train_json(summary, options));
  const Style style = style_for(stdout);
  const Evaluation sum = pooled(std::span(summary.by_sequence).subspan(1));
  const std::string point =
      options.point
          ? fmt::format(
                "slip from {} frames in a row on, for {} frames and until {} do not slip; the figures above are without\n",
                summary.alarm.on, summary.alarm.least, summary.alarm.off)
          : "";
  const std::string learnt =
      summary.own_split
          ? fmt::format("learnt from {} of {} trials: the part train of the dataset's own split; --all learns from every trial\n",
                        summary.sequences, summary.trials)
          : "";
  fmt::print(
      "{}\n{}\n{}\n{}{}\n{}{}{} {}\n{}\n",
      style.heading(fmt::format("{}, labels {}: {} sequences, {} frames", model_name(options.model),
                                slip_rule_name(options.sequences.labels), summary.sequences, summary.samples)),
      draws_text(summary, style), style.heading("by sequence, the tests of the five draws together"), delays_text(sum.delays),
      confusion_text(sum.all, style), learnt, point, style.good("written:"), options.output,
      next_text(style, options.output, summary.test, "test",
                fmt::format(" --sensor {} --labels {}", shell_word(summary.sensor), slip_rule_name(options.sequences.labels))));
  return exit_good;
}

}  // namespace slipbench

#include "tools/cli/commands/detectors/detector_commands.h"

#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "detectors/hd/words.h"
#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "tools/cli/arguments.h"
#include "tools/cli/format/describe.h"
#include "tools/cli/terminal.h"
#include "tools/learning_data/label_rules.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {
namespace {

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

void TrainHdCommand::declare(Arguments& arguments) {
  arguments.about("train-hd", "Train the hyperdimensional slip detector",
                  fmt::format(R"(
Trains the memories of the detector gst_hd of a PapillArray and writes them as a folder, which records
the trials that it was trained on; `eval` leaves them out. If the dataset has a split, only the part
train is used.

Training makes one pass over the data. It first draws six random partitions by sequence and, for
comparison, six by frame. A draw takes from each combination of compression and speed as many
sequences as there are, with replacement; sequences that are not drawn are the test set. Use draw 0
to choose options; draws 1 to 5 give the printed figures. The saved classifier is trained on all
sequences. --epochs adds passes that correct misclassified frames; the paper has no such passes.
--encoder: shdc encodes the pillars of one frame, sthdc the pillars of a window, gsthdc graphs of
the pillars over a window. --compat: paper bundles each frame anew, published_core keeps the counts
of the pillars over a window.

--alarms or --score choose, on draw 0, how many consecutive frames begin and end an alarm:
--alarms for the highest balanced accuracy with at most this rate of false alarms, --score for the
highest score of the open recordings of slip-4 (`slipbench benchmark`), among those that raise no
alarm in --specificity percent of the trials without slip.

Labels:
{}
Examples:
  slipbench train-hd hexapod.h5 -o memories
  slipbench train-hd hexapod.h5 --encoder shdc --labels strict -o plain)",
                              label_rules_text(LabelUse::pillars)));
  arguments.input("FILE", options.dataset, "Dataset (HDF5) with a PapillArray on a stage or in a grasp", ".h5").required();
  arguments.file("-o,--output DIR", options.output, "Folder for the memories (required)").required();
  arguments.text("--labels RULE", labels_,
                 fmt::format("Labels: {} (default: paper)", fmt::join(label_rule_names(LabelUse::pillars), ", ")));
  arguments.text("--sensor NAME", options.sequences.sensor, "Name of the sensor in the scene (default: the only one)");
  arguments.number("--seed N", options.seed, "Seed of memories and draws (default: 1)", 0);
  point_.declare(arguments, "no operating point is chosen");
  arguments.lines("--with FILE", options.with, "Another dataset for training, e.g. of grasps; repeatable");
  arguments.flag("--all", options.all, "Ignore the split of the dataset (/mask) and train on all trials");
  arguments.word("--encoder NAME", options.model.encoding, "{} (default: gsthdc)", encoder_words);
  arguments.flag("--context", context_, "Use the compression of the centre pillar as context (default with gsthdc)");
  arguments.flag("--no-context", no_context_, "Use no context (default with shdc and sthdc)");
  arguments.number("--dimension D", options.model.dimension, "Bits of a hypervector, 8 to 65535 (default: 1000)", 8, 65535);
  arguments.number("--window N", options.model.window, "Frames in a window at 100 Hz, 1 to 1000 (default: 15)", 1, 1000);
  arguments.number("--epochs N", options.epochs,
                   "Additional passes that correct misclassified frames (not in the paper), 0 to 1000 (default: 0)", 0, 1000);
  arguments.word("--compat NAME", options.model.compat, "Bundling: {} (default: paper)", hd::compat_words);
  arguments.word("--ties RULE", options.model.ties, "Bit of a bundle whose sum is zero: {} (default: one)", hd::ties_words);
  arguments.word("--quantiser NAME", options.quantiser, "Quantisation of displacements to levels: {} (default: fixed_point)",
                 hd::quantiser_words);
  arguments.jobs(options.jobs);
  arguments.then([this] { read(); });
}

void TrainHdCommand::read() {
  point_.read("train-hd");
  if (context_ && no_context_) throw InputError("train-hd: give either --context or --no-context");
  if (!labels_.empty()) options.sequences.labels = labels_of("train-hd", labels_, LabelUse::pillars);
  options.point = point_.score || point_.alarms;
  options.alarms = point_.alarms;
  options.specificity = point_.specificity.value_or(options.specificity);
  hd::Model& model = options.model;
  model.context_driven = context_ || (model.encoding == hd::Encoding::graph_spatial_temporal && !no_context_);
}

int TrainHdCommand::run() {
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

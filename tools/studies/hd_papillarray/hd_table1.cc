// Table I of the paper: sHDC, stHDC, gstHDC and CL-gstHDC on a fresh dataset of the published protocol, and what decides the outcome.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "tools/base/files/output_file.h"
#include "tools/program/train/train_hd.h"
#include "tools/studies/grid.h"
#include "tools/studies/hd_papillarray/hd_tables.h"

namespace slipbench::reproduce {
namespace {

// Which frames are learnt from and judged.
enum class KeptFrames {
  all,
  until_stop,  // nothing after the motion has ended
  moving,      // nothing before it has begun either
};

// One way to make the data, to label it and to encode it.
struct EncoderVariant {
  std::string name;
  std::vector<Override> overrides = {};  // of the scene
  SlipRule labels = SlipRule::paper;
  hd::Quantiser quantiser = hd::Quantiser::fixed_point;
  hd::Model model = {};
  std::uint64_t other_memories = 0;  // added to the seed of the item memories
  KeptFrames keep = KeptFrames::all;
  std::size_t epochs = 0;
};

const Override wide_friction{"sweep.friction.scale", "{draw: lognormal, median: 1, sd: 0.3}"};
const Override wide_tilt_x{"sweep.motion.tilt.0", "{draw: normal, mean: 0 deg, sd: 2 deg, min: -4 deg, max: 4 deg}"};
const Override wide_tilt_y{"sweep.motion.tilt.1", "{draw: normal, mean: 0 deg, sd: 2 deg, min: -4 deg, max: 4 deg}"};
const Override wide_preload{"sweep.motion.compression", "{draw: uniform, min: 0.5 mm, max: 1.5 mm}"};
const Override four_draws{"sweep.trials", "4"};  // of each motion where compressions are drawn: 200 sequences again

std::string overrides_key(const std::vector<Override>& overrides) {
  std::string key;
  for (const Override& entry : overrides) key += entry.path + "=" + entry.value + "\n";
  return key;
}

// What is left out is labelled like frames that do not touch: neither learnt nor judged.
void leave_out(Sequence& sequence, KeptFrames keep) {
  if (keep == KeptFrames::all) return;
  const auto first = std::find(sequence.moving.begin(), sequence.moving.end(), 1) - sequence.moving.begin();
  const auto after = sequence.moving.rend() - std::find(sequence.moving.rbegin(), sequence.moving.rend(), 1);
  if (keep == KeptFrames::moving) std::fill_n(sequence.label.begin(), first, PadState::no_contact);
  std::fill(sequence.label.begin() + after, sequence.label.end(), PadState::no_contact);
}

// sHDC, stHDC, gstHDC and CL-gstHDC, all else as in `base`.
std::array<hd::Model, 4> ablation(const hd::Model& base) {
  std::array<hd::Model, 4> models{base, base, base, base};
  models[0].encoding = hd::Encoding::spatial;
  models[1].encoding = hd::Encoding::spatial_temporal;
  models[2].encoding = models[3].encoding = hd::Encoding::graph_spatial_temporal;
  for (std::size_t i = 0; i < 3; ++i) models[i].context_driven = false;
  models[3].context_driven = true;
  return models;
}

// What differs between sequences; all of them need data of their own.
std::vector<EncoderVariant> scatter_variants() {
  return {
      {"none", {{"friction.scale", "1"}}},
      {"friction 7 % (hexapod.yaml)", {}},
      {"friction 30 %", {wide_friction}},
      {"friction 7 %, tilt 2 deg", {wide_tilt_x, wide_tilt_y}},
      {"friction 7 %, preload 0.5 to 1.5 mm", {wide_preload, four_draws}},
      {"friction 30 %, tilt 2 deg, preload 0.5 to 1.5 mm", {wide_friction, wide_tilt_x, wide_tilt_y, wide_preload, four_draws}}};
}

// One thing changed at a time.
std::vector<EncoderVariant> cause_variants() {
  std::vector<EncoderVariant> all;
  const auto add = [&all](std::string name, auto&& change) {
    EncoderVariant variant;
    variant.name = std::move(name);
    change(variant);
    all.push_back(std::move(variant));
  };
  add("as published", [](EncoderVariant&) {});
  add("labels strict", [](EncoderVariant& v) { v.labels = SlipRule::strict; });
  add("labels micro", [](EncoderVariant& v) { v.labels = SlipRule::micro; });
  add("labels has_slipped", [](EncoderVariant& v) { v.labels = SlipRule::has_slipped; });
  add("without the rest after a stop", [](EncoderVariant& v) { v.keep = KeptFrames::until_stop; });
  add("moving frames alone", [](EncoderVariant& v) { v.keep = KeptFrames::moving; });
  add("feature exact, from 1/8 mm", [](EncoderVariant& v) { v.quantiser = hd::Quantiser::exact; });
  add("feature unrounded", [](EncoderVariant& v) { v.quantiser = hd::Quantiser::unrounded; });
  add("retrained, 5 epochs", [](EncoderVariant& v) { v.epochs = 5; });
  add("retrained, 5 epochs, without the rest after a stop", [](EncoderVariant& v) {
    v.epochs = 5;
    v.keep = KeptFrames::until_stop;
  });
  add("window 1 frame", [](EncoderVariant& v) { v.model.window = 1; });
  add("window 5 frames", [](EncoderVariant& v) { v.model.window = 5; });
  add("window 30 frames", [](EncoderVariant& v) { v.model.window = 30; });
  add("counts kept in the window (published core)", [](EncoderVariant& v) { v.model.compat = hd::Compat::published_core; });
  add("ties to zero", [](EncoderVariant& v) { v.model.ties = hd::Ties::zero; });
  add("D = 4000", [](EncoderVariant& v) { v.model.dimension = 4000; });
  add("other item memories", [](EncoderVariant& v) { v.other_memories = 1000; });
  add("electronics ideal", [](EncoderVariant& v) { v.overrides = {{"sensors.pad.electronics", "ideal"}}; });
  add("stiff pillars (profile gripper)", [](EncoderVariant& v) { v.overrides = {{"sensors.pad.profile", "gripper"}}; });
  add("pillars slip as a whole (1 bristle)", [](EncoderVariant& v) { v.overrides = {{"sensors.pad.bristles", "1"}}; });
  return all;
}

using EncoderDraws = std::array<std::vector<Evaluation>, 4>;  // of the four models

// Runs variants one after the other. A variant that needs no other dataset than the one before it takes that one's.
class EncoderAblation {
 public:
  // `options` must outlive it.
  explicit EncoderAblation(const ReproduceOptions& options) : options_(options), seed_(options.seed.value_or(1)) {}

  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  [[nodiscard]] const TrainingData& data() const { return data_; }  // of the last variant

  // The four models under a variant, split by sequence. `by_frame`: filled as well where given. Throws InputError and
  // Interrupted.
  EncoderDraws run(const EncoderVariant& variant, EncoderDraws* by_frame = nullptr);

 private:
  void read(const EncoderVariant& variant);

  const ReproduceOptions& options_;
  std::uint64_t seed_;
  InterruptGuard guard_{"ending after the step at hand"};  // lets the folder be removed
  ScratchFolder folder_;
  std::string path_;  // of the dataset at hand
  std::string key_;   // what made it
  SlipRule labels_{};
  KeptFrames keep_ = KeptFrames::all;
  TrainingData data_;
};

EncoderDraws EncoderAblation::run(const EncoderVariant& variant, EncoderDraws* by_frame) {
  if (options_.say) options_.say(variant.name);
  read(variant);
  EncoderDraws draws;
  const std::array<hd::Model, 4> models = ablation(variant.model);
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < models.size(); ++i) {
    end_if_interrupted();
    const hd::Memories memories = hd::generate(models[i], seed_ + variant.other_memories);
    // The last two differ in the prototypes alone.
    if (i < 3) samples = encode(models[i], memories, variant.quantiser, data_.sequences, options_.jobs);
    const auto draws_by = [&](Split split) {
      end_if_interrupted();
      return cross_validate(models[i], memories, data_.sequences, samples, split, variant.epochs, seed_, options_.jobs);
    };
    draws[i] = draws_by(Split::by_sequence);
    if (by_frame != nullptr) (*by_frame)[i] = draws_by(Split::by_frame);
  }
  return draws;
}

void EncoderAblation::read(const EncoderVariant& variant) {
  const std::string key = overrides_key(variant.overrides);
  if (path_.empty() || (key != key_ && options_.data.empty())) {
    path_ = options_.data;
    if (path_.empty()) {
      path_ = folder_.file("hexapod.h5");
      make_dataset(path_, hexapod_scene, variant.overrides, 0, nullptr, options_);
    }
    key_ = key;
  } else if (variant.labels == labels_ && variant.keep == keep_) {
    return;
  }
  labels_ = variant.labels;
  keep_ = variant.keep;
  data_ = read_sequences(path_, {labels_, {}});
  for (Sequence& sequence : data_.sequences) leave_out(sequence, keep_);
}

// The paper's own figures [%].
constexpr std::array<MeanSd, 4> published{{{85.00, 1.15}, {86.42, 1.35}, {89.86, 0.94}, {91.78, 0.53}}};

std::string percent(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", 100.0 * value); }
std::string percent(const MeanSd& value) { return fmt::format("{:.2f} +- {:.2f}", 100.0 * value.mean, 100.0 * value.sd); }
std::string milliseconds(double value) { return std::isnan(value) ? "-" : fmt::format("{:.0f}", 1e3 * value); }

double accuracy_of(const Evaluation& e) { return accuracy(e.all); }
double balanced(const Evaluation& e) { return balanced_accuracy(e.all); }
double slip_recall(const Evaluation& e) { return recall_of_slip(e.all); }
double moving_balanced(const Evaluation& e) { return balanced_accuracy(e.moving); }

ResultTable main_table(const EncoderDraws& by_sequence, const EncoderDraws& by_frame) {
  ResultTable table{"Recall of slip, balanced accuracy and the paper's accuracy, in %: mean +- SD of five draws",
                    {"model", "recall of slip", "balanced accuracy", "moving: balanced", "accuracy: paper", "accuracy: ours",
                     "by frame: balanced", "by frame: accuracy"}};
  const std::array<hd::Model, 4> models = ablation({});
  for (std::size_t i = 0; i < models.size(); ++i) {
    table.rows.push_back({model_name(models[i]), percent(over_draws(by_sequence[i], slip_recall)),
                          percent(over_draws(by_sequence[i], balanced)), percent(over_draws(by_sequence[i], moving_balanced)),
                          fmt::format("{:.2f} +- {:.2f}", published[i].mean, published[i].sd),
                          percent(over_draws(by_sequence[i], accuracy_of)), percent(over_draws(by_frame[i], balanced)),
                          percent(over_draws(by_frame[i], accuracy_of))});
  }
  const Evaluation sequences = pooled(std::span(by_sequence[0]).subspan(1));
  const Evaluation frames = pooled(std::span(by_frame[0]).subspan(1));
  table.rows.push_back({"best constant answer", "-", percent(constant_balanced_accuracy(sequences.all)),
                        percent(constant_balanced_accuracy(sequences.moving)), "-", percent(constant_accuracy(sequences.all)),
                        percent(constant_balanced_accuracy(frames.all)), percent(constant_accuracy(frames.all))});
  table.note =
      "By sequence unless it says by frame. By sequence: no sequence is in both parts. By frame: frames of one sequence are, which flatters every detector. Recall of slip: share of the frames that slip that are called incipient or gross; by the paper's rule all of them move. Balanced: mean of the recalls. Moving: while the pad slides or turns; the rest is a pad at rest that cannot slip.";
  return table;
}

ResultTable delay_table(const EncoderDraws& draws) {
  ResultTable table{
      "By sequence: recall in %, and delay of the first slip called after the true onset in ms",
      {"model", "non-slip", "incipient", "gross", "delay, quartiles", "median", "seen", "early", "missed", "false alarms"}};
  const std::array<hd::Model, 4> models = ablation({});
  for (std::size_t i = 0; i < models.size(); ++i) {
    const Evaluation sum = pooled(std::span(draws[i]).subspan(1));
    const Delays& d = sum.delays;
    table.rows.push_back({model_name(models[i]), percent(recall(sum.all, PadState::non_slip)),
                          percent(recall(sum.all, PadState::incipient)), percent(recall(sum.all, PadState::gross)),
                          fmt::format("{} to {}", milliseconds(quantile(d.delay, 0.25)), milliseconds(quantile(d.delay, 0.75))),
                          milliseconds(median(d.delay)), fmt::format("{} of {}", d.delay.size(), d.slipping),
                          std::to_string(d.early), std::to_string(d.missed),
                          fmt::format("{} of {}", d.false_alarms, d.sequences - d.slipping)});
  }
  table.note =
      "Tests of the five draws together. Onset: a first part of a pillar slips, resolved inside the step. Seen: no frame before the onset is called slip, and one after it is; delays are theirs. Early: a frame before the onset is called slip. False alarms: of the sequences that never slip.";
  return table;
}

ResultTable confusion_table(const std::vector<Evaluation>& draws) {
  ResultTable table{"Confusion of CL-gstHDC by sequence: share of the true class in %",
                    {"true", "called non-slip", "called incipient", "called gross", "frames"}};
  const Evaluation sum = pooled(std::span(draws).subspan(1));
  for (const auto& [name, truth] :
       {std::pair{"non-slip", PadState::non_slip}, {"incipient", PadState::incipient}, {"gross", PadState::gross}}) {
    std::array<double, 3> counts{};
    for (std::size_t k = 0; k < 3; ++k) counts[k] = static_cast<double>(sum.all[static_cast<std::size_t>(truth)][k + 1]);
    const double all = counts[0] + counts[1] + counts[2];
    table.rows.push_back(
        {name, percent(counts[0] / all), percent(counts[1] / all), percent(counts[2] / all), fmt::format("{}", all)});
  }
  return table;
}

using VariantDraws = std::vector<std::pair<std::string, EncoderDraws>>;

VariantDraws run_variants(EncoderAblation& study, const std::vector<EncoderVariant>& variants) {
  VariantDraws all;
  for (const EncoderVariant& variant : variants) all.emplace_back(variant.name, study.run(variant));
  return all;
}

Json draws_of_models(const EncoderDraws& draws) {
  const std::array<hd::Model, 4> models = ablation({});
  Json entry;
  for (std::size_t i = 0; i < models.size(); ++i) entry[model_name(models[i])] = draws_json(draws[i]);
  return entry;
}

// Balanced accuracy and accuracy of each model under each variant.
ResultTable variants_table(const std::string& title, const VariantDraws& variants, Json& figures) {
  ResultTable table{title, {""}, {}, "Balanced accuracy, and the paper's measure, accuracy, in %."};
  for (const hd::Model& model : ablation({})) table.head.push_back(model_name(model) + ": balanced");
  for (const hd::Model& model : ablation({})) table.head.push_back(model_name(model) + ": accuracy");
  for (const auto& [name, draws] : variants) {
    std::vector<std::string>& row = table.rows.emplace_back(1, name);
    for (const std::vector<Evaluation>& model : draws) row.push_back(percent(over_draws(model, balanced)));
    for (const std::vector<Evaluation>& model : draws) row.push_back(percent(over_draws(model, accuracy_of)));
    figures[name] = draws_of_models(draws);
  }
  return table;
}

// The remarks take their numbers from the run at hand.
std::vector<std::string> remarks_on(const VariantDraws& variants, const EncoderDraws& by_frame) {
  const std::map<std::string, EncoderDraws> causes(variants.begin(), variants.end());
  const auto mean = [&](const std::string& name, std::size_t model) {
    return over_draws(causes.at(name)[model], accuracy_of).mean;
  };
  const std::string as_published = "as published";
  const std::string no_rest = "without the rest after a stop";
  const std::string has_slipped = "labels has_slipped";
  const auto leads = std::count_if(causes.begin(), causes.end(), [&](const auto& row) {
    for (std::size_t i = 1; i < 4; ++i) {
      if (mean(row.first, i) > mean(row.first, 0)) return false;
    }
    return true;
  });
  double least = 0.0;  // largest change of any model by what should not matter
  for (const char* name : {"feature exact, from 1/8 mm", "ties to zero", "D = 4000", "other item memories"}) {
    for (std::size_t i = 0; i < 4; ++i) least = std::max(least, std::abs(mean(name, i) - mean(as_published, i)));
  }
  return {
      fmt::format(
          "Order: the paper has sHDC < stHDC < gstHDC < CL-gstHDC. Here sHDC is best, or as good, in {} of {} rows of that table; by frame, where neighbours of the test frames are trained on, it has {} % against {} % of CL-gstHDC.",
          leads, causes.size(), percent(over_draws(by_frame[0], accuracy_of).mean),
          percent(over_draws(by_frame[3], accuracy_of).mean)),
      fmt::format(
          "Physics and labels: a pad that stops after it slipped keeps its displacements, so that rest looks like a steady slip, and its label is non-slip. Without these frames sHDC goes from {} to {} % and CL-gstHDC from {} to {} %; where what has slipped stays so, as the paper words its classes, to {} and {} %. Whether the published sequences hold such frames is not said.",
          percent(mean(as_published, 0)), percent(mean(no_rest, 0)), percent(mean(as_published, 3)), percent(mean(no_rest, 3)),
          percent(mean(has_slipped, 0)), percent(mean(has_slipped, 3))),
      fmt::format(
          "Encoder: the temporal product multiplies likenesses: of frames that agree to s with those learnt s^15 is left (0.9: 0.21), so that a window is known again only when every frame of it is nearly the same. CL-gstHDC has {} % with one frame, {} % with 5, {} % with 15; bundled as the published core does, whose counts go on from frame to frame, {} %.",
          percent(mean("window 1 frame", 3)), percent(mean("window 5 frames", 3)), percent(mean(as_published, 3)),
          percent(mean("counts kept in the window (published core)", 3))),
      fmt::format(
          "Labels: CL-gstHDC has {} % by the paper's rule, {} % where a pillar counts once it slips as a whole, {} % once a part of it does. The threshold of the paper's rule is not printed; 0.1 mm/s is assumed.",
          percent(mean(as_published, 3)), percent(mean("labels strict", 3)), percent(mean("labels micro", 3))),
      fmt::format(
          "Not the reason: fixed point against the exact ratio, the rule for ties, D and the item memories change no model by more than {:.2f} points.",
          100.0 * least),
  };
}

std::vector<std::string> setup_lines(const EncoderAblation& study, const std::string& data, const Evaluation& draw) {
  return {
      data.empty() ? fmt::format("Data: a fresh dataset of {}, seed {}.", hexapod_scene, study.seed())
                   : fmt::format("Data: {}, made by: {}", data, study.data().command),
      fmt::format(
          "{} sequences, PapillArray at 100 Hz (every tenth sample), labels by the paper's rule, D = 1000, N = 15, ties to one, fixed point. Frames that touch and have a whole window behind them are learnt and judged, the same for every model.",
          study.data().sequences.size()),
      fmt::format(
          "Six draws, seed {}: of each compression and speed as many sequences as there are, with replacement, train; those never drawn are the test. Draw 0 is kept for choices (none was made), the other five make mean and SD. Draw 1 trains {} sequences, {} of them different, and tests {}.",
          study.seed(), draw.training, draw.distinct, draw.tested),
  };
}

}  // namespace

Result hd_table1(const ReproduceOptions& options) {
  const bool fresh = options.data.empty();
  EncoderAblation study(options);
  EncoderDraws by_frame;
  const EncoderDraws by_sequence = study.run({"ablation", {}}, &by_frame);
  Result result;
  result.title = "Ablation of the hyperdimensional slip detector";
  result.source =
      "Table I and section IV of \"Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor\"";
  result.setup = setup_lines(study, options.data, by_sequence[0][1]);
  result.tables = {main_table(by_sequence, by_frame), delay_table(by_sequence), confusion_table(by_sequence[3])};
  for (std::size_t i = 0; i < published.size(); ++i) {
    result.real.push_back({fmt::format("{} learnt on recordings, frames that are right, %", model_name(ablation({})[i])),
                           published[i].mean, 100.0 * over_draws(by_sequence[i], accuracy_of).mean,
                           "ours has learnt from hexapod.yaml, which is fitted"});
  }
  result.figures["by_sequence"] = draws_of_models(by_sequence);
  result.figures["by_frame"] = draws_of_models(by_frame);
  std::vector<EncoderVariant> variants = cause_variants();
  if (!fresh) std::erase_if(variants, [](const EncoderVariant& variant) { return !variant.overrides.empty(); });
  const VariantDraws causes = run_variants(study, variants);
  result.tables.push_back(
      variants_table("What decides it: one thing changed at a time, by sequence", causes, result.figures["causes"]));
  result.remarks = remarks_on(causes, by_frame);
  if (!fresh) return result;
  result.tables.push_back(variants_table("Scatter between sequences: trained and tested on data with it, by sequence",
                                         run_variants(study, scatter_variants()), result.figures["scatter"]));
  return result;
}

}  // namespace slipbench::reproduce

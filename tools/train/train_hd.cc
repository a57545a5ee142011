#include "tools/train/train_hd.h"

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "detectors/hd/engine.h"
#include "detectors/hd/memories.h"
#include "detectors/hd/words.h"
#include "sim/api/pad_state_names.h"
#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "sim/core/random.h"
#include "tools/files/reject.h"
#include "tools/train/network/examples.h"
#include "tools/workers/ordered_workers.h"

namespace slipbench {
namespace {

std::size_t threads_for(std::size_t jobs, std::size_t work) {
  const std::size_t wanted = jobs > 0 ? jobs : std::max(1U, std::thread::hardware_concurrency());
  return std::min(wanted, work);
}

std::vector<Sample> encode_sequence(hd::Encoder& encoder, const hd::Model& model, hd::Quantiser quantiser,
                                    const Sequence& sequence, std::size_t index) {
  std::vector<Sample> samples;
  encoder.reset();
  for (std::size_t row = 0; row < sequence.time.size(); ++row) {
    hd::Frame frame;
    try {
      frame = hd::quantise(sequence.displacements[row], quantiser);
    } catch (const InputError& error) {
      reject("trial {}: at {} s: {}", sequence.trial, sequence.time[row], error.what());
    }
    const hd::Hypervector* query = encoder.encode(frame);
    if (row + 1 < model.window || sequence.label[row] == PadState::no_contact) continue;
    samples.push_back({index, row, sequence.label[row], sequence.moving[row], frame.context, *query});
  }
  return samples;
}

// Judges the samples for which `judged` of their index is true.
template <class Judged>
Evaluation judge(const Classifier& classifier, std::span<const Sequence> sequences, std::span<const Sample> samples,
                 Judged&& judged, bool with_delays) {
  Evaluation evaluation;
  std::vector<double> time;
  std::vector<PadState> called;
  train::SlipSeries said;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& sample = samples[i];
    if (judged(i)) {
      const PadState state = classifier.classify(sample);
      count(evaluation.all, sample.label, state);
      if (sample.moving != 0) count(evaluation.moving, sample.label, state);
      time.push_back(sequences[sample.sequence].time[sample.row]);
      called.push_back(state);
      const bool slipped = !said.truth.empty() && said.truth.back() != 0;
      said.truth.push_back(slips(sample.label) ? 1 : slipped ? train::masked : 0);
      said.probability.push_back(slips(state) ? 1.0 : 0.0);
      if (const Sequence& sequence = sequences[sample.sequence]; !sequence.path.empty())
        said.path.push_back(sequence.path[sample.row]);
    }
    const bool last = i + 1 == samples.size() || samples[i + 1].sequence != sample.sequence;
    if (!last) continue;
    if (with_delays && !time.empty()) {
      evaluation.delays.add(time, called, sequences[sample.sequence].onset);
      said.dataset = sequences[sample.sequence].dataset;
      said.holds = std::ranges::all_of(said.truth, [](std::uint8_t truth) { return truth == 0; });
      evaluation.said.push_back(said);
    }
    time.clear();
    called.clear();
    said = {};
  }
  return evaluation;
}

Evaluation with_sizes(Evaluation evaluation, const BootstrapDraw& draw) {
  evaluation.training = draw.training_size();
  evaluation.distinct = draw.distinct();
  evaluation.tested = draw.times.size() - draw.distinct();
  return evaluation;
}

std::size_t judged_sequences(std::span<const Sample> samples) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) count += i == 0 || samples[i].sequence != samples[i - 1].sequence;
  return count;
}

// The largest number of frames, over all sequences, up to the last frame in contact.
std::size_t longest_contact(std::span<const Sequence> sequences) {
  std::size_t longest = 0;
  for (const Sequence& sequence : sequences) {
    for (std::size_t row = 0; row < sequence.label.size(); ++row) {
      if (sequence.label[row] != PadState::no_contact) longest = std::max(longest, row + 1);
    }
  }
  return longest;
}

// Reads the trials of a dataset for training and counts them. Throws InputError if its own split
// has none for training.
TrainingData read_learnt(const std::string& dataset, const HdTraining& options, HdSummary& summary) {
  TrainingData data = read_sequences(dataset, options.sequences);
  summary.trials += data.sequences.size();
  const bool own_split = !options.all && std::ranges::any_of(data.sequences, [](const Sequence& s) { return !s.part.empty(); });
  if (!own_split) return data;
  summary.own_split = true;
  if (summary.test.empty() && std::ranges::find(data.sequences, "test", &Sequence::part) != data.sequences.end())
    summary.test = dataset;
  std::erase_if(data.sequences, [](const Sequence& sequence) { return sequence.part != "train"; });
  if (data.sequences.empty()) reject("{}: the part train of its split contains no trial; --all trains on every trial", dataset);
  return data;
}

// Throws InputError if one constant answer is always right.
void check_classes(const std::string& dataset, LabelRule labels, std::span<const Sample> samples) {
  const auto hold = static_cast<std::size_t>(
      std::ranges::count_if(samples, [](const Sample& sample) { return sample.label == PadState::non_slip; }));
  if (hold != 0 && hold != samples.size()) return;
  reject("{}: by the labels {}, frames in contact: {} non-slip, {} slip; training needs frames of both", dataset,
         label_rule_name(labels), hold, samples.size() - hold);
}

// Encodes the samples of a dataset. Throws InputError if there are none.
std::vector<Sample> encode_dataset(const std::string& dataset, const hd::SavedModel& saved, std::span<const Sequence> sequences,
                                   std::size_t jobs) {
  std::vector<Sample> samples = encode(saved.model, saved.memories, saved.quantiser, sequences, jobs);
  if (!samples.empty()) return samples;
  const std::size_t longest = longest_contact(sequences);
  if (longest == 0) reject("{}: no frame has contact", dataset);
  reject("{}: a window of {} is longer than the sequences; allowed: up to {}, the last frame with contact", dataset,
         counted(saved.model.window, "frame"), longest);
}

network::Alarm chosen_alarm(std::span<const train::SlipSeries> series, const HdTraining& options) {
  constexpr double period = 1.0 / detector_rate;
  return (options.alarms ? train::best_point(series, period, *options.alarms)
                         : train::best_scoring_point(series, period, options.specificity))
      .alarm;
}

Json confusion_json(const Confusion& confusion) {
  Json recalls;
  Json counts;
  for (const PadStateName& truth : pad_states_in_contact) {
    recalls[truth.name] = or_null(recall(confusion, truth.value));
    for (const PadStateName& called : pad_states_in_contact)
      counts[truth.name][called.name] = samples_in(confusion, truth.value, called.value);
  }
  return {{"frames", samples_in_contact(confusion)},
          {"recall_of_slip", or_null(recall_of_slip(confusion))},
          {"balanced_accuracy", or_null(balanced_accuracy(confusion))},
          {"constant_balanced_accuracy", or_null(constant_balanced_accuracy(confusion))},
          {"accuracy", or_null(accuracy(confusion))},
          {"constant_accuracy", or_null(constant_accuracy(confusion))},
          {"recall", recalls},
          {"called", counts}};
}

Json delays_json(const Delays& delays) {
  return {{"sequences", delays.sequences},
          {"slipping", delays.slipping},
          {"noticed", delays.delay.size()},
          {"early", delays.early},
          {"missed", delays.missed},
          {"false_alarms", delays.false_alarms},
          {"delay_s",
           {{"lower_quartile", or_null(quantile(delays.delay, 0.25))},
            {"median", or_null(median(delays.delay))},
            {"upper_quartile", or_null(quantile(delays.delay, 0.75))}}}};
}

Json model_json(const hd::Model& model, hd::Quantiser quantiser) {
  return {{"name", model_name(model)},
          {"dimension", model.dimension},
          {"window", model.window},
          {"context_driven", model.context_driven},
          {"compat", choice_name(hd::compat_words, model.compat)},
          {"ties", choice_name(hd::ties_words, model.ties)},
          {"quantiser", choice_name(hd::quantiser_words, quantiser)}};
}

// JSON of an evaluation: sizes; recall of slip, balanced accuracy and accuracy, the last two with
// those of constant answers; recalls and counts, for all frames and moving ones; and the delays, if
// any. Undefined values are null.
Json evaluation_json(const Evaluation& evaluation) {
  Json json = {{"training", evaluation.training},
               {"distinct", evaluation.distinct},
               {"tested", evaluation.tested},
               {"all", confusion_json(evaluation.all)},
               {"moving", confusion_json(evaluation.moving)}};
  if (evaluation.delays.sequences > 0) json["delay"] = delays_json(evaluation.delays);
  return json;
}

}  // namespace

std::vector<Sample> encode(const hd::Model& model, const hd::Memories& memories, hd::Quantiser quantiser,
                           std::span<const Sequence> sequences, std::size_t jobs) {
  using Workers = OrderedWorkers<std::vector<Sample>>;
  const auto make_work = [&]() -> Workers::Work {
    const std::shared_ptr<hd::Encoder> encoder = hd::make_kernel_encoder(model, memories);
    return [&, encoder](std::size_t index) { return encode_sequence(*encoder, model, quantiser, sequences[index], index); };
  };
  Workers workers(sequences.size(), threads_for(jobs, sequences.size()), make_work, nullptr);
  std::vector<Sample> samples;
  while (std::optional<std::vector<Sample>> part = workers.next()) {
    std::move(part->begin(), part->end(), std::back_inserter(samples));
  }
  return samples;
}

std::vector<hd::Hypervector> fit(const hd::Model& model, const hd::Memories& memories, std::span<const Sample> samples,
                                 std::span<const std::uint32_t> times, std::size_t epochs, std::uint64_t seed) {
  hd::Prototypes sums(model, memories), mean(model, memories);
  if (epochs == 0) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (times[i] > 0) sums.add(samples[i].query, samples[i].context, samples[i].label, times[i]);
    }
    return sums.bundle();
  }
  const std::size_t margin = model.dimension / 16;
  std::vector<hd::Hypervector> prototypes = sums.bundle();
  auto left = static_cast<std::int64_t>(epochs * samples.size());  // weight of the next addition in the mean
  for (std::size_t epoch = 0; epoch < epochs; ++epoch) {
    for (const std::size_t i : shuffled(samples.size(), RandomStream(seed, epoch, "hd epochs"))) {
      const Sample& sample = samples[i];
      const std::int64_t learnt = times[i], in_mean = learnt * left--;
      if (learnt == 0) continue;
      const auto encoded = model.context_driven ? hd::bind(sample.query, memories.context[sample.context]) : sample.query;
      const auto distance = [&](PadState state) { return hd::hamming(encoded, prototypes[static_cast<std::size_t>(state) - 1]); };
      PadState other = sample.label == PadState::non_slip ? PadState::incipient : PadState::non_slip;
      for (const PadState state : {PadState::incipient, PadState::gross}) {
        if (state != sample.label && distance(state) <= distance(other)) other = state;
      }
      if (distance(sample.label) + margin < distance(other)) continue;
      for (const auto& [state, sign] : {std::pair{sample.label, 1}, {other, -1}}) {
        sums.add(sample.query, sample.context, state, sign * learnt);
        mean.add(sample.query, sample.context, state, sign * in_mean);
      }
      prototypes = sums.bundle();
    }
  }
  return mean.bundle();
}

Classifier::Classifier(const hd::Model& model, const hd::Memories& memories) {
  hd::check(model, memories, true);
  for (std::size_t context = 0; context < hd::context_count; ++context) {
    for (const hd::Hypervector& prototype : memories.associative) {
      prototypes_[context].push_back(model.context_driven ? hd::bind(prototype, memories.context[context]) : prototype);
    }
  }
}

PadState Classifier::classify(const Sample& sample) const {
  const std::vector<hd::Hypervector>& prototypes = prototypes_[sample.context];
  std::size_t nearest = 0;
  std::size_t least = hd::hamming(sample.query, prototypes[0]);
  for (std::size_t k = 1; k < prototypes.size(); ++k) {
    const std::size_t distance = hd::hamming(sample.query, prototypes[k]);
    if (distance > least) continue;
    least = distance;
    nearest = k;
  }
  return static_cast<PadState>(nearest + 1);
}

std::vector<Evaluation> cross_validate(const hd::Model& model, const hd::Memories& memories, std::span<const Sequence> sequences,
                                       std::span<const Sample> samples, Split split, std::size_t epochs, std::uint64_t seed,
                                       std::size_t jobs) {
  const bool whole = split == Split::by_sequence;
  std::vector<std::size_t> conditions;
  if (whole) {
    for (const Sequence& sequence : sequences) conditions.push_back(condition_of(sequence.motion));
  } else {
    for (const Sample& sample : samples) conditions.push_back(condition_of(sequences[sample.sequence].motion));
  }
  using Workers = OrderedWorkers<Evaluation>;
  const Workers::Work work = [&](std::size_t number) {
    const BootstrapDraw draw = bootstrap(conditions, seed, number);
    std::vector<std::uint32_t> times;
    for (std::size_t i = 0; i < samples.size(); ++i) times.push_back(draw.times[whole ? samples[i].sequence : i]);
    hd::Memories trained = memories;
    trained.associative = fit(model, memories, samples, times, epochs, seed);
    return with_sizes(judge(
                          Classifier(model, trained), sequences, samples, [&](std::size_t i) { return times[i] == 0; }, whole),
                      draw);
  };
  Workers workers(
      draw_count, threads_for(jobs, draw_count), [&] { return work; }, nullptr);
  std::vector<Evaluation> evaluations;
  while (std::optional<Evaluation> evaluation = workers.next()) {
    if (samples_in_contact(evaluation->all) == 0) {
      reject(
          "draw {0} leaves no frame for the test; the dataset needs more sequences with contact after a window of {2} frames (found {1})",
          evaluations.size(), judged_sequences(samples), model.window);
    }
    evaluations.push_back(std::move(*evaluation));
  }
  return evaluations;
}

HdSummary train_hd(const HdTraining& options) {
  hd::check_save_target(options.output);
  hd::SavedModel saved{options.model, options.quantiser, {}, hd::generate(options.model, options.seed)};
  HdSummary summary;
  TrainingData data = read_learnt(options.dataset, options, summary);
  std::set<std::string> trials;
  const auto add_trials = [&] {
    for (const Sequence& sequence : data.sequences) trials.insert(sequence.sha256);
  };
  std::size_t dataset_index = 0;
  for (const std::string& dataset : options.with) {
    TrainingData more = read_learnt(dataset, options, summary);
    add_trials();  // a trial in several datasets could be in both training and test
    for (const Sequence& sequence : more.sequences)
      if (trials.contains(sequence.sha256)) reject("{}: a trial is also in an earlier dataset; give each trial once", dataset);
    ++dataset_index;
    for (Sequence& sequence : more.sequences) sequence.dataset = dataset_index;
    data.command += " and " + more.command;
    std::ranges::move(more.sequences, std::back_inserter(data.sequences));
  }
  const std::vector<Sample> samples = encode_dataset(options.dataset, saved, data.sequences, options.jobs);
  check_classes(options.dataset, options.sequences.labels, samples);
  summary.sequences = data.sequences.size();
  summary.sensor = data.sensor;
  summary.samples = samples.size();
  for (const Split split : {Split::by_sequence, Split::by_frame}) {
    (split == Split::by_sequence ? summary.by_sequence : summary.by_frame) =
        cross_validate(saved.model, saved.memories, data.sequences, samples, split, options.epochs, options.seed, options.jobs);
  }
  const std::vector<std::uint32_t> once(samples.size(), 1);
  saved.memories.associative = fit(saved.model, saved.memories, samples, once, options.epochs, options.seed);
  if (options.point) saved.alarm = chosen_alarm(summary.by_sequence[0].said, options);
  summary.alarm = saved.alarm;
  const std::string learnt = summary.own_split
                                 ? fmt::format("{} of {} (part train)", summary.sequences, counted(summary.trials, "sequence"))
                                 : "all " + counted(summary.sequences, "sequence");
  summary.trained = saved.trained =
      fmt::format("{}; labels {}, seed {}, {}{}", data.command, label_rule_name(options.sequences.labels), options.seed, learnt,
                  options.epochs > 0 ? ", " + counted(options.epochs, "epoch") : "");
  add_trials();
  hd::save(options.output, saved, trials);
  return summary;
}

Evaluation pooled(std::span<const Evaluation> draws) {
  Evaluation sum;
  for (const Evaluation& draw : draws) {
    sum.training += draw.training;
    sum.distinct += draw.distinct;
    sum.tested += draw.tested;
    add(sum.all, draw.all);
    add(sum.moving, draw.moving);
    sum.delays.add(draw.delays);
  }
  return sum;
}

Json draws_json(std::span<const Evaluation> draws) {
  Json each = Json::array();
  for (const Evaluation& draw : draws) each.push_back(evaluation_json(draw));
  const auto figure = [&draws](double (*measure)(const Confusion&), Confusion Evaluation::*frames) {
    const MeanSd value = over_draws(draws, [&](const Evaluation& e) { return measure(e.*frames); });
    return Json{{"mean", or_null(value.mean)}, {"sd", or_null(value.sd)}};
  };
  return {{"recall_of_slip", figure(recall_of_slip, &Evaluation::all)},
          {"balanced_accuracy", figure(balanced_accuracy, &Evaluation::all)},
          {"accuracy", figure(accuracy, &Evaluation::all)},
          {"constant_accuracy", figure(constant_accuracy, &Evaluation::all)},
          {"moving_recall_of_slip", figure(recall_of_slip, &Evaluation::moving)},
          {"moving_balanced_accuracy", figure(balanced_accuracy, &Evaluation::moving)},
          {"moving_accuracy", figure(accuracy, &Evaluation::moving)},
          {"pooled", evaluation_json(pooled(draws.subspan(1)))},
          {"draws", each}};
}

Json train_json(const HdSummary& summary, const HdTraining& options) {
  return {{"dataset", options.dataset},
          {"with", options.with},
          {"memories", options.output},
          {"model", model_json(options.model, options.quantiser)},
          {"labels", label_rule_name(options.sequences.labels)},
          {"epochs", options.epochs},
          {"alarm", {{"on", summary.alarm.on}, {"off", summary.alarm.off}, {"least", summary.alarm.least}}},
          {"seed", options.seed},
          {"trials", summary.trials},
          {"part", summary.own_split ? Json("train") : Json(nullptr)},
          {"sequences", summary.sequences},
          {"frames", summary.samples},
          {"by_sequence", draws_json(summary.by_sequence)},
          {"by_frame", draws_json(summary.by_frame)}};
}

std::string model_name(const hd::Model& model) {
  const std::string prefix = model.context_driven ? "CL-" : "";
  switch (model.encoding) {
    case hd::Encoding::spatial: return prefix + "sHDC";
    case hd::Encoding::spatial_temporal: return prefix + "stHDC";
    case hd::Encoding::graph_spatial_temporal: return prefix + "gstHDC";
  }
  throw std::logic_error("encoding without a name");
}

}  // namespace slipbench

#include "tools/program/train/train_network.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/math.h"
#include "sim/core/process/interrupted.h"
#include "tools/base/files/output_file.h"
#include "tools/base/files/reject.h"
#include "tools/base/record/json.h"
#include "tools/program/train/network/network.h"

namespace slipbench::train {
namespace {

// How every file that onnx_model() makes begins: version 8 of the format, made by slipbench.
constexpr std::string_view beginning{"\x08\x08\x12\x09slipbench", 13};

// The probability of each class of an answer.
std::vector<double> probabilities(std::span<const float> logits) {
  const double top = *std::ranges::max_element(logits);
  std::vector<double> all;
  double sum = 0.0;
  for (const float logit : logits) sum += all.emplace_back(math::exp(double{logit} - top));
  for (double& one : all) one /= sum;
  return all;
}

// What the members say together of a frame.
struct Answer {
  std::uint8_t label = 0;           // or `masked`
  std::vector<double> probability;  // of each class
};
using Answers = std::vector<std::vector<Answer>>;  // of each sequence

Answers answers_of(std::span<const std::unique_ptr<Network>> members, std::span<const FrameSequence> sequences) {
  const std::size_t classes = class_count(members.front()->shape()), before = history_of(members.front()->shape()) - 1;
  Answers answers;
  for (const FrameSequence& sequence : sequences) {
    std::vector<Answer>& these = answers.emplace_back();
    if (sequence.label.size() <= before) continue;
    for (std::size_t t = before; t < sequence.label.size(); ++t)
      these.push_back({sequence.label[t], std::vector<double>(classes, 0.0)});
    for (const std::unique_ptr<Network>& member : members) {
      const std::vector<float> logits = member->logits(sequence.features);
      for (std::size_t t = 0; t < these.size(); ++t) {
        const std::vector<double> one = probabilities(std::span(logits).subspan(t * classes, classes));
        for (std::size_t c = 0; c < classes; ++c) these[t].probability[c] += one[c] / static_cast<double>(members.size());
      }
    }
  }
  return answers;
}

// Mean of the recalls of the classes that occur.
double accuracy_of(const Answers& answers, std::size_t classes) {
  std::vector<double> right(classes), all(classes);
  for (const std::vector<Answer>& sequence : answers) {
    for (const Answer& answer : sequence) {
      if (answer.label == masked) continue;
      const auto called = static_cast<std::size_t>(std::ranges::max_element(answer.probability) - answer.probability.begin());
      all[answer.label] += 1.0;
      right[answer.label] += called == answer.label ? 1.0 : 0.0;
    }
  }
  double sum = 0.0, occurring = 0.0;
  for (std::size_t c = 0; c < classes; ++c) {
    if (all[c] == 0.0) continue;
    sum += right[c] / all[c];
    occurring += 1.0;
  }
  return sum / occurring;
}

std::vector<std::size_t> trials_of(const std::vector<const Example*>& examples) {
  std::vector<std::size_t> trials;
  for (const Example* example : examples) {
    if (trials.empty() || trials.back() != example->trial) trials.push_back(example->trial);
  }
  return trials;
}

// Of the trials of both, once each; a trial that says none of itself is left out.
std::set<std::string> digests_of(const std::vector<const Example*>& learning, const std::vector<const Example*>& validating) {
  std::set<std::string> digests;
  for (const auto* part : {&learning, &validating}) {
    for (const Example* example : *part) digests.insert(example->sha256);
  }
  digests.erase("");
  return digests;
}

// The probabilities of slip.
std::vector<SlipSeries> slip_series(const Answers& answers, const std::vector<network::Class>& classes) {
  std::vector<SlipSeries> all;
  for (const std::vector<Answer>& sequence : answers) {
    SlipSeries& series = all.emplace_back();
    for (const Answer& answer : sequence) {
      double slip = 0.0;
      for (std::size_t c = 0; c < classes.size(); ++c) slip += slips(classes[c].state) ? answer.probability[c] : 0.0;
      series.probability.push_back(slip);
      series.truth.push_back(answer.label == masked ? masked : std::uint8_t{slips(classes[answer.label].state)});
    }
  }
  return all;
}

// Copies of the frames, scaled.
std::vector<FrameSequence> scaled(const std::vector<const Example*>& examples, const Scale& scale) {
  std::vector<FrameSequence> sequences;
  for (const Example* example : examples) apply(scale, sequences.emplace_back(example->frames));
  return sequences;
}

// Refuses data that do not hold what the recipe tells apart. `part`: "to learn from".
void check_classes(const std::vector<std::string>& datasets, const char* part, const std::vector<const Example*>& examples,
                   const std::vector<network::Class>& classes, std::size_t history) {
  std::vector<std::size_t> frames(classes.size());
  for (const Example* example : examples) {
    if (example->frames.label.size() < history) {
      reject("{}: trial {}: {} frames are less than the {} that an answer is made of", fmt::join(datasets, ", "), example->trial,
             example->frames.label.size(), history);
    }
    for (std::size_t t = history - 1; t < example->frames.label.size(); ++t) {
      if (example->frames.label[t] != masked) ++frames.at(example->frames.label[t]);
    }
  }
  std::vector<std::string> counts;
  for (std::size_t c = 0; c < classes.size(); ++c) counts.push_back(fmt::format("{} {}", frames[c], classes[c].name));
  if (std::ranges::find(frames, 0U) != frames.end()) {
    reject(
        "{}: the trials {} have a class without a frame: {}; allowed: frames of every class, in more trials or "
        "with another --seed or --split",
        fmt::join(datasets, ", "), part, fmt::join(counts, ", "));
  }
}

Json counts_json(const Confusion& frames) {
  constexpr PadState slip = PadState::gross, hold = PadState::non_slip;
  return {{"balanced_accuracy", or_null(balanced_slip_accuracy(frames))}, {"f1", or_null(f1_of_slip(frames))},
          {"slip_called_slip", samples_in(frames, slip, slip)},           {"slip_called_hold", samples_in(frames, slip, hold)},
          {"hold_called_slip", samples_in(frames, hold, slip)},           {"hold_called_hold", samples_in(frames, hold, hold)}};
}

std::string checkpoint_path(const std::string& output, std::size_t member) {
  return fmt::format("{}.checkpoint-{}", output, member);
}

// All that decides what is learnt, for --resume.
std::string identity_of(const NetworkTraining& training, const Examples& examples, std::size_t member) {
  const TrainingOptions& options = training.recipe.training;
  return Json{{"recipe", training.recipe.name},
              {"layers", layers_text(training.recipe.network.layers)},
              {"data", examples.sha256},
              {"sensor", training.sensor},
              {"labels", hd::name_of(label_words, training.recipe.labels)},
              {"split", hd::name_of(split_words, training.recipe.split)},
              {"all", training.all},
              {"held_out", training.held_out},
              {"seed", training.seed},
              {"member", member},
              {"turned", training.recipe.turned},
              {"training",
               {options.steps, options.batch, options.clip, options.learning_rate, options.final_rate, options.label_smoothing,
                options.validate_every, options.patience, options.onset_frames}},
              {"libraries", network_libraries()}}
      .dump();
}

// Writes the file, asks `check` whether it says what it should, and gives it its name.
void write_checked(const std::string& path, const std::string& bytes, const std::function<void(const std::string&)>& check) {
  const std::string unchecked = path + ".unchecked";
  write_text_file(unchecked, bytes);
  try {
    check(unchecked);
    rename_file(unchecked, path);
  } catch (...) {
    std::filesystem::remove(unchecked);
    throw;
  }
}

// Throws InputError for an output that cannot be written and for a checkpoint that is not there.
void check_output(const NetworkTraining& training) {
  check_text_target(training.output, training.datasets,
                    {"detector of slipbench", [](std::string_view bytes) { return bytes.starts_with(beginning); }});
  // Networks after the first one have no checkpoint until their turn comes.
  if (const std::string first = checkpoint_path(training.output, 0); training.resume && !std::filesystem::exists(first)) {
    throw InputError(
        first + ": is not there to go on with: the training has ended, or never came to a validation; allowed: none of --resume");
  }
}

// A dataset's examples, and what each is for.
struct Lesson {
  Examples examples;
  std::vector<const Example*> learning, validating, judging;

  // Whether a dataset's own split counts.
  [[nodiscard]] bool own_split() const {
    return std::ranges::any_of(examples.all, [](const Example& example) { return !example.part.empty(); });
  }
};

Lesson read_lesson(const NetworkTraining& training) {
  const Recipe& recipe = training.recipe;
  const ExampleOptions options{recipe.input,  recipe.labels,  recipe.classes, training.sensor,
                               recipe.turned, recipe.at_most, training.seed,  training.read};
  Lesson lesson{read_examples(training.datasets, options), {}, {}, {}};
  for (Example& example : lesson.examples.all) {
    if (training.all) example.part.clear();
    if (training.divided && !example.part.empty())
      reject(
          "{}: its own split says which trials learn and which judge; allowed: --all beside --split and --held-out, which divides all trials anew, or neither of them",
          training.datasets[example.dataset]);
  }
  try {
    const std::vector<Part> of = split_examples(lesson.examples.all, recipe.split, training.held_out, training.seed);
    for (std::size_t i = 0; i < of.size(); ++i) {
      const Example* example = &lesson.examples.all[i];
      if (of[i] == Part::learns) lesson.learning.push_back(example);
      if (of[i] == Part::validates) lesson.validating.push_back(example);
      if (of[i] == Part::judges) lesson.judging.push_back(example);
    }
  } catch (const InputError& error) {
    reject("{}: {}", fmt::join(training.datasets, ", "), error.what());
  }
  if (lesson.learning.empty())
    reject("{}: the part train of its own split holds no trial; allowed: --all, which divides all trials anew",
           fmt::join(training.datasets, ", "));
  return lesson;
}

// With a recipe of units as it is for the sensor that is there.
NetworkTraining fitted(NetworkTraining training) {
  Recipe& recipe = training.recipe;
  if (recipe.input.transform != network::Transform::units) return training;
  const auto [input, units] = units_input(training.datasets.front(), training.sensor, recipe.input);
  if (units == 0) return training;
  recipe.input = input;
  Reshape& apart = std::get<Reshape>(recipe.network.layers.front());
  apart.shape.front() = units;
  recipe.network.inputs = units * apart.shape.back();
  return training;
}

// What the file says of its input and classes.
network::Description described(const Recipe& recipe, const Scale& scale, const std::vector<network::Class>& classes) {
  network::Description description;
  description.input = recipe.input;
  description.input.history = history_of(recipe.network);
  description.input.offset = scale.offset;
  description.input.scale = scale.scale;
  description.classes = classes;
  return description;
}

// The scale of the frames that teach.
Scale scale_of_learning(const Lesson& lesson, Scaling scaling) {
  std::vector<const FrameSequence*> frames;
  for (const Example* example : lesson.learning) frames.push_back(&example->frames);
  return scale_of(frames, lesson.examples.inputs, scaling);
}

struct Ensemble {
  std::vector<std::unique_ptr<Network>> members;
  std::vector<std::vector<std::vector<float>>> states;  // of each member
  std::vector<std::size_t> steps;                       // of its best state
};

Ensemble teach(const NetworkTraining& training, const Examples& examples, const std::vector<FrameSequence>& learnt,
               const std::vector<FrameSequence>& validated, const std::function<void(const MemberProgress&)>& report) {
  const Recipe& recipe = training.recipe;
  Ensemble ensemble;
  for (std::size_t member = 0; member < recipe.members; ++member) {
    TrainingOptions how = recipe.training;
    how.seed = training.seed + member;
    how.before_step = &end_if_interrupted;
    Network& network = *ensemble.members.emplace_back(make_network(recipe.network, how.seed));
    const Checkpoint checkpoint{checkpoint_path(training.output, member), identity_of(training, examples, member),
                                training.resume};
    const TrainingResult result = network.train(learnt, validated, how, checkpoint, [&](const TrainingProgress& progress) {
      if (report) report({member, recipe.members, progress});
    });
    ensemble.steps.push_back(result.best_step);
    ensemble.states.push_back(network.state());
  }
  return ensemble;
}

// The numbers of trials and frames.
NetworkSummary sizes_of(const Lesson& lesson, const NetworkTraining& training) {
  NetworkSummary summary;
  summary.own_split = lesson.own_split();
  if (!lesson.judging.empty()) {
    summary.judged_from = training.datasets[lesson.judging.front()->dataset];
    summary.judged_part = lesson.judging.front()->part;
  }
  summary.learnt = trials_of(lesson.learning).size();
  summary.validated = trials_of(lesson.validating).size();
  summary.judged = trials_of(lesson.judging).size();
  summary.trials = summary.learnt + summary.validated + summary.judged;
  for (const Example& example : lesson.examples.all) {
    if (std::ranges::find(summary.sensors, example.sensor) == summary.sensors.end()) summary.sensors.push_back(example.sensor);
  }
  for (const Example* example : lesson.learning) summary.frames += example->frames.label.size();
  return summary;
}

void judge(NetworkSummary& summary, const NetworkTraining& training, const Answers& on_validation, const Answers& on_judged,
           const std::vector<network::Class>& classes) {
  const network::Input& input = training.recipe.input;
  const double period = static_cast<double>(input.stride) / input.rate;
  const std::vector<SlipSeries> validated = slip_series(on_validation, classes);
  const bool whole = training.by_score || training.alarms;
  summary.point = whole ? best_point(validated, period, training.alarms) : most_accurate_point(validated, period);
  summary.validation = accuracy_of(on_validation, classes.size());
  summary.held_out_accuracy = accuracy_of(on_judged, classes.size());
  summary.held_out = counts_at(slip_series(on_judged, classes), period, summary.point.threshold, summary.point.alarm);
  summary.held_out_alarms = summary.held_out.alarms_per_minute(period);
}

// What the file says of its training.
Json trained_json(const NetworkTraining& training, const Lesson& lesson, const std::vector<std::size_t>& steps,
                  const NetworkSummary& summary) {
  const Recipe& recipe = training.recipe;
  Json trained{{"recipe", recipe.name},
               {"labels", hd::name_of(label_words, recipe.labels)},
               {"command", lesson.examples.command},
               {"data_sha256", lesson.examples.sha256},
               {"sensor", training.sensor},
               {"split", hd::name_of(split_words, recipe.split)},
               {"held_out", training.held_out},
               {"seed", training.seed},
               {"alarms_asked_per_minute", or_null(training.alarms)},
               {"by_score", training.by_score},
               {"trials_learnt", trials_of(lesson.learning)},
               {"trials_validated", trials_of(lesson.validating)},
               {"trials_judged", trials_of(lesson.judging)},
               {"sha256_seen", digests_of(lesson.learning, lesson.validating)},
               {"frames", summary.frames},
               {"parameters", summary.parameters},
               {"steps", steps},
               {"validation",
                {{"balanced_accuracy", summary.validation}, {"alarms_per_minute", or_null(summary.point.alarms_per_minute)}}},
               {"libraries", network_libraries()}};
  if (lesson.own_split()) trained["dataset_split"] = true;
  if (!lesson.judging.empty()) {
    trained["judged"] = counts_json(summary.held_out.frames);
    trained["judged"]["alarms_per_minute"] = or_null(summary.held_out_alarms);
    trained["judged"]["all_classes_balanced_accuracy"] = summary.held_out_accuracy;
  }
  return trained;
}

}  // namespace

NetworkSummary train_network(const NetworkTraining& asked, const std::function<void(const MemberProgress&)>& report) {
  check_output(asked);
  static_cast<void>(network_libraries());  // says what is missing before anything is read
  const NetworkTraining training = fitted(asked);
  const Recipe& recipe = training.recipe;
  const Lesson lesson = read_lesson(training);
  const std::vector<network::Class> classes = classes_of(recipe.classes, recipe.labels);
  check_classes(training.datasets, "to learn from", lesson.learning, classes, history_of(recipe.network));
  check_classes(training.datasets, "that choose the state", lesson.validating, classes, history_of(recipe.network));

  const Scale scale = scale_of_learning(lesson, recipe.scaling);
  const std::vector<FrameSequence> learnt = scaled(lesson.learning, scale), validated = scaled(lesson.validating, scale),
                                   judged = scaled(lesson.judging, scale);
  const Ensemble ensemble = teach(training, lesson.examples, learnt, validated, report);

  NetworkSummary summary = sizes_of(lesson, training);
  summary.parameters = parameter_count(recipe.network);
  summary.steps = ensemble.steps.back();
  judge(summary, training, answers_of(ensemble.members, validated), answers_of(ensemble.members, judged), classes);
  summary.description = trained_json(training, lesson, ensemble.steps, summary).dump();

  network::Description description = described(recipe, scale, classes);
  description.threshold = summary.point.threshold;
  description.alarm = summary.point.alarm;
  description.trained = summary.description;
  const std::string bytes = onnx_model(recipe.network, ensemble.states, description);
  write_checked(training.output, bytes, [&]([[maybe_unused]] const std::string& path) {
#ifdef SLIPBENCH_WITH_ENGINE
    check_engine(path, ensemble.members, validated.front());
#endif
  });
  for (std::size_t member = 0; member < recipe.members; ++member)
    std::filesystem::remove(checkpoint_path(training.output, member));
  return summary;
}

}  // namespace slipbench::train

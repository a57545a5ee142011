#include "tools/studies/biotac_stability_slip/biotac_learning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "sim/core/math.h"
#include "tools/base/dataset/checked_dataset.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/files/reject.h"
#include "tools/program/samples/samples.h"
#include "tools/program/train/network/examples.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::reproduce::biotac {
namespace {

MeanSd over_folds(const std::vector<Figures>& folds, double Figures::*member) {
  std::vector<double> values;
  for (const Figures& fold : folds) {
    if (!std::isnan(fold.*member)) values.push_back(fold.*member);
  }
  return mean_sd(values);
}

constexpr const char* grasp_scene = "scenes/biotac_sp/grasp.yaml";

[[noreturn]] void no_grasp(const TrialRecord& record, const std::string& what) {
  reject(
      "trial {}: {}; allowed: grasps of {}, or files bts3v2_palm_down.csv, _side and _45 that `slipbench import --format bts3v2` has read",
      record.trial, what, grasp_scene);
}

std::size_t palm_of(const TrialRecord& record, const Json& swept) {
  const bool real = swept.contains("slipped");
  const std::string word = swept.value(real ? "palm" : "model", "");
  const auto found = std::ranges::find_if(palms, [&](const Palm& palm) { return word == (real ? palm.imported : palm.model); });
  if (found == palms.end()) no_grasp(record, fmt::format("its palm is {}", quote(word)));
  return static_cast<std::size_t>(found - palms.begin());
}

Touch touch_of(train::Example example) {
  return {std::move(example.frames.features), std::move(example.frames.label), std::move(example.object)};
}

train::ExampleOptions touch_options(train::LabelRule labels) {
  train::ExampleOptions how;
  how.labels = labels;
  how.input = train::find_recipe("biotac_lstm").input;
  how.classes = train::ClassRule::direction;
  return how;
}

// [T, places]: each place of a frame is the mean of some electrodes.
std::vector<float> averaged(std::span<const float> counts, const std::vector<std::vector<std::size_t>>& places) {
  std::vector<float> values;
  for (std::size_t first = 0; first < counts.size(); first += electrodes) {
    for (const std::vector<std::size_t>& place : places) {
      float sum = 0.0F;
      for (const std::size_t e : place) sum += counts[first + e];
      values.push_back(sum / static_cast<float>(place.size()));
    }
  }
  return values;
}

// The standard deviations of all electrodes, then their slopes.
std::vector<float> window_figures(std::span<const float> counts) {
  const std::size_t rows = counts.size() / electrodes;
  const auto count = static_cast<double>(rows);
  const double middle = 0.5 * (count - 1.0), moment = count * (count * count - 1.0) / 12.0;  // sum of (t - middle)^2
  std::vector<float> figures(2 * electrodes);
  for (std::size_t e = 0; e < electrodes; ++e) {
    double mean = 0.0, square = 0.0, slope = 0.0;
    for (std::size_t t = 0; t < rows; ++t) mean += double{counts[t * electrodes + e]} / count;
    for (std::size_t t = 0; t < rows; ++t) {
      const double off = double{counts[t * electrodes + e]} - mean;
      square += off * off;
      slope += off * (static_cast<double>(t) - middle) / moment;
    }
    figures[e] = static_cast<float>(std::sqrt(square / (count - 1.0)));
    figures[electrodes + e] = static_cast<float>(slope);
  }
  return figures;
}

void take_mean_off(std::vector<float>& counts) {
  const std::size_t rows = counts.size() / electrodes;
  for (std::size_t e = 0; e < electrodes; ++e) {
    double mean = 0.0;
    for (std::size_t t = 0; t < rows; ++t) mean += double{counts[t * electrodes + e]} / static_cast<double>(rows);
    for (std::size_t t = 0; t < rows; ++t)
      counts[t * electrodes + e] = static_cast<float>(double{counts[t * electrodes + e]} - mean);
  }
}

}  // namespace

std::vector<Answer> answers_of(std::span<const train::FoldExample> examples, const train::Logits& logits, std::size_t history) {
  std::vector<Answer> answers;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (logits[i].empty()) continue;
    const std::vector<std::uint8_t>& label = examples[i].frames.label;
    const std::size_t classes = logits[i].size() / (label.size() + 1 - history);
    for (std::size_t frame = history - 1; frame < label.size(); ++frame) {
      if (label[frame] == train::masked) continue;
      const std::span<const float> one = std::span(logits[i]).subspan((frame + 1 - history) * classes, classes);
      const auto greatest = std::ranges::max_element(one);
      double sum = 0.0;
      for (const float logit : one) sum += math::exp(double{logit} - double{*greatest});
      answers.push_back({i, label[frame], static_cast<std::uint8_t>(greatest - one.begin()),
                         1.0 - math::exp(double{one[0]} - double{*greatest}) / sum});
    }
  }
  return answers;
}

Figures figures_of(std::span<const Answer> answers) {
  std::map<std::uint8_t, std::pair<std::size_t, std::size_t>> classes;  // right, all
  std::size_t right = 0, slips = 0, called = 0, both = 0;
  std::vector<double> of_slip, of_hold;
  for (const Answer& answer : answers) {
    auto& [right_of_class, all_of_class] = classes[answer.label];
    const bool good = answer.label == answer.called;
    right_of_class += good ? 1 : 0;
    ++all_of_class;
    right += good ? 1 : 0;
    slips += answer.label != 0 ? 1 : 0;
    called += answer.called != 0 ? 1 : 0;
    both += answer.label != 0 && answer.called != 0 ? 1 : 0;
    (answer.label != 0 ? of_slip : of_hold).push_back(answer.slip);
  }
  Figures figures;
  figures.accuracy = share_of(right, answers.size());
  figures.balanced = classes.empty() ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  for (const auto& [label, counts] : classes)
    figures.balanced += share_of(counts.first, counts.second) / static_cast<double>(classes.size());
  figures.precision = share_of(both, called);
  figures.recall = share_of(both, slips);
  figures.f1 = share_of(2 * both, slips + called);
  figures.auc = of_slip.empty() || of_hold.empty() ? std::numeric_limits<double>::quiet_NaN() : auc(of_slip, of_hold).value;
  return figures;
}

Scores scores_of(std::span<const Answer> answers, std::span<const std::size_t> fold_of,
                 const std::function<bool(std::size_t example)>& counts) {
  std::map<std::size_t, std::vector<Answer>> by_fold;
  for (const Answer& answer : answers) {
    if (counts(answer.example)) by_fold[fold_of[answer.example]].push_back(answer);
  }
  std::vector<Figures> folds;
  for (const auto& [fold, of_fold] : by_fold) folds.push_back(figures_of(of_fold));
  return {over_folds(folds, &Figures::accuracy), over_folds(folds, &Figures::balanced), over_folds(folds, &Figures::precision),
          over_folds(folds, &Figures::recall),   over_folds(folds, &Figures::f1),       over_folds(folds, &Figures::auc)};
}

std::string cell(const MeanSd& share) {
  if (std::isnan(share.mean)) return "-";
  return std::isnan(share.sd) ? fmt::format("{:.1f}", 100.0 * share.mean)
                              : fmt::format("{:.1f} +- {:.1f}", 100.0 * share.mean, 100.0 * share.sd);
}

Json json_of(const Scores& scores) {
  Json json;
  for (const auto& [name, figure] : {std::pair{"accuracy", &Scores::accuracy},
                                     {"balanced_accuracy", &Scores::balanced},
                                     {"precision", &Scores::precision},
                                     {"recall", &Scores::recall},
                                     {"f1", &Scores::f1},
                                     {"auc", &Scores::auc}}) {
    const MeanSd& share = scores.*figure;
    json[name] = std::isnan(share.mean) ? Json() : Json(share.mean);
    json[std::string(name) + "_sd"] = std::isnan(share.sd) ? Json() : Json(share.sd);
  }
  return json;
}

Lessons::Lessons(const ReproduceOptions& options) : options_(options) {
  static_cast<void>(train::network_libraries());  // says what is missing before anything is run
}

std::size_t Lessons::queue(const Set& set, const Set* other, Learns learns, const Network& network) {
  train::Validation validation{network.shape, train::find_recipe("biotac_lstm").training};
  validation.training.steps = options_.full ? 4 * network.steps : network.steps;
  validation.training.validate_every = validation.training.steps;  // there is nothing to choose by: the last state is judged
  validation.training.seed = options_.seed.value_or(1);
  validation.scaling = network.scaling;
  auto examples = std::make_shared<std::vector<train::FoldExample>>(set.examples);
  std::vector<std::size_t> fold_of = set.fold_of;
  std::size_t folds = set.folds;
  if (learns == Learns::other) {
    std::ranges::fill(fold_of, 0);
    folds = 1;
    validation.learns = [](std::size_t group) { return group == 1; };
  }
  if (learns != Learns::own) {
    for (train::FoldExample example : other->examples) {
      example.group = 1;
      examples->push_back(std::move(example));
    }
    fold_of.resize(examples->size(), folds);
  }
  for (std::size_t fold = 0; fold < folds; ++fold)
    tasks_.push_back({answers_.size(), examples, fold_of, fold, validation, network.text});
  answers_.emplace_back();
  return answers_.size() - 1;
}

void Lessons::run() {
  const std::vector<std::vector<Answer>> said = run_in_processes<Answer>(
      tasks_.size(), options_, [this](std::size_t k) { return tasks_[k].name; },
      [this](std::size_t k) {
        const FoldTask& task = tasks_[k];
        return answers_of(*task.examples, train::logits_in_fold(*task.examples, task.fold_of, task.fold, task.validation),
                          train::history_of(task.validation.shape));
      });
  for (std::size_t k = 0; k < tasks_.size(); ++k) {
    std::vector<Answer>& answers = answers_[tasks_[k].of];
    answers.insert(answers.end(), said[k].begin(), said[k].end());
  }
  for (std::vector<Answer>& answers : answers_) std::ranges::stable_sort(answers, {}, &Answer::example);
}

std::string without_real(const char* format, const char* source) {
  return fmt::format(
      "Without --real there are no real recordings: the rows that need them are left out. They come from {}: "
      "`slipbench import FOLDER --format {} -o real.h5`, then --real real.h5.",
      source, format);
}

Grasp grasp_of(const TrialRecord& record) {
  const Json swept = Json::parse(record.params);
  Grasp grasp;
  grasp.palm = palm_of(record, swept);
  grasp.object = train::swept_facts(record.params).object;
  if (grasp.object.empty()) no_grasp(record, "it names no object");
  const auto slipped = swept.find("slipped");
  if (slipped == swept.end() && !record.outcome.hold) no_grasp(record, "its outcome does not say whether the object was held");
  grasp.slipped = slipped != swept.end() ? slipped->get<bool>() : !record.outcome.hold->held;
  for (const char* finger : grasp_fingers) {
    const auto sensor = std::ranges::find(record.sensors, finger, &SensorRecord::name);
    if (sensor == record.sensors.end() || sensor->type != "biotac_sp" || sensor->time.empty())
      no_grasp(record, fmt::format("no reading of a biotac_sp '{}'", finger));
    const SensorColumn& column = *std::ranges::find(sensor->channels, "electrodes", &SensorColumn::name);
    const std::size_t row =
        record.outcome.hold ? latest_row(sensor->time, record.outcome.hold->from).value_or(0) : sensor->time.size() - 1;
    const auto first = column.values.begin() + static_cast<std::ptrdiff_t>(row * electrodes);
    grasp.counts.insert(grasp.counts.end(), first, first + electrodes);
  }
  return grasp;
}

void check_simulated(const std::string& path) {
  dataset_header_at(path).check_truth("reproduce --data", "--real, which takes imported recordings");
}

std::vector<Grasp> read_grasps(const std::string& path, const ReproduceOptions& options) {
  if (options.say) options.say(fmt::format("reading {}", path));
  std::vector<Grasp> grasps;
  with_trials(path, [&](const TrialRecord& record) { grasps.push_back(grasp_of(record)); });
  return grasps;
}

std::vector<Grasp> run_grasps(std::size_t draws, const ReproduceOptions& options) {
  const GridCell cell{.name = "grasps", .scene = grasp_scene, .draws = draws};
  return run_grid<Grasp>({cell}, options, [](const GridTrial& trial) { return grasp_of(trial.record()); }).front();
}

std::vector<Grasp> levelled(std::vector<Grasp> grasps) {
  for (std::size_t palm = 0; palm < palms.size(); ++palm) {
    for (std::size_t k = 0; k < fingers * electrodes; ++k) {
      std::vector<double> counts;
      for (const Grasp& grasp : grasps) {
        if (grasp.palm == palm) counts.push_back(double{grasp.counts[k]});
      }
      const MeanSd level = mean_sd(counts);
      for (Grasp& grasp : grasps) {
        if (grasp.palm == palm)
          grasp.counts[k] = static_cast<float>((double{grasp.counts[k]} - level.mean) / std::max(1.0, level.sd));
      }
    }
  }
  return grasps;
}

train::FoldExample as_list(const Grasp& grasp) { return {{grasp.counts, {static_cast<std::uint8_t>(grasp.slipped ? 1 : 0)}}}; }

train::FoldExample as_image(const Grasp& grasp, const train::biotac::ImageLayout& layout) {
  train::FoldExample example = as_list(grasp);
  example.frames.features = averaged(grasp.counts, train::biotac::pixels_of(layout));
  return example;
}

train::FoldExample as_graph(const Grasp& grasp) {
  train::FoldExample example = as_list(grasp);
  for (std::size_t finger = 0; finger < fingers; ++finger) {
    for (std::size_t e = 0; e < electrodes; ++e)
      example.frames.features[e * fingers + finger] = grasp.counts[finger * electrodes + e];
  }
  return example;
}

std::vector<Touch> read_touches(const std::string& path, const ReproduceOptions& options) {
  if (options.say) options.say(fmt::format("reading {}", path));
  std::vector<Touch> touches;
  const std::string truth = dataset_header_at(path).header().truth;
  const train::LabelRule labels = truth.empty() ? train::LabelRule::micro : train::LabelRule::paper;  // imported: their set's own
  for (train::Example& example : train::read_examples(path, touch_options(labels)).all) {
    if (example.object.empty())
      reject(
          "{}: trial {} names no object; allowed: recordings of {}, or of BioTacSP-DoS as `slipbench import "
          "--format biotacsp-dos` has read them",
          path, example.trial, slip_scene);
    touches.push_back(touch_of(std::move(example)));
  }
  return touches;
}

std::vector<Touch> run_touches(const char* scene, std::size_t draws, const ReproduceOptions& options) {
  std::vector<std::size_t> numbers;
  for (std::size_t device = 1; device <= devices; ++device) numbers.push_back(device);
  const GridCell cell{.name = std::string(scene) == slip_scene ? "recordings" : "recordings, random site",
                      .scene = scene,
                      .overrides = {{"sweep.sensors.pad.device_number", Json(numbers).dump()}},
                      .draws = draws};
  return run_grid<Touch>(
             {cell}, options,
             [](const GridTrial& trial) {
               const TrialRecord record = trial.record();
               return touch_of(train::example_of(record, record.sensors.front(), touch_options(train::LabelRule::micro)));
             })
      .front();
}

std::vector<train::FoldExample> windows_of(const Touch& touch, const Window& window) {
  std::vector<train::FoldExample> examples;
  for (std::size_t first = 0; first + window.rows <= touch.label.size(); first += window.stride) {
    const std::span<const std::uint8_t> labels = std::span(touch.label).subspan(first, window.rows);
    if (std::ranges::find(labels, train::masked) != labels.end()) continue;
    const auto begin = touch.counts.begin() + static_cast<std::ptrdiff_t>(first * electrodes);
    std::vector<float> counts(begin, begin + static_cast<std::ptrdiff_t>(window.rows * electrodes));
    train::FrameSequence frames;
    frames.label.assign(window.figures == Window::Figures::none ? window.rows : 1, train::masked);
    frames.label.back() = labels.back();
    if (!window.site) take_mean_off(counts);
    if (window.figures != Window::Figures::none) {
      frames.features = window_figures(counts);
      if (window.figures == Window::Figures::sorted) {
        frames.features.resize(electrodes);
        std::ranges::sort(frames.features);
      }
    } else {
      frames.features = window.layout != nullptr ? averaged(counts, train::biotac::pixels_of(*window.layout)) : std::move(counts);
    }
    examples.push_back({std::move(frames)});
  }
  return examples;
}

std::vector<std::size_t> folds_by_object(std::span<const std::string> objects, std::size_t count, std::uint64_t seed) {
  const std::set<std::string> different(objects.begin(), objects.end());
  if (different.size() < count) reject("{} objects make no {} folds; allowed: {} or more", different.size(), count, count);
  const std::vector<std::size_t> dealt = train::folds(std::vector<std::size_t>(different.size()), count, seed);
  std::map<std::string, std::size_t> fold_of;
  for (const std::string& object : different) fold_of.emplace(object, dealt[fold_of.size()]);
  std::vector<std::size_t> folds;
  for (const std::string& object : objects) folds.push_back(fold_of.at(object));
  return folds;
}

}  // namespace slipbench::reproduce::biotac

#include "tools/studies/biotac/biotac_learning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "tools/base/statistics/roc.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::reproduce::biotac {
namespace {

double share_of(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(whole);
}

MeanSd over_folds(const std::vector<Figures>& folds, double Figures::*member) {
  std::vector<double> values;
  for (const Figures& fold : folds) {
    if (!std::isnan(fold.*member)) values.push_back(fold.*member);
  }
  return mean_sd(values);
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
      for (const float logit : one) sum += std::exp(double{logit} - double{*greatest});
      answers.push_back({i, label[frame], static_cast<std::uint8_t>(greatest - one.begin()),
                         1.0 - std::exp(double{one[0]} - double{*greatest}) / sum});
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

}  // namespace slipbench::reproduce::biotac

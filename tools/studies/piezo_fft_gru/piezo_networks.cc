#include "tools/studies/piezo_fft_gru/piezo_networks.h"

#include <algorithm>
#include <cmath>

#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace {

using learn::Architecture;
using learn::LabelRule;

NetworkFigures network_figures(const learn::Counts& counts) { return {100.0 * counts.balanced_accuracy(), counts.f1()}; }

// Adds a recording to the examples of its level.
void add_to(MotorLevel& level, const PiezoRecording& recording) {
  const std::size_t group = recording.motors_only ? motors_alone : with_slip;
  for (const LabelRule rule : {LabelRule::truth, LabelRule::paper})
    level.examples[rule].push_back({recording.frames(rule), group});
  level.level = recording.level;
  level.groups.push_back(group);
  level.tips.push_back(recording.tip);
}

void check_folds(const MotorLevel& level) {
  const auto slips = static_cast<std::size_t>(std::ranges::count(level.groups, with_slip));
  if (slips < fold_count) {
    throw InputError(fmt::format("{} recordings with contact make no {} folds; allowed: {} or more at every level", slips,
                                 fold_count, fold_count));
  }
  for (const auto& [rule, examples] : level.examples) {
    const auto moving = std::ranges::count_if(examples, [](const learn::Example& example) {
      return std::ranges::find(example.frames.slip, 1) != example.frames.slip.end();
    });
    if (static_cast<std::size_t>(moving) < fold_count) {
      throw InputError(fmt::format("{} recordings slip by the {} label; allowed: {} or more at every level", moving,
                                   rule == LabelRule::truth ? "true" : "position", fold_count));
    }
  }
}

// Share of the frames of recordings with a slip at which the labels differ.
double difference_of_labels(const MotorLevel& level) {
  double different = 0.0, all = 0.0;
  const std::vector<learn::Example>&truth = level.examples.at(LabelRule::truth), &paper = level.examples.at(LabelRule::paper);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (level.groups[k] != with_slip) continue;
    const std::vector<std::uint8_t>&a = truth[k].frames.slip, &b = paper[k].frames.slip;
    for (std::size_t i = 0; i < a.size(); ++i) different += a[i] != b[i] ? 1.0 : 0.0;
    all += static_cast<double>(a.size());
  }
  return different / all;
}

}  // namespace

const std::vector<NetworkRow>& network_rows() {
  static const std::vector<NetworkRow> rows{
      {"mlp_32", "MLP 32", {}, 500, 0.7913, 88.76},
      {"mlp_128", "MLP 128", {.dim = 128}, 500, 0.7941, 89.39},
      {"tcn_128_8", "TCN 128, kernel 8", {.architecture = Architecture::tcn, .dim = 128, .kernel = 8}, 300, 0.9579, 97.64},
      {"gru_32", "GRU 32", {.architecture = Architecture::gru}, 500, 0.9781, 98.70},
  };
  return rows;
}

std::vector<MotorLevel> levels_of(const std::vector<PiezoRecording>& recordings) {
  std::map<double, MotorLevel> by_level;
  for (const PiezoRecording& recording : recordings) {
    const double key = std::isnan(recording.level) ? -1.0 : recording.level;  // a dataset that sweeps no level has one
    add_to(by_level[key], recording);
  }
  std::vector<MotorLevel> levels;
  for (auto& [key, level] : by_level) {
    check_folds(level);
    level.labels_differ = difference_of_labels(level);
    levels.push_back(std::move(level));
  }
  return levels;
}

NetworkFigures on_slip(const GroupCounts& counts) { return network_figures(counts[with_slip]); }
NetworkFigures on_all(const GroupCounts& counts) {
  learn::Counts all = counts[with_slip];
  all.add(counts[motors_alone]);
  return network_figures(all);
}

std::size_t Validations::queue(const std::vector<learn::Example>& examples, const std::vector<std::size_t>& fold_of,
                               const NetworkRow& row, bool slip_alone) {
  learn::Validation validation{row.shape, {.steps = row.steps, .seed = options_.seed.value_or(1)}};
  if (slip_alone) validation.learns = [](std::size_t group) { return group == with_slip; };
  const std::size_t folds = *std::ranges::max_element(fold_of) + 1;
  for (std::size_t fold = 0; fold < folds; ++fold) tasks_.push_back({by_fold_.size(), &examples, fold_of, fold, validation});
  by_fold_.emplace_back();
  return by_fold_.size() - 1;
}

void Validations::run() {
  const auto judged = run_in_order<std::vector<learn::Counts>>(
      tasks_.size(), options_, [](std::size_t) { return "networks"; },
      [this](std::size_t k) {
        return learn::judge_fold(*tasks_[k].examples, tasks_[k].fold_of, tasks_[k].fold, tasks_[k].validation);
      });
  for (std::size_t k = 0; k < tasks_.size(); ++k) {
    GroupCounts& fold = by_fold_[tasks_[k].of].emplace_back();
    std::ranges::copy(judged[k], fold.begin());
  }
}

GroupCounts Validations::result(std::size_t validation) const {
  GroupCounts all{};
  for (const GroupCounts& fold : by_fold_[validation]) {
    for (std::size_t group = 0; group < fold.size(); ++group) all[group].add(fold[group]);
  }
  return all;
}

}  // namespace slipbench::reproduce

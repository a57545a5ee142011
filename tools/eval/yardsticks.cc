#include "tools/eval/yardsticks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/core/error.h"
#include "tools/eval/replay.h"
#include "tools/statistics/descriptive.h"

namespace slipbench::eval {
namespace {

constexpr std::array yardstick_types{"deviation", "relative_deviation", "shear_ratio", "sum_change"};
constexpr std::size_t considered_thresholds = 2000;

struct Classes {
  std::vector<double> positives, negatives;

  void add(const Judgement& trial) {
    positives.insert(positives.end(), trial.positives.begin(), trial.positives.end());
    negatives.insert(negatives.end(), trial.negatives.begin(), trial.negatives.end());
  }
  [[nodiscard]] bool both() const { return !positives.empty() && !negatives.empty(); }

  // The probability that as a threshold has the greatest balanced accuracy; NaN: none is within 0
  // and 1.
  [[nodiscard]] double best_threshold() const {
    double best = std::numeric_limits<double>::quiet_NaN(), gain = -1.0;
    for (const RocPoint& point : roc_curve(positives, negatives, considered_thresholds)) {
      if (!(point.threshold > 0.0 && point.threshold < 1.0) || point.true_share - point.false_share <= gain) continue;
      gain = point.true_share - point.false_share;
      best = point.threshold;
    }
    return best;
  }
};

// Half, 0 or 1, of each trial: experiments alternate.
std::vector<std::size_t> halves_of(const std::vector<Judgement>& trials) {
  std::map<std::string, std::size_t> known;
  std::vector<std::size_t> halves;
  std::size_t experiments = 0;
  for (const Judgement& trial : trials) {
    const bool is_new = trial.twin.empty() || known.try_emplace(trial.twin, experiments).second;
    halves.push_back((trial.twin.empty() ? experiments : known.at(trial.twin)) % 2);
    if (is_new) ++experiments;
  }
  return halves;
}

}  // namespace

std::vector<DetectorScene> yardsticks() {
  std::vector<DetectorScene> all;
  for (const char* type : yardstick_types) all.push_back(chosen_detector(type, {}));
  return all;
}

double default_threshold(const DetectorScene& yardstick) { return yardstick.parameters.number(yardstick_threshold); }

double yardstick_score(const DetectorScene& yardstick, double probability) {
  return default_threshold(yardstick) * probability / (1.0 - probability);
}

DetectorScene with_yardstick_threshold(DetectorScene yardstick, double threshold) {
  yardstick.parameters.set(yardstick_threshold, threshold);
  return yardstick;
}

void YardstickScores::add(const RecordedTrial& trial, const Truth& truth, const std::string& twin, bool interpolate) {
  if (scores_.empty()) {
    for (DetectorScene& detector : yardsticks()) scores_.push_back({.detector = std::move(detector)});
  }
  for (Scores& scores : scores_) {
    if (!scores.refused.empty()) continue;
    try {
      scores.trials.push_back(
          judged(trial.record.trial, truth,
                 replay(scores.detector, trial.sensors, trial.read, trial.record.seed, trial.record.trial, interpolate)));
      scores.trials.back().twin = twin;
    } catch (const InputError& error) {
      scores.refused = error.what();
    }
  }
}

std::optional<ChosenYardstick> YardstickScores::best() const {
  ChosenYardstick chosen;
  const Scores* best = nullptr;
  for (const Scores& scores : scores_) {
    if (!scores.refused.empty()) {
      chosen.left_out.emplace(scores.detector.type, scores.refused);
      continue;
    }
    const Estimate area = area_of(scores.trials);
    if (std::isnan(area.value)) continue;
    chosen.areas.emplace(scores.detector.type, area);
    if (best == nullptr || area.value > chosen.areas.at(best->detector.type).value) best = &scores;
  }
  if (best == nullptr) return std::nullopt;
  chosen.detector = best->detector;
  chosen.part = halves_of(best->trials);
  std::array<Classes, 2> halves;
  for (std::size_t k = 0; k < best->trials.size(); ++k) halves.at(1 - chosen.part[k]).add(best->trials[k]);
  chosen.by_halves = std::ranges::all_of(halves, &Classes::both);
  if (!chosen.by_halves) {
    std::ranges::fill(chosen.part, std::size_t{0});
    Classes& all = halves.front();
    all = {};
    for (const Judgement& trial : best->trials) all.add(trial);
  }
  for (std::size_t k = 0; k < (chosen.by_halves ? 2U : 1U); ++k) {
    const double threshold = halves.at(k).best_threshold();
    // Without a usable value the default remains: every sample of a class has the score 0 or inf.
    chosen.thresholds.push_back(std::isnan(threshold) ? default_threshold(chosen.detector)
                                                      : yardstick_score(chosen.detector, threshold));
  }
  return chosen;
}

}  // namespace slipbench::eval

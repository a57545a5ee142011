#include "tools/eval/yardsticks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "detectors/detector_kinds.h"
#include "sim/core/error.h"
#include "tools/eval/replay.h"
#include "tools/registry/program_catalogues.h"
#include "tools/statistics/descriptive.h"

namespace slipbench::eval {
namespace {

constexpr std::size_t considered_thresholds = 2000;
constexpr std::size_t scores_of_a_trial = 5000;  // kept of each yardstick

// Keeps every n-th value, so that both lists together have at most scores_of_a_trial: successive
// windows overlap.
void thin_out(std::vector<double>& positives, std::vector<double>& negatives) {
  const std::size_t every = (positives.size() + negatives.size() + scores_of_a_trial - 1) / scores_of_a_trial;
  for (std::vector<double>* values : {&positives, &negatives}) {
    std::vector<double> kept;
    for (std::size_t k = 0; k < values->size(); k += std::max<std::size_t>(1, every)) kept.push_back((*values)[k]);
    *values = std::move(kept);
  }
}

struct Classes {
  std::vector<double> positives, negatives;

  void add(const Judgement& trial) {
    positives.insert(positives.end(), trial.positives.begin(), trial.positives.end());
    negatives.insert(negatives.end(), trial.negatives.begin(), trial.negatives.end());
  }
  [[nodiscard]] bool both() const { return !positives.empty() && !negatives.empty(); }

  // The threshold of `yardstick` with the greatest balanced accuracy: the middle between the least
  // score that it accepts and the next one. NaN: no score is above 0 and finite.
  [[nodiscard]] double best_threshold(const DetectorScene& yardstick) const {
    const std::vector<RocPoint> curve = roc_curve(positives, negatives, considered_thresholds);
    double best = std::numeric_limits<double>::quiet_NaN(), gain = -1.0;
    for (std::size_t k = 0; k < curve.size(); ++k) {
      const double least = curve[k].threshold;
      if (!(least > 0.0 && least < 1.0) || curve[k].true_share - curve[k].false_share <= gain) continue;
      gain = curve[k].true_share - curve[k].false_share;
      const double next = k + 1 < curve.size() ? curve[k + 1].threshold : 0.0;
      best = 0.5 * (yardstick_score(yardstick, least) + yardstick_score(yardstick, next));
    }
    return best;
  }
};

// Half, 0 or 1, of each trial: objects alternate, or experiments if there are no two objects.
std::vector<std::size_t> halves_of(const std::vector<Judgement>& trials, const std::vector<std::string>& objects) {
  const bool by_object = std::ranges::none_of(objects, &std::string::empty) &&
                         std::ranges::adjacent_find(objects, std::ranges::not_equal_to{}) != objects.end();
  std::map<std::string, std::size_t> known;
  std::vector<std::size_t> halves;
  std::size_t groups = 0;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const std::string& group = by_object ? objects[k] : trials[k].twin;
    const bool is_new = group.empty() || known.try_emplace(group, groups).second;
    halves.push_back((group.empty() ? groups : known.at(group)) % 2);
    if (is_new) ++groups;
  }
  return halves;
}

}  // namespace

std::vector<DetectorScene> yardsticks() {
  std::vector<DetectorScene> all;
  for (const Entry& entry : detector_entries()) {
    const DetectorKind* const kind = detector_kind(entry.name);
    if (kind != nullptr && kind->yardstick) all.push_back(chosen_detector(entry.name, {}));
  }
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

void YardstickScores::add(const RecordedTrial& trial, const Truth& truth, const std::string& twin, const std::string& object,
                          bool interpolate) {
  objects_.push_back(object);
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
      thin_out(scores.trials.back().positives, scores.trials.back().negatives);
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
  chosen.part = halves_of(best->trials, objects_);
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
    const double threshold = halves.at(k).best_threshold(chosen.detector);
    // Without a usable value the default remains: every sample of a class has the score 0 or inf.
    chosen.thresholds.push_back(std::isnan(threshold) ? default_threshold(chosen.detector) : threshold);
  }
  return chosen;
}

}  // namespace slipbench::eval

#include "tools/program/sweep/detector_score.h"

#include <algorithm>

namespace slipbench {
namespace {

void add_trial(DetectorScore& score, const TrialOutcome& outcome, const Confusion& confusion) {
  ++score.trials;
  add(score.confusion, confusion);
  switch (outcome.detection.value()) {
    case Detection::quiet: return;
    case Detection::false_alarm: ++score.false_alarms; return;
    case Detection::early: ++score.early; break;
    case Detection::seen: score.delays.push_back(outcome.detection_delay); break;
    case Detection::missed: ++score.missed; break;
  }
  ++score.slipping;
}

}  // namespace

std::vector<DetectorScore> detector_scores(const std::vector<TrialSummary>& trials) {
  std::vector<DetectorScore> scores;
  for (const TrialSummary& trial : trials) {
    if (!trial.detector) continue;
    auto score = std::ranges::find(scores, trial.detector->type, &DetectorScore::type);
    if (score == scores.end()) score = scores.insert(scores.end(), DetectorScore{.type = trial.detector->type, .delays = {}});
    add_trial(*score, trial.outcome, trial.detector->confusion);
  }
  return scores;
}

}  // namespace slipbench

// The best rule of one line (detectors/yardstick) on the trials of an evaluation: what a trained
// detector must beat.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/eval/metrics.h"
#include "tools/eval/recorded_trial.h"

namespace slipbench::eval {

// Name of the parameter that is chosen.
inline constexpr const char* yardstick_threshold = "threshold";

// The yardsticks of the catalogue with their default thresholds.
std::vector<DetectorScene> yardsticks();
double default_threshold(const DetectorScene& yardstick);

// The number s of a yardstick, in the unit of its threshold, at which its slip_probability s/(s +
// threshold) has this value. Infinite for 1.
double yardstick_score(const DetectorScene& yardstick, double probability);
// Returns the yardstick with another threshold.
DetectorScene with_yardstick_threshold(DetectorScene yardstick, double threshold);

// A yardstick with a threshold for each trial.
struct ChosenYardstick {
  DetectorScene detector;                       // with the default threshold
  std::vector<double> thresholds;               // one for each part of the trials
  std::vector<std::size_t> part;                // of each trial, in the order of add(): index into `thresholds`
  std::map<std::string, Estimate> areas;        // under the ROC curve, of every yardstick that reads the sensor
  std::map<std::string, std::string> left_out;  // those that do not, with the reason
  // True: the threshold of a trial was chosen on the trials of the other half. False: there is one
  // threshold, chosen on all trials, since a half has only one class.
  bool by_halves = false;
};

// Collects the scores of the yardsticks trial by trial.
class YardstickScores {
 public:
  // Runs each yardstick on the samples of `trial`. One that cannot read the sensor in a trial is
  // left out from then on. `twin`: as Judgement::twin. `object`: that of a recording; empty: unknown.
  // `interpolate`: as in replay().
  void add(const RecordedTrial& trial, const Truth& truth, const std::string& twin, const std::string& object,
           bool interpolate = false);

  // Returns the yardstick with the greatest area under the ROC curve, of at most 5,000 samples of a
  // trial, evenly spaced. Its thresholds have the greatest balanced accuracy by samples. Every second
  // object belongs to the other half; without two objects, every second experiment (a trial and its
  // twins). Empty without yardsticks, and if all samples have one class.
  [[nodiscard]] std::optional<ChosenYardstick> best() const;

 private:
  struct Scores {
    DetectorScene detector;
    std::string refused{};  // why it cannot read the sensor; empty: it can
    std::vector<Judgement> trials{};
  };
  std::vector<Scores> scores_;
  std::vector<std::string> objects_;  // of each trial
};

}  // namespace slipbench::eval

// Operating point of a network: its threshold and the number of consecutive frames for an alarm,
// chosen on trials outside of training.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "detectors/network/description.h"
#include "tools/statistics/confusion.h"

namespace slipbench::train {

// The answers to one sequence.
struct SlipSeries {
  std::vector<double> probability;  // [T] of slip
  std::vector<std::uint8_t> truth;  // [T] 1: slip, 0: hold, `masked` (examples.h): neither
  std::vector<double> path = {};    // [T] m, path that the object has slipped since the start; empty: unknown
  std::size_t dataset = 0;          // index of its file
  bool holds = false;               // no part of the pad slips
};

// Series in which nothing is to be reported.
struct Holding {
  std::size_t series = 0;
  std::size_t silent = 0;  // without an alarm
};
// A share of fewer series than this is not used as a condition: one alarm would be more than 5 %.
inline constexpr std::size_t least_holding = 20;

// Unmasked frames by truth and answer. An alarm is false if it begins in a frame of hold.
struct FrameCounts {
  Confusion frames{};
  std::uint64_t false_alarms = 0;

  // Counts one frame. `begins`: an alarm begins in it.
  void add(bool slips, bool answer, bool begins);
  // `period` [s]: period of the frames. NaN without hold.
  [[nodiscard]] double alarms_per_minute(double period) const;
};

struct AlarmCounts : FrameCounts {
  // Series of dataset 0, whose score the choice maximises, with a known path that slip by
  // least_slip_distance or more. The other datasets limit the choice by their specificity.
  std::size_t slips = 0;
  // Sum over them of the credit of the path from the first frame of slip to the first alarm, and
  // 0 if the alarm comes before that frame or never, by distance_credit().
  double credit = 0.0;
  Holding without_slip = {};          // series of dataset 0 with a known path that slip by less than that
  std::vector<Holding> holding = {};  // by dataset: series in which no part of the pad slips

  // Score of the recordings of dataset 0 (tools/statistics/slip_score.h), as the benchmark counts slip.
  // NaN if none of them slips; if all of them slip, the mean credit.
  [[nodiscard]] double score() const;
  // The least share of Holding::silent of the datasets with least_holding series or more; NaN
  // without such a dataset.
  [[nodiscard]] double specificity() const;
};
AlarmCounts counts_at(std::span<const SlipSeries> series, double threshold, const network::Alarm& alarm);

struct OperatingPoint {
  double threshold = 0.5;
  network::Alarm alarm;
  double alarms_per_minute =
      std::numeric_limits<double>::quiet_NaN();  // false alarms on the series used for the choice; NaN: without hold
};

// A single frame makes an alarm; the threshold has the greatest balanced accuracy. It is the middle
// between two probabilities, among equals the one nearest to 1/2; 1/2 without slip or hold.
OperatingPoint most_accurate_point(std::span<const SlipSeries> series, double period);
// The greatest balanced accuracy of frames, which a late alarm reduces too, among points with at
// most `alarms` false alarms per minute of hold; if there is none, the point with the fewest.
// Consecutive frames: up to half a second. Thresholds: the most accurate one, and just above 48
// quantiles of the hold frames' probabilities, whose distances to the greatest grow by a constant
// factor. Without slip or hold, or with series of single frames, which have no duration: as
// most_accurate_point().
OperatingPoint best_point(std::span<const SlipSeries> series, double period, double alarms);
// Returns the point with the greatest AlarmCounts::score() among those of best_point() whose
// AlarmCounts::specificity() is at least `specificity`, 0 to 1. If no point reaches it, returns the
// point with the greatest AlarmCounts::specificity(). Throws InputError if no series of dataset 0
// slips by least_slip_distance, or if every frame of it is slip.
OperatingPoint best_scoring_point(std::span<const SlipSeries> series, double period, double specificity);

}  // namespace slipbench::train

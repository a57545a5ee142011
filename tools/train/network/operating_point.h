// Operating point of a network: its threshold and the number of consecutive frames for an alarm,
// chosen on trials outside of training.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "detectors/network/description.h"
#include "tools/statistics/confusion.h"

namespace slipbench::train {

// The answers to one sequence.
struct SlipSeries {
  std::vector<double> probability;  // [T] of slip
  std::vector<std::uint8_t> truth;  // [T] 1: slip, 0: hold, `masked` (examples.h): neither
};

// Parameters of the score of slip-1 (tools/benchmark/README.md).
inline constexpr double half_delay = 0.1;   // s, delay for half of the credit
inline constexpr double alarm_limit = 1.0;  // false alarms per minute up to which credit counts in full

// Unmasked frames by truth and answer. An alarm is false if it begins in a frame of hold.
struct AlarmCounts {
  Confusion frames{};
  std::uint64_t false_alarms = 0;
  std::size_t slips = 0;  // series with a frame of slip
  double credit =
      0.0;  // sum over them of half_delay/(half_delay + delay); 0 if the alarm comes before the first slip frame or never

  // `period` [s]: period of the frames. NaN without hold.
  [[nodiscard]] double alarms_per_minute(double period) const;
  // Score for public recordings: credit per slip, times min(1, alarm_limit/alarms), minus the share
  // of hold called slip. NaN without slip or hold.
  [[nodiscard]] double score(double period) const;
};
AlarmCounts counts_at(std::span<const SlipSeries> series, double period, double threshold, const network::Alarm& alarm);

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
// Without `alarms`: the greatest score. Consecutive frames: up to half a second. Thresholds: the
// most accurate one, and just above 48 quantiles of the hold frames' probabilities, whose distances
// to the greatest grow by a constant factor. Without slip or hold, or with a series of a single
// frame, which has no duration: as most_accurate_point().
OperatingPoint best_point(std::span<const SlipSeries> series, double period, std::optional<double> alarms);

}  // namespace slipbench::train

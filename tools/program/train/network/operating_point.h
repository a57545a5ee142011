// When a network says slip: its threshold, and the frames in a row that it takes, chosen on trials that trained nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "detectors/network/description.h"
#include "tools/base/statistics/confusion.h"

namespace slipbench::train {

// The answers to one sequence.
struct SlipSeries {
  std::vector<double> probability;  // [T] of slip
  std::vector<std::uint8_t> truth;  // [T] 1: slip, 0: hold, `masked` (examples.h): neither
};

// Of the score of slip-1 (tools/program/benchmark/README.md).
inline constexpr double half_delay = 0.1;   // s, a slip seen so late earns half
inline constexpr double alarm_limit = 1.0;  // false alarms a minute up to which credit counts in full

// Frames that are not masked, by what is true and what is said; an alarm is false where slip begins to be said in a frame of hold.
struct AlarmCounts {
  Confusion frames{};
  std::uint64_t false_alarms = 0;
  std::size_t slips = 0;  // series with a frame of slip
  double credit = 0.0;  // sum over them of half_delay/(half_delay + delay), 0 where slip is said before its first frame or never

  // Of frames `period` [s] apart; NaN without hold.
  [[nodiscard]] double alarms_per_minute(double period) const;
  // What a board would give for open recordings: credit a slip, times min(1, alarm_limit/alarms), less the share of hold called slip. NaN without
  // slip or hold.
  [[nodiscard]] double score(double period) const;
};
AlarmCounts counts_at(std::span<const SlipSeries> series, double period, double threshold, const network::Alarm& alarm);

struct OperatingPoint {
  double threshold = 0.5;
  network::Alarm alarm;
  double alarms_per_minute = std::numeric_limits<double>::quiet_NaN();  // false ones, on the series that chose; NaN: without hold
};

// Every frame for itself, with the threshold of the greatest balanced accuracy: the middle between two probabilities, of equals the one nearest
// to 1/2; 1/2 where slip or hold does not occur.
OperatingPoint most_accurate_point(std::span<const SlipSeries> series, double period);
// The greatest balanced accuracy of frames, which slip that is said late lessens as well, among points with at most `alarms` false alarms a
// minute of hold; where none has so few, those with the fewest. Without `alarms`: the greatest score. Frames in a row: up to half a second.
// Thresholds: the most accurate one, and just above 48 quantiles of the hold frames' probabilities, whose distances to the greatest grow by a
// constant factor. Without slip or hold, or where a series is one frame, which lasts no time: as most_accurate_point().
OperatingPoint best_point(std::span<const SlipSeries> series, double period, std::optional<double> alarms);

}  // namespace slipbench::train

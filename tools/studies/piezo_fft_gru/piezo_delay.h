// When a network that names every frame has noticed a slip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tools/base/record/json.h"
#include "tools/program/train/draws.h"

namespace slipbench::reproduce {

// From `onset` [s] to the beginning of the alarm that is on then, which is negative, or else of the first one after it. `time` [s] and `called`
// (1: slip) of each frame. NaN: none is on then or comes after it. The paper's mean of 8.5 ms counts so: its delays may be negative.
double alarm_delay(std::span<const double> time, std::span<const std::uint8_t> called, double onset);

// Over recordings.
struct Alarms {
  Delays first;              // the first alarm decides, an early one has no delay (Detection)
  std::vector<double> near;  // s, alarm_delay() of those that slip, where there is one
  std::size_t silent = 0;    // those that slip and have none

  // `onset` [s]; NaN: never.
  void add(std::span<const double> time, std::span<const std::uint8_t> called, double onset);
};

// A spread of times [s].
struct DelaySpread {
  double mean = std::numeric_limits<double>::quiet_NaN(), sd = mean, median = mean, p10 = mean, p90 = mean, greatest = mean;
};
// NaN of none; the sd of fewer than two.
DelaySpread delay_spread(const std::vector<double>& times);
Json json_of(const DelaySpread& spread);
// "12 (3 to 40)": median, 10 and 90 % in ms; "-" of none.
std::string cell(const DelaySpread& spread);

}  // namespace slipbench::reproduce

// What the formats share that hold any sensor.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/base/dataset/reader.h"

namespace slipbench {

// Names of a trial's sensors, or only those asked for, in the trial's order. Throws InputError when the trial has no recording or no sensor of such a
// name.
std::vector<std::string> chosen_sensors(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked);

// Times closer than this are the same [s]: k/rate and its like are rounded.
inline constexpr double time_rounding = 1e-9;

// The row of the latest of ascending `times` [s] at or before `time`; empty: there is none.
std::optional<std::size_t> latest_row(std::span<const double> times, double time);

// A sensor's readings and labels at instants 1/`rate` apart [Hz], from the first at which all its channels have been read once to
// its last sample. Of each the latest at or before the instant, neither filtered nor interpolated; no channel has a time of its own
// then. Events keep their times. Throws InputError, which names the trial, for a rate above the sensor's and where fewer than two
// rows would be left.
SensorRecord at_rate(SensorRecord sensor, double rate, std::size_t trial);

// When a pillar of a PapillArray counts as slipping.
enum class SlipRule {
  strict,       // all of it slips
  micro,        // a part of it slips
  paper,        // its tip slides faster than `label_speed`, as a camera would see it
  has_slipped,  // from the first such sample on until it loses contact: "no pillar has slipped", as the paper words its classes
};

inline constexpr double default_label_speed = 1e-4;  // m/s

// The rules' names on the command line: "strict". The parser throws InputError with the nearest name.
SlipRule parse_slip_rule(const std::string& name);
std::vector<std::string> slip_rule_names();
std::string slip_rule_name(SlipRule rule);

}  // namespace slipbench

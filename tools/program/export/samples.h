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

}  // namespace slipbench

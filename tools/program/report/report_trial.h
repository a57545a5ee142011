// Everything that the page draws of one sensor in one trial, and how it draws sensors of that type.
#pragma once

#include <cstddef>
#include <string>

#include "tools/base/page/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::report {

// {"name", "type", "rate_hz", "frame", "positions": [N][2] m, "mu_static", "mu_kinetic", "k_normal", "k_tangential": [N],
//  "touch_s", "micro_onset_s", "onset_s": [N] (null: never), "time": packed, "stride",
//  "states": {"unit", "strict", "micro", "paper", "seen": packed}, "curves": [...], "channels": [...],
//  "spectra": spectra_of()}.
// "seen" is what the loop saw of the detector: there when `control` is not null and reads this sensor.
// A curve is {"key", "origin": "labels" or "sensor", "unit", "components", "per_unit", "data"}: `data` has a column for each unit
// and component, the unit running slowest, and row r belongs to time[r * stride].
// Of a sensor's channels those that hold the same values for each unit are curves.
// "channels": the others, as {"key", "unit", "names": one a value, "time": packed, "data": packed, a column a value}: rows have times of their
// own, of which every so many-th is kept where a channel has more than `curve_values` values.
// States are kept in full. When the curves have more than `curve_values` values in all, every stride-th row is kept.
Json trial_payload(const SensorRecord& sensor, const ControlRecord* control, std::size_t curve_values);

// SensorView of a type as the page reads it: {"unit", "units", "letter", "first", "from_behind", "orientation",
//  "channels": {key: {"name", "note"}}, "picture": null or {"channel", "cells", "width", "rest": null or a number, "falls", "note"}}.
Json view_payload(const std::string& type);

}  // namespace slipbench::report

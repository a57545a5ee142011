// The drawings of a trial.
#pragma once

#include <cstddef>
#include <string>

#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::report {

// {"name", "type", "rate_hz", "frame", "positions": [N][2] m, "mu_static", "mu_kinetic",
// "k_normal", "k_tangential": [N],
//  "touch_s", "micro_onset_s", "onset_s": [N] (null: never), "time": packed, "stride",
//  "states": {"unit", "strict", "micro", "paper", "seen": packed}, "curves": [...], "channels":
//  [...],
//  "spectra": spectra_of()}.
// "seen" is the detector's answer in the loop: present if `control` is not null and reads this
// sensor. A curve is {"key", "origin": "labels" or "sensor", "unit", "components", "per_unit",
// "data"}: `data` has a column for each unit and component, units outermost, and row r is at time[r
// * stride]. A channel is a curve if it has the same values for each unit.
// "channels": the others, as {"key", "unit", "names": one per value, "time": packed, "data":
// packed, one column per value}: rows have their own times, and are thinned if a channel has more
// than `curve_values` values. States are complete. If the curves have more than `curve_values`
// values in total, every stride-th row is kept.
Json trial_payload(const SensorRecord& sensor, const ControlRecord* control, std::size_t curve_values);

// SensorView of a type for the page: {"unit", "units", "letter", "first", "from_behind",
// "orientation",
//  "channels": {key: {"name", "note"}}, "picture": null or {"channel", "cells", "width", "rest":
//  null or a number, "falls", "note"}}.
Json view_payload(const std::string& type);

// [{"name", "unit", "window_s", "bin_hz", "time": packed, of the windows' ends, "data": packed, one
// row per window, one column per bin from 0 Hz}]: of each channel for which the sensor's entry
// requests one (SensorView). Values are magnitudes of detectors/nib/features.h. A spectrogram has
// at most `most_values` values; if necessary, windows are further apart. Recordings shorter than a
// window have none.
Json spectra_of(const SensorRecord& sensor, std::size_t most_values);

}  // namespace slipbench::report

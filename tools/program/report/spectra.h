// Spectrograms of what a sensor emits, for sensors whose papers look at vibration.
#pragma once

#include "tools/base/page/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::report {

// [{"name", "unit", "window_s", "bin_hz", "time": packed, of the windows' ends, "data": packed, a row a window, a column a bin
// from 0 Hz on}]: of each channel for which the sensor's entry asks for one (SensorView). Values are magnitudes of
// detectors/nib/stft.h. A spectrogram has at most `most_values` values: windows are then further apart. Recordings shorter than a
// window have none.
Json spectra_of(const SensorRecord& sensor, std::size_t most_values);

}  // namespace slipbench::report

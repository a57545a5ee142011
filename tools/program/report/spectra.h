// Spectrograms of what a sensor emits, for sensors whose papers look at vibration.
#pragma once

#include "tools/base/dataset/trial_record.h"
#include "tools/base/page/json.h"

namespace slipbench::report {

// [{"name", "unit", "window_s", "bin_hz", "time": packed, of the windows' ends, "data": packed, a row a window, a column a bin from 0 Hz on}]:
// of the nib pad the differences of its FL and FR clusters, in windows of 0.5 s a tenth of a second apart; of the piezoelectric skin its signal,
// in windows of 20 ms, 10 ms apart. Values are magnitudes of detectors/nib/stft.h. No more than `most_values` values a spectrogram: windows are then
// further apart. Empty for other sensors and for recordings shorter than a window.
Json spectra_of(const SensorRecord& sensor, std::size_t most_values);

}  // namespace slipbench::report

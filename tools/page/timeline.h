// Draws a sensor's signals over time with the states of detector and labels, as SVG without
// scripts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/api/pad_state.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::page {

// A part of a recording [s].
struct TimeSpan {
  double begin = 0.0, end = 0.0;
};

// States, probability and alarms drawn with the signals. T: samples of the sensor.
struct TimelineMarks {
  std::vector<TimeSpan> alarms = {};  // shaded in every drawing
  // [T] probability of slip; NaN: no new estimate; empty: no detector, or one without probability
  std::vector<double> probability = {};
  std::vector<PadState> seen = {};     // [T] by the detector; empty: no detector
  std::vector<PadState> labels = {};   // [T]; empty: no labels; samples with another value than PadState has are left blank
  std::string labels_name = "labels";  // "truth" for simulated recordings
};

// Time [s] that pages subtract from the stamps of a recording: the first stamp if the clock started
// long before the recording, as the Unix clock did; else 0. `time`: at least one stamp [s].
double time_origin(const std::vector<double>& time);

// Draws, one below the other with a common time axis: the states of the detector and the labels,
// the probability of slip, and the first `most_channels` channels of the sensor. Vectors such as
// force [units, 3] have one drawing per component. Of more than eight values the eight that change
// the most are drawn. A list of the channels that are not drawn follows. A recording of one sample
// becomes a table of its values. Throws InputError for a time that is not finite, and if the
// channel names do not match the values.
std::string timeline_html(const SensorRecord& sensor, const TimelineMarks& marks, std::size_t most_channels);

}  // namespace slipbench::page

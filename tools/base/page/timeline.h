// Draws a sensor's signals over time with the states by detector and labels, as SVG without scripts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/core/pad_state.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::page {

// A part of a recording [s].
struct TimeSpan {
  double begin = 0.0, end = 0.0;
};

// States, probability and alarms that are drawn with the signals. T: samples of the sensor.
struct TimelineMarks {
  std::vector<TimeSpan> alarms = {};  // shaded in every drawing
  // [T] of slip; NaN: no new estimate; empty: the detector has no probability, or there is no detector
  std::vector<double> probability = {};
  std::vector<PadState> seen = {};     // [T] by the detector; empty: there is no detector
  std::vector<PadState> labels = {};   // [T] empty: there are none
  std::string labels_name = "labels";  // "truth", where they are
};

// The time [s] that pages subtract from the stamps of a recording: its first stamp where a clock counts from long before
// the recording, as the Unix clock does; else 0. `time`: at least one stamp [s].
double time_origin(const std::vector<double>& time);

// Drawings below each other with one time axis: the states by the detector and by the labels, the probability of slip, and
// the first `most_channels` channels of the sensor. Vectors of units, as force [units, 3], have a drawing a component. More
// than eight values are drawn by the eight that change the most. The names of the channels that are not drawn follow. A
// recording of one sample is a table of its values. Throws InputError for a time that is not finite, and where the names of
// the channels do not fit their values.
std::string timeline_html(const SensorRecord& sensor, const TimelineMarks& marks, std::size_t most_channels);

}  // namespace slipbench::page

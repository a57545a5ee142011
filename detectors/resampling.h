// Even frames at the rate that a detector needs, from those of its sensor at another rate or with
// jitter and short gaps.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "sim/api/detector.h"

namespace slipbench {

// Two rates within this relative difference are equal: the clocks of recorders are off by some
// 0.1 %.
inline constexpr double equal_rates = 0.01;

// The longest step that is bridged: `longest_gap`, or `longest_gap_frames` of the detector's frames
// if these last longer. Longer than `gap_frames` frames, a step is a gap; all gaps together may last
// `largest_gap_share` of the recording.
inline constexpr double longest_gap = 0.1;  // s
inline constexpr double longest_gap_frames = 3.0;
inline constexpr double gap_frames = 1.5;
inline constexpr double largest_gap_share = 0.1;

// How a detector's frames follow from those of its sensor.
struct Resampling {
  double wanted = 0.0;     // Hz, rate that the detector needs
  double rate = 0.0;       // Hz, of its frames, by the clock of the sensor
  double stride = 1.0;     // sensor's frames (typical steps between their stamps) from one of these frames to the next
  double step = 0.0;       // s, the typical step; 0: the sensor's frames are evenly spaced
  bool slow = false;       // the sensor is slower than the detector needs
  bool made_up = false;    // it is also slower than the detector is made for, or gaps are too long
  std::size_t gaps = 0;    // bridged
  double largest_gap = 0;  // s, the largest of them

  // False: the detector can read the sensor's own frames.
  [[nodiscard]] bool needed() const { return stride != 1.0 || step != 0.0; }
};

// `rate`: that of the frames that the detector needs [Hz]. `least`: lowest rate of a sensor for whose
// interpolated samples the detector is made [Hz]; 0: `rate`. A sensor within 1 % of a whole multiple
// n of it is read at every n-th sample, by its own clock. `reader`: its name in messages ("the
// network"). Throws InputError, with the remedy, for a slower sensor and for gaps that are not
// bridged, unless the source has `interpolate`.
Resampling resampling_of(const FrameSource& source, double rate, const std::string& reader, double least = 0.0);

// "resampled from 1.5 kHz to 1 kHz for file.onnx"; empty if it is not needed(). `reader`: as above.
std::string resampling_text(const Resampling& resampling, const FrameSource& source, const std::string& reader);

// Wraps a detector that was made for frames at resampling.rate, so that it takes those of `source`.
// A new frame at the time of a sample is that sample. Between samples it is the nearest one, moved
// by its time difference along the slope between its two neighbours: exact for a straight line,
// and white noise keeps its variance (times 1 + x^2/2, x the difference in steps, at most 1/2),
// which an average would lower. It needs the sample after the nearest one, so it comes at most 1.5
// steps late; no other filter is applied, since a sensor at the detector's own rate has none
// either. In a gap, and if the sensor is `slow`, values are interpolated linearly. Slower
// channels keep the latest value. `notice`: Detector::notice().
std::unique_ptr<Detector> resampled(std::unique_ptr<Detector> detector, const Resampling& resampling, const FrameSource& source,
                                    std::string notice);

}  // namespace slipbench

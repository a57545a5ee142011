// Even frames at the rate that a detector needs, from those of its sensor at another rate or with
// jitter and short gaps.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "sim/api/detector.h"

namespace slipbench {

// Two rates within this relative difference are equal: the clocks of recorders are off by some
// 0.1 %.
inline constexpr double equal_rates = 0.01;

// The longest step that is bridged: `longest_gap`, or `longest_gap_frames` of the detector's frames
// if these last longer. Longer than `gap_frames` frames, a step is a gap; all gaps together may last
// `largest_gap_share` of the recording, and so may all stretches that are slower than the detector
// needs.
inline constexpr double longest_gap = 0.1;  // s
inline constexpr double longest_gap_frames = 3.0;
inline constexpr double gap_frames = 1.5;
inline constexpr double largest_gap_share = 0.1;

// A stretch of a recording, in steps, and the relative difference by which its rate is another one:
// with stamps that are off by a fifth of a step, stretches differ by 2 %.
inline constexpr std::size_t stretch_steps = 20;
inline constexpr double other_rate = 0.1;

// How a detector's frames follow from those of its sensor.
struct Resampling {
  double wanted = 0.0;     // Hz, rate that the detector needs
  double rate = 0.0;       // Hz, of its frames, by the clock of the sensor
  double stride = 1.0;     // sensor's frames (`step`) from one of these frames to the next
  double step = 0.0;       // s, one over sampled_rate(); 0: the sensor's frames are evenly spaced
  bool slow = false;       // the sensor is slower than the detector needs
  bool made_up = false;    // it is also slower than the detector is made for, or gaps too long
  std::size_t gaps = 0;    // bridged
  double largest_gap = 0;  // s, the largest of them
  double slowest = 0.0;    // Hz, of a stretch whose rate is below the recording's; 0: none is

  // False: the detector can read the sensor's own frames.
  [[nodiscard]] bool needed() const { return stride != 1.0 || step != 0.0; }
};

// Rate of a recording [Hz]: the number of steps between its stamps that are no gaps, over their
// duration. Here a gap is longer than `gap_frames` typical steps. The typical step is half the
// median of two successive ones, since single steps may alternate. `times`: at least two rising
// stamps [s].
double sampled_rate(std::span<const double> times);

// `rate`: that of the frames that the detector needs [Hz]. `least`: lowest rate of a sensor for
// whose interpolated samples the detector is made [Hz]; 0: `rate`. A sensor within 1 % of a whole
// multiple n of it is read at every n-th sample, by its own clock. `reader`: its name in messages
// ("the network"). Throws InputError, with the remedy, for a slower sensor, also for one that is
// slower in too much of the recording, and for gaps that are not bridged, unless the source has
// `interpolate`.
Resampling resampling_of(const FrameSource& source, double rate, const std::string& reader, double least = 0.0);

// For a detector that needs even frames, at any rate: those at the sampled_rate() of the source's
// stamps. Throws InputError for gaps alone, as above.
Resampling even_resampling_of(const FrameSource& source, const std::string& reader);

// "resampled from 1.5 kHz to 1 kHz for file.onnx", with gaps and slower stretches; empty if it is
// not needed(). `reader`: as above.
std::string resampling_text(const Resampling& resampling, const FrameSource& source, const std::string& reader);

// Wraps a detector that was made for frames at resampling.rate, so that it takes those of `source`.
// A new frame at the time of a sample is that sample. Between samples it is the nearest one, moved
// by its time difference along the slope between its two neighbours: exact for a straight line, and
// white noise keeps its variance, which an average would lower. With even stamps the variance grows
// by 1 + x^2/2, x the difference in steps, at most 1/2; with jitter, neighbours at the distances a
// and b in steps give 1 + 2 x^2/(a + b)^2. A frame needs the sample after the nearest one, so it
// comes at most 1.5 steps late; no other filter is applied, since a sensor at the detector's own
// rate has none either. In a gap, and if the sensor is `slow`, values are interpolated linearly.
// Slower channels keep the latest value. `notice`: Detector::notice().
std::unique_ptr<Detector> resampled(std::unique_ptr<Detector> detector, const Resampling& resampling, const FrameSource& source,
                                    std::string notice);

}  // namespace slipbench

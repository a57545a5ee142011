// A recording of a vibration sensor as the frames that a network sees.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "detectors/spectral/spectral_features.h"
#include "tools/base/dataset/trial_record.h"
#include "tools/program/learn/network.h"

namespace slipbench::learn {

// Whose word a frame's label is.
enum class LabelRule {
  truth,  // PadState by the rule micro: a part slips. By strict all would have to, which elements that stick and slip by turns never do
  paper,  // by the rule of the sensor's paper: of a piezo_skin, that its 100 Hz position has changed
};

// The logarithm (base 10) of the density of each frame of `signal` (SpectralFeatures), to which that of rounding to whole counts is added, so
// that it is finite in silence: 1/12 spread over rate/2 [counts^2/Hz]. [frames, bins]
std::vector<float> log_spectrogram(std::span<const float> signal, const SpectralLayout& layout);

// The frames of a sensor's one channel with one value, sampled at layout.rate. A frame is labelled slip where the sample that ends it is
// incipient or gross. Throws InputError when the sensor is not of that kind, or shorter than a frame.
FrameSequence spectral_sequence(const SensorRecord& sensor, LabelRule rule, const SpectralLayout& layout = {});

// Mean 0 and standard deviation 1 for every feature of the frames that it was made of.
class Standardiser {
 public:
  // A feature that never changes is only shifted. Throws std::invalid_argument of no frame.
  Standardiser(std::span<const FrameSequence> sequences, std::size_t inputs);

  [[nodiscard]] FrameSequence operator()(FrameSequence sequence) const;

 private:
  std::vector<double> mean_, scale_;
};

}  // namespace slipbench::learn

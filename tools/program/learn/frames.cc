#include "tools/program/learn/frames.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/pad_state.h"

namespace slipbench::learn {

std::vector<float> log_spectrogram(std::span<const float> signal, const SpectralLayout& layout) {
  const double rounding = 1.0 / 12.0 / (0.5 * layout.rate);
  SpectralFeatures frames(layout);
  std::vector<float> features;
  for (const float value : signal) {
    if (!frames.push(value)) continue;
    for (const double density : frames.density()) features.push_back(static_cast<float>(std::log10(density + rounding)));
  }
  return features;
}

FrameSequence spectral_sequence(const SensorRecord& sensor, LabelRule rule, const SpectralLayout& layout) {
  if (sensor.channels.size() != 1 || sensor.channels[0].values.size() != sensor.time.size() || sensor.rate != layout.rate) {
    throw InputError(
        fmt::format("sensor {}: is a {} of {} channels at {} Hz; allowed: one channel of one value at {} Hz, as of a piezo_skin",
                    sensor.name, sensor.type, sensor.channels.size(), sensor.rate, layout.rate));
  }
  if (sensor.time.size() < layout.window) {
    throw InputError(
        fmt::format("sensor {}: {} samples are less than a frame of {}", sensor.name, sensor.time.size(), layout.window));
  }
  FrameSequence sequence{log_spectrogram(sensor.channels[0].values, layout), {}};
  const std::vector<std::uint8_t>& states = rule == LabelRule::truth ? sensor.labels.state_micro : sensor.labels.state_paper;
  for (std::size_t last = layout.window - 1; last < states.size(); last += layout.hop) {
    sequence.slip.push_back(static_cast<PadState>(states[last]) >= PadState::incipient ? 1 : 0);
  }
  return sequence;
}

Standardiser::Standardiser(std::span<const FrameSequence> sequences, std::size_t inputs) : mean_(inputs), scale_(inputs) {
  double frames = 0.0;
  for (const FrameSequence& sequence : sequences) {
    const std::size_t whole = sequence.features.size() / inputs;
    frames += static_cast<double>(whole);
    for (std::size_t i = 0; i < sequence.features.size(); ++i) mean_[i % inputs] += static_cast<double>(sequence.features[i]);
  }
  if (frames == 0.0) throw std::invalid_argument("no frame to standardise by");
  for (double& mean : mean_) mean /= frames;
  for (const FrameSequence& sequence : sequences) {
    for (std::size_t i = 0; i < sequence.features.size(); ++i) {
      const double difference = static_cast<double>(sequence.features[i]) - mean_[i % inputs];
      scale_[i % inputs] += difference * difference;
    }
  }
  for (double& scale : scale_) scale = scale > 0.0 ? std::sqrt(frames / scale) : 1.0;
}

FrameSequence Standardiser::operator()(FrameSequence sequence) const {
  for (std::size_t i = 0; i < sequence.features.size(); ++i) {
    const std::size_t input = i % mean_.size();
    sequence.features[i] = static_cast<float>((static_cast<double>(sequence.features[i]) - mean_[input]) * scale_[input]);
  }
  return sequence;
}

}  // namespace slipbench::learn

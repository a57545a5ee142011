#include "tools/program/train/network/scaling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace slipbench::train {

Scale scale_of(std::span<const FrameSequence* const> sequences, std::size_t inputs, Scaling scaling) {
  const std::size_t features = scaling == Scaling::common ? 1 : inputs;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> mean(features), square(features), least(features, infinity), greatest(features, -infinity);
  double count = 0.0;
  const auto for_each = [&](auto&& use) {
    for (const FrameSequence* sequence : sequences) {
      for (std::size_t i = 0; i < sequence->features.size(); ++i) use(i % inputs % features, double{sequence->features[i]});
    }
  };
  for (const FrameSequence* sequence : sequences) count += static_cast<double>(sequence->features.size());
  count /= static_cast<double>(features);
  if (count == 0.0) throw std::invalid_argument("no frame to scale by");
  for_each([&](std::size_t f, double x) {
    mean[f] += x / count;
    least[f] = std::min(least[f], x);
    greatest[f] = std::max(greatest[f], x);
  });
  for_each([&](std::size_t f, double x) { square[f] += (x - mean[f]) * (x - mean[f]) / count; });
  Scale scale;
  for (std::size_t f = 0; f < features; ++f) {
    const double spread = scaling == Scaling::range ? greatest[f] - least[f] : std::sqrt(square[f]);
    scale.offset.push_back(scaling == Scaling::range ? least[f] : mean[f]);
    scale.scale.push_back(greatest[f] > least[f] ? 1.0 / spread : 1.0);
  }
  return scale;
}

void apply(const Scale& scale, FrameSequence& sequence) {
  const std::vector<float> offset(scale.offset.begin(), scale.offset.end()), factor(scale.scale.begin(), scale.scale.end());
  for (std::size_t i = 0; i < sequence.features.size(); ++i) {
    const std::size_t f = i % offset.size();
    sequence.features[i] = (sequence.features[i] - offset[f]) * factor[f];
  }
}

}  // namespace slipbench::train

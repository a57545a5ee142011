#include "detectors/window.h"

#include <cmath>

#include "sim/core/error.h"

namespace slipbench {
namespace {

std::size_t whole_frames(double length, const FrameSource& source, const std::string& detector) {
  constexpr double rounding = 1e-9;  // of a decimal length times a decimal rate
  constexpr double most = 1e6;       // frames kept for each unit: beyond any use
  const double frames = length * source.rate;
  const double whole = std::round(frames);
  if (whole < 1.0 || whole > most || std::abs(frames - whole) > rounding * whole) {
    throw SceneValueError("detector.window", detector + " compares frames that lie " + format_quantity(length, Quantity::time) +
                                                 " apart, and sensors." + source.sensor + " has " +
                                                 format_quantity(source.rate, Quantity::frequency) +
                                                 "; allowed: a whole number of its frames, 1 to 1,000,000");
  }
  return static_cast<std::size_t>(whole);
}

}  // namespace

Window::Window(double length, std::size_t size, const FrameSource& source, const std::string& detector)
    : length_(length), frames_(whole_frames(length, source, detector)), past_(frames_ * size), rates_(size) {}

std::span<const double> Window::rates(std::span<const double> values) {
  const std::span<double> oldest = std::span(past_).subspan(seen_ % frames_ * rates_.size(), rates_.size());
  for (std::size_t i = 0; i < rates_.size(); ++i) {
    if (seen_ >= frames_) rates_[i] = (values[i] - oldest[i]) / length_;
    oldest[i] = values[i];
  }
  ++seen_;
  return rates_;
}

ParameterSpec window_spec() {
  return number_spec("window", Quantity::time, "20 ms", positive,
                     "Time between the two frames that a rate is taken from, a whole number of the sensor's frames.",
                     "assumed: a period of the published loop");
}

}  // namespace slipbench

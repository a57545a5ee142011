#include "detectors/channel.h"

#include "sim/core/error.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {

ChannelPlace vector_channel(const FrameSource& source, std::string_view name, std::string_view unit, const std::string& detector,
                            std::size_t axes) {
  std::size_t first = 0;
  for (const Channel& channel : source.channels) {
    if (channel.name == name && channel.shape.size() == 2 && channel.shape[1] == axes) {
      if (channel.unit != unit) {
        throw SceneValueError("detector.sensor", detector + " reads the " + std::string(name) + " in " + std::string(unit) +
                                                     ", but the " + source.type + " " + quote(source.sensor) + " has it in " +
                                                     quote(channel.unit) + other_unit_remedy(channel.unit, unit));
      }
      return {first, channel.shape[0]};
    }
    first += channel.size();
  }
  std::string found;
  for (const Channel& channel : source.channels) found += (found.empty() ? "" : ", ") + channel.name;
  throw SceneValueError("detector.sensor", detector + " reads a " + std::string(name) +
                                               (axes == 3 ? " in three axes" : " in two axes") + ", which the " + source.type +
                                               " " + quote(source.sensor) + " does not have; found: " + found +
                                               "; the detector deviation reads any channel");
}

std::size_t scalar_channel(const FrameSource& source, std::string_view name, const std::string& detector) {
  std::size_t first = 0;
  for (const Channel& channel : source.channels) {
    if (channel.name == name && channel.size() == 1) return first;
    first += channel.size();
  }
  throw SceneValueError("detector.sensor", detector + " reads a " + std::string(name) + " of one value, which the " +
                                               source.type + " " + quote(source.sensor) + " does not have");
}

std::string even_rates_text(double length, double samples) {
  const double below = std::floor(samples), above = std::ceil(samples);
  return "; at " + (below < 1.0 ? "" : readable_quantity(below / length, Quantity::frequency) + " or ") +
         readable_quantity(above / length, Quantity::frequency) + " it is one; `import --rate` resamples a recording";
}

namespace {

std::size_t whole_frames(double length, const FrameSource& source, const std::string& detector) {
  constexpr double most = 1e6;  // frames kept for each unit, far more than needed
  const double frames = length * source.rate;
  const double whole = std::round(frames);
  if (whole < 1.0 || whole > most || std::abs(frames - whole) > source.rate_rounding * whole) {
    throw SceneValueError("detector.window", detector + " compares frames that are " + format_quantity(length, Quantity::time) +
                                                 " apart, but sensors." + source.sensor + " has " +
                                                 format_quantity(source.rate, Quantity::frequency) +
                                                 "; allowed: 1 to 1,000,000 of its sampling times, a whole number" +
                                                 even_rates_text(length, frames));
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
                     "Time between the two frames from which a rate is computed, a whole number of sampling times.",
                     "assumed: a period of the published loop");
}

}  // namespace slipbench

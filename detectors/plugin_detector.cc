#include "detectors/detector_kinds.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include "detectors/plugin_abi.h"
#include "sim/core/quantity.h"
#include "sim/plugins/plugin_library.h"

namespace slipbench {
namespace {

constexpr double max_stride = 1e9;  // samples per update

std::size_t index_of(const FrameSource& source) {
  const auto found = std::ranges::find(source.sensors, source.sensor, &SensorSource::name);
  if (found == source.sensors.end()) throw std::logic_error("a detector's own sensor is not in the scene");
  return static_cast<std::size_t>(found - source.sensors.begin());
}

class PluginDetector final : public Detector, private SampleListener {
 public:
  PluginDetector(const Parameters& parameters, const FrameSource& source)
      : made_("detector", parameters, SLIPBENCH_DETECTOR_BUILD), own_(index_of(source)), samples_(source.sensors) {
    made_.object.rate = source.rate;
    made_.make<decltype(slipbench_make_detector)>(parameters, source.sensors, own_, &slipbench_detector::update);
    stride_ = stride_of(made_.object.rate, source);
  }

  const SlipEstimate& update(const SensorFrame& frame) override {
    samples_.add(own_, frame);
    if (frames_++ % stride_ != 0) return estimate_;
    const std::span<const slipbench_samples> sensors = samples_.handed();
    const slipbench_detector_input input{.time = frame.time, .sensors = sensors.data(), .sensor_count = sensors.size()};
    slipbench_estimate estimate{.state = -1, .latency = 0.0, .stuck_fraction = std::numeric_limits<double>::quiet_NaN()};
    made_.library.call("update", [&] { made_.object.update(made_.object.self, &input, &estimate); });
    samples_.forget();
    check(estimate, frame.time);
    estimate_ = {frame.time, estimate.latency, static_cast<PadState>(estimate.state), estimate.stuck_fraction};
    return estimate_;
  }

  [[nodiscard]] SampleListener* listener() override { return this; }

  void finish() override { made_.finish(); }

 private:
  // Samples of its own sensor arrive in update().
  void hear(std::size_t sensor, const SensorFrame& sample) override {
    if (sensor != own_) samples_.add(sensor, sample);
  }

  [[nodiscard]] std::size_t stride_of(double rate, const FrameSource& source) const {
    const double frames = std::round(source.rate / rate);
    const bool whole = rate > 0.0 && frames >= 1.0 && frames <= max_stride &&
                       std::abs(frames * rate - source.rate) <= source.rate_rounding * source.rate;
    if (!whole) {
      made_.library.refuse("makes a detector with a rate of " + format_number(rate) + " Hz, which does not divide the " +
                           format_quantity(source.rate, Quantity::frequency) + " of sensors." + source.sensor +
                           "; allowed: the sensor's rate divided by a whole number");
    }
    return static_cast<std::size_t>(frames);
  }

  void check(const slipbench_estimate& estimate, double time) const {
    const auto refuse = [&](const char* member, const std::string& value, const char* allowed) {
      made_.library.refuse("returns in update " + std::string(member) + " " + value + " at " + format_number(time) +
                           " s; allowed: " + allowed);
    };
    if (estimate.state < 0 || estimate.state > 3) {
      refuse("state", std::to_string(estimate.state), "0 no contact, 1 non-slip, 2 incipient, 3 gross");
    }
    if (!(estimate.latency >= 0.0) || std::isinf(estimate.latency))
      refuse("latency", format_number(estimate.latency), "0 s or more, finite");
    if (estimate.stuck_fraction < 0.0 || estimate.stuck_fraction > 1.0) {
      refuse("stuck_fraction", format_number(estimate.stuck_fraction), "0 to 1, or NaN for none");
    }
  }

  PluginObject<slipbench_detector> made_;
  std::size_t own_;
  PluginSamples samples_;
  std::size_t stride_ = 1;
  std::size_t frames_ = 0;
  SlipEstimate estimate_;
};

}  // namespace

DetectorKind plugin_detector() {
  return {
      {"plugin", "A custom detector from a shared library.",
       "The library computes the class from the samples of all sensors. It exports slipbench_detector_abi and slipbench_make_detector (detectors/plugin_abi.h; example: detectors/example).",
       "the library's author", plugin_specs()},
      created<PluginDetector>,
      nullptr,
      FrameSpacing::even,
      {},
      true,
      false,
      DetectorFile{"library", DetectorFile::Content::library, true}};
}

}  // namespace slipbench

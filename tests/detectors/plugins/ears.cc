// Reads the sensor named by the parameter `sensor`: gross while its newest first value is above
// `threshold`, incipient before its first sample. The stuck fraction is a tenth of its number of
// new samples, the latency a thousandth of the number of new samples of its own sensor.
#include <cstring>

#include "detectors/plugin_abi.h"

namespace {

struct Ears {
  size_t own, other;
  double threshold;
};

void update(void* self, const slipbench_detector_input* input, slipbench_estimate* estimate) {
  const auto& ears = *static_cast<const Ears*>(self);
  const slipbench_samples& other = input->sensors[ears.other];
  const slipbench_samples& own = input->sensors[ears.own];
  estimate->state = other.latest == nullptr ? 2 : static_cast<double>(other.latest[0]) > ears.threshold ? 3 : 1;
  estimate->stuck_fraction = 0.1 * static_cast<double>(other.count);
  estimate->latency = 1e-3 * static_cast<double>(own.count);
  // Samples are complete and in order.
  for (size_t i = 1; i < other.count; ++i) {
    if (!(other.times[i] > other.times[i - 1])) estimate->state = -2;
  }
  if (other.count > 0 &&
      (other.latest_time != other.times[other.count - 1] || other.latest[0] != other.values[(other.count - 1)])) {
    estimate->state = -3;
  }
}

void destroy(void* self) { delete static_cast<Ears*>(self); }

}  // namespace

const slipbench_parameter slipbench_detector_parameters[] = {SLIPBENCH_A_TEXT("sensor", ""),
                                                             SLIPBENCH_A_NUMBER("threshold", 0.0, ""),
                                                             SLIPBENCH_A_NUMBER("rate", 0.0, "Hz"), SLIPBENCH_NO_MORE};

const slipbench_abi slipbench_detector_abi = SLIPBENCH_DETECTOR_BUILD;

// Requires a sensor with one value.
void slipbench_make_detector(const slipbench_source* source, slipbench_detector* detector) {
  for (size_t i = 0; i < source->sensor_count; ++i) {
    const slipbench_sensor& sensor = source->sensors[i];
    if (std::strcmp(sensor.name, source->parameters[0].text) != 0 || sensor.value_count != 1) continue;
    detector->self = new Ears{source->sensor, i, source->parameters[1].number};
    if (source->parameters[2].number > 0.0) detector->rate = source->parameters[2].number;
    detector->update = update;
    detector->destroy = destroy;
    return;
  }
  std::strcpy(detector->refusal, "no sensor of this name has one value");
}

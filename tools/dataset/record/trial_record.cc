#include "tools/dataset/record/trial_record.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "tools/files/reject.h"

namespace slipbench {

namespace {

double resolution_of(const SensorRecord& sensor) { return sensor.timing ? sensor.timing->resolution : 0.0; }

}  // namespace

bool evenly_spaced(const SensorRecord& sensor) { return evenly_spaced(sensor.time, resolution_of(sensor)); }

void check_evenly_spaced(const SensorRecord& sensor) {
  if (evenly_spaced(sensor)) return;
  reject("sensor {}: its samples are not evenly spaced ({}); resample them with `slipbench import --rate RATE`", sensor.name,
         timing_text(timing_of(sensor.time, resolution_of(sensor)), sensor.time.front()));
}

std::size_t SensorColumn::row_size() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

const BodyRecord& TrialRecord::body(std::string_view called) const {
  const auto found = std::ranges::find(bodies, called, &BodyRecord::name);
  if (found == bodies.end()) reject("trial {}: has no truth/{}", trial, called);
  return *found;
}

}  // namespace slipbench

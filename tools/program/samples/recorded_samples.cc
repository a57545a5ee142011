#include "tools/program/samples/recorded_samples.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

// Samples from one row of a channel to the next.
std::size_t samples_a_row(const SensorColumn& column, const SensorRecord& sensor) {
  if (!column.time || column.time->size() == sensor.time.size()) return 1;
  if (column.time->size() < 2) return sensor.time.size();
  const double every = std::round(((*column.time)[1] - (*column.time)[0]) * sensor.rate);
  return static_cast<std::size_t>(std::clamp(every, 1.0, static_cast<double>(sensor.time.size())));
}

}  // namespace

RecordedSamples::RecordedSamples(const SensorRecord& sensor) : sensor_(&sensor) {
  std::size_t name = 0;
  for (const SensorColumn& column : sensor.channels) {
    Channel& channel = channels_.emplace_back(Channel{column.name, column.unit, column.shape, {}});
    const std::size_t rows = sensor.times_of(column).size(), size = channel.size();
    if (column.values.size() != rows * size) {
      throw InputError(fmt::format("sensor {}: channel {} has {} values for {} samples of {}; allowed: as many", sensor.name,
                                   column.name, column.values.size(), rows, size));
    }
    channel.every = samples_a_row(column, sensor);
    if (column.time && !column.time->empty() && channel.every <= sensor.time.size()) {
      channel.age = sensor.time[channel.every - 1] - column.time->front();
    }
    for (std::size_t v = 0; v < size && name < sensor.channel_names.size(); ++v) {
      channel.channel_names.push_back(sensor.channel_names[name++]);
    }
    if (rows == 0)
      values_.resize(values_.size() + size);
    else
      values_.insert(values_.end(), column.values.begin(), column.values.begin() + static_cast<std::ptrdiff_t>(size));
  }
}

SensorFrame RecordedSamples::take() {
  float* values = values_.data();
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const std::size_t size = channels_[c].size(), row = next_ / channels_[c].every;
    const std::vector<float>& column = sensor_->channels[c].values;
    if ((next_ + 1) % channels_[c].every == 0 && (row + 1) * size <= column.size()) {
      std::copy_n(column.data() + row * size, size, values);
    }
    values += size;
  }
  return {sensor_->time[next_++], values_};
}

}  // namespace slipbench

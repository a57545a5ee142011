#include "tools/formats/import/resample.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/core/quantity.h"
#include "tools/files/reject.h"
#include "tools/formats/import/source_table.h"

namespace slipbench {
namespace {

constexpr double gap_steps = 1.5;       // step, in median steps, from which at least one sample is missing
constexpr double time_rounding = 1e-9;  // of a step
constexpr double most_instants = 1e9;   // more than the memory of a recording allows

// Position of a new sample: after sample `row`, by `share` of the step to the next.
struct SamplePosition {
  std::size_t row = 0;
  double share = 0.0;
};

std::vector<SamplePosition> positions_of(const std::vector<double>& times, const std::vector<double>& instants) {
  std::vector<SamplePosition> positions;
  std::size_t row = 0;
  for (const double instant : instants) {
    while (row + 2 < times.size() && times[row + 1] <= instant) ++row;
    const double share = (instant - times[row]) / (times[row + 1] - times[row]);
    positions.push_back({row, share < time_rounding ? 0.0 : share > 1.0 - time_rounding ? 1.0 : share});
  }
  return positions;
}

std::vector<float> interpolated(const SensorColumn& column, const std::vector<SamplePosition>& positions) {
  const std::size_t width = column.row_size();
  std::vector<float> values;
  values.reserve(positions.size() * width);
  for (const SamplePosition& position : positions) {
    const float* before = column.values.data() + position.row * width;
    for (std::size_t k = 0; k < width; ++k) {
      // At a sample's own time the value is exact, even if its neighbour is missing (NaN).
      const double value = position.share == 0.0 ? before[k]
                           : position.share == 1.0
                               ? before[width + k]
                               : (1.0 - position.share) * double{before[k]} + position.share * double{before[width + k]};
      values.push_back(static_cast<float>(value));
    }
  }
  return values;
}

std::size_t row_bytes(const SensorRecord& sensor) {
  std::size_t bytes = sizeof(double);
  for (const SensorColumn& channel : sensor.channels) bytes += channel.row_size() * sizeof(float);
  return bytes;
}

std::vector<double> instants_of(const SensorRecord& sensor, double rate, const std::string& place) {
  const double steps = std::floor((sensor.time.back() - sensor.time.front()) * rate + time_rounding);
  if (steps < 1.0)
    reject("{}: has fewer than two samples at {}; use a higher --rate", place, format_quantity(rate, Quantity::frequency));
  if (steps > most_instants || (steps + 1.0) * static_cast<double>(row_bytes(sensor)) > static_cast<double>(largest_recording))
    reject("{}: needs more than {} MB at {}; use a lower --rate", place, largest_recording / 1'000'000,
           format_quantity(rate, Quantity::frequency));
  std::vector<double> instants;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(steps); ++k)
    instants.push_back(sensor.time.front() + static_cast<double>(k) / rate);
  return instants;
}

NewSamples resample_sensor(SensorRecord& sensor, double rate, const std::string& place) {
  if (sensor.time.size() < 2) reject("{}: has one sample; --rate needs recordings of two samples or more", place);
  const SampleTiming timing = sensor.timing ? *sensor.timing : timing_of(sensor.time, 0.0);
  const double most = std::max(timing.mean_rate, timing.median_rate);
  std::vector<double> instants = instants_of(sensor, rate, place);
  const std::vector<SamplePosition> positions = positions_of(sensor.time, instants);
  const double gap = gap_steps / timing.median_rate + timing.resolution;
  const auto between = [](const SamplePosition& position) { return position.share > 0.0 && position.share < 1.0; };
  const auto in_gap = [&](const SamplePosition& position) {
    return between(position) && sensor.time[position.row + 1] - sensor.time[position.row] > gap;
  };
  NewSamples made{.in_gaps = static_cast<std::size_t>(std::ranges::count_if(positions, in_gap)), .recorded_rate = most};
  if (rate > most && !same_rate(rate, most)) made.made_up = static_cast<std::size_t>(std::ranges::count_if(positions, between));
  for (SensorColumn& channel : sensor.channels) channel.values = interpolated(channel, positions);
  if (!sensor.labels.state_paper.empty()) {
    std::vector<std::uint8_t> states;
    for (const SamplePosition& position : positions)
      states.push_back(sensor.labels.state_paper[position.share < 1.0 ? position.row : position.row + 1]);
    sensor.labels.state_paper = std::move(states);
  }
  sensor.time = std::move(instants);
  sensor.rate = rate;
  sensor.timing = timing;
  sensor.timing->resolution = 0.0;
  return made;
}

}  // namespace

NewSamples resample(TrialRecord& record, double rate, const std::string& place) {
  NewSamples most;
  for (SensorRecord& sensor : record.sensors) {
    const NewSamples made = resample_sensor(sensor, rate, place);
    most.in_gaps = std::max(most.in_gaps, made.in_gaps);
    if (made.made_up <= most.made_up) continue;
    most.made_up = made.made_up;
    most.recorded_rate = made.recorded_rate;
  }
  record.body_time = record.sensors.front().time;
  return most;
}

}  // namespace slipbench

#include "tools/program/eval/replay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/run/sampling.h"

namespace slipbench::eval {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Sensors whose steps differ say the same instant with another last digit.
bool is_later(double time, double now) { return time > now + 4.0 * std::numeric_limits<double>::epsilon() * std::abs(now); }

// Samples from one row of a channel to the next.
std::size_t samples_a_row(const SensorColumn& column, const SensorRecord& sensor) {
  if (!column.time || column.time->size() == sensor.time.size()) return 1;
  if (column.time->size() < 2) return sensor.time.size();
  const double every = std::round(((*column.time)[1] - (*column.time)[0]) * sensor.rate);
  return static_cast<std::size_t>(std::clamp(every, 1.0, static_cast<double>(sensor.time.size())));
}

// A sensor's recorded samples, one after the other, as it measured them.
class Samples {
 public:
  explicit Samples(const SensorRecord& sensor) : sensor_(&sensor) {
    std::size_t name = 0;
    for (const SensorColumn& column : sensor.channels) {
      Channel& channel = channels_.emplace_back(Channel{column.name, column.unit, column.shape, {}});
      channel.every = samples_a_row(column, sensor);
      if (column.time && !column.time->empty() && channel.every <= sensor.time.size()) {
        channel.age = sensor.time[channel.every - 1] - column.time->front();
      }
      for (std::size_t v = 0; v < column.row_size() && name < sensor.channel_names.size(); ++v) {
        channel.channel_names.push_back(sensor.channel_names[name++]);
      }
      const std::size_t size = std::min(column.row_size(), column.values.size());
      values_.insert(values_.end(), column.values.begin(), column.values.begin() + static_cast<std::ptrdiff_t>(size));
      values_.resize(values_.size() + column.row_size() - size);
    }
  }

  [[nodiscard]] SensorSource source() const { return {sensor_->name, sensor_->type, sensor_->rate, channels_}; }
  [[nodiscard]] bool ended() const { return next_ == sensor_->time.size(); }
  [[nodiscard]] double time() const { return sensor_->time[next_]; }  // s, of the next one
  SensorFrame take() {
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

 private:
  const SensorRecord* sensor_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  std::size_t next_ = 0;
};

// Where a feature stands among a detector's.
std::optional<std::size_t> place_of(const std::vector<Feature>& features, const char* name) {
  const auto found = std::ranges::find(features, name, &Feature::name);
  if (found == features.end()) return std::nullopt;
  return static_cast<std::size_t>(found - features.begin());
}

double checked_probability(double value, double time) {
  if (std::isnan(value) || (value >= 0.0 && value <= 1.0)) return value;
  throw InputError(fmt::format("at {:.6g} s the detector's {} is {}; allowed: 0 to 1", time, probability_feature, value));
}

// Writes what is seen at each sample.
class Rows {
 public:
  Rows(DelayedDetector& detector, std::size_t samples)
      : detector_(&detector),
        place_(place_of(detector.features(), probability_feature)),
        class_place_(place_of(detector.features(), class_feature)) {
    rows_.seen.reserve(samples);
    for (std::vector<double>* column : {&rows_.seen_since, &rows_.stuck_fraction, &rows_.probability, &rows_.named})
      column->reserve(samples);
  }

  void add(const SensorFrame& frame) {
    detector_->update(frame);
    const SlipEstimate& now = detector_->seen_at(frame.time);
    // A detector without features has the latest estimate of its loop before the first as well, which says no_contact.
    const bool fresh = now.time != last_;
    last_ = now.time;
    rows_.seen.push_back(now.state);
    rows_.seen_since.push_back(now.time + now.latency);
    rows_.stuck_fraction.push_back(now.stuck_fraction);
    const bool says = fresh && place_ && *place_ < now.features.size();
    rows_.named.push_back(fresh && class_place_ && *class_place_ < now.features.size() ? now.features[*class_place_] : unknown);
    rows_.probability.push_back(says ? checked_probability(now.features[*place_], now.time) : unknown);
  }
  Replayed take() { return std::move(rows_); }

 private:
  DelayedDetector* detector_;
  std::optional<std::size_t> place_, class_place_;
  double last_ = unknown;
  Replayed rows_;
};

}  // namespace

Replayed replay(const DetectorScene& detector, std::span<const SensorRecord> sensors, std::size_t sensor, std::uint64_t seed,
                std::uint64_t trial) {
  std::vector<SensorSource> sources;
  double duration = 0.0;
  for (const SensorRecord& record : sensors) {
    if (record.time.empty()) throw InputError(fmt::format("sensor {}: has no samples", record.name));
    sources.push_back(Samples(record).source());
    duration = std::max(duration, record.time.back());
  }
  const SensorSource& own = sources[sensor];
  return replay(make_detector(detector, {own.name, own.type, own.rate, own.channels, trial, duration, seed, sources}), sensors,
                sensor);
}

Replayed replay(std::unique_ptr<Detector> detector, std::span<const SensorRecord> sensors, std::size_t sensor) {
  std::vector<Samples> samples(sensors.begin(), sensors.end());
  DelayedDetector delayed(std::move(detector));
  Rows rows(delayed, sensors[sensor].time.size());
  SampleListener* const listener = delayed.listener();
  if (listener == nullptr) {
    while (!samples[sensor].ended()) rows.add(samples[sensor].take());
  }
  while (listener != nullptr && std::ranges::any_of(samples, [](const Samples& one) { return !one.ended(); })) {
    double now = std::numeric_limits<double>::infinity();
    for (const Samples& one : samples) now = one.ended() ? now : std::min(now, one.time());
    std::optional<SensorFrame> frame;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (samples[k].ended() || is_later(samples[k].time(), now)) continue;
      const SensorFrame taken = samples[k].take();
      listener->hear(k, taken);
      if (k == sensor) frame = taken;
    }
    if (frame) rows.add(*frame);
  }
  delayed.finish();
  return rows.take();
}

}  // namespace slipbench::eval

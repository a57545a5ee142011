#include "tools/studies/nib_reconfigurable/nib_trace.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slipbench::reproduce {

NibTrace::NibTrace(const TrialRecord& record) {
  const auto lever = std::ranges::find(record.bodies, "lever", &BodyRecord::name);
  if (record.sensors.size() != 1 || lever == record.bodies.end()) throw std::logic_error("no trial of the lever bench");
  const SensorRecord& sensor = record.sensors.front();
  source_ = {sensor.name, sensor.type, sensor.rate, {}};
  time_ = sensor.time;
  for (const SensorColumn& column : sensor.channels) {
    Channel channel{column.name, column.unit, column.shape, {}};
    if (column.time) {
      if (column.time->size() < 2) throw std::invalid_argument("a trial of fewer than two rows of a channel");
      channel.every = static_cast<std::size_t>(std::lround((column.time->at(1) - column.time->at(0)) * sensor.rate));
    }
    frame_size_ += channel.size();
    source_.channels.push_back(std::move(channel));
  }
  // A slow channel stands still until its next row; before the first there is nothing of it.
  frames_.resize(size() * frame_size_);
  std::size_t place = 0;
  for (std::size_t c = 0; c < source_.channels.size(); ++c) {
    const std::size_t width = source_.channels[c].size(), every = source_.channels[c].every;
    for (std::size_t k = every - 1; k < size(); ++k) {
      std::copy_n(sensor.channels[c].values.data() + ((k + 1) / every - 1) * width, width,
                  frames_.data() + k * frame_size_ + place);
    }
    place += width;
  }
  const std::size_t units = sensor.labels.units();
  normal_.resize(size());
  lever_.resize(size());
  for (std::size_t k = 0; k < size(); ++k) {
    for (std::size_t unit = 0; unit < units; ++unit) normal_[k] += double{sensor.labels.force[3 * (k * units + unit) + 2]};
    lever_[k] = double{lever->pose[7 * k + 1]};
  }
}

std::size_t NibTrace::at(double time) const {
  return static_cast<std::size_t>(std::ranges::lower_bound(time_, time) - time_.begin());
}

std::optional<std::size_t> NibTrace::moved(std::size_t from, double way) const {
  for (std::size_t k = from; k < size(); ++k) {
    if (lever_[k] - lever_[from] >= way) return k;
  }
  return std::nullopt;
}

std::optional<std::size_t> NibTrace::detection(Detector& detector) const {
  for (std::size_t k = 0; k < size(); ++k) {
    if (detector.update(frame(k)).state == PadState::gross) return k;
  }
  return std::nullopt;
}

std::vector<NibTrace::Window> NibTrace::windows(const Parameters& parameters) const {
  nib::FeatureReader reader(parameters, source_, "a reproduction");
  std::vector<Window> found;
  for (std::size_t k = 0; k < size(); ++k) {
    if (reader.update(frame(k))) found.push_back({k, reader.features()});
  }
  return found;
}

}  // namespace slipbench::reproduce

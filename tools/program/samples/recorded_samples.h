// A recorded sensor's samples, one after the other, as it measured them.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/core/sensor_frame.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

class RecordedSamples {
 public:
  // `sensor` outlives it. Throws InputError for a channel that has not as many values as its rows and shape say.
  explicit RecordedSamples(const SensorRecord& sensor);

  [[nodiscard]] SensorSource source() const { return {sensor_->name, sensor_->type, sensor_->rate, channels_}; }
  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }
  [[nodiscard]] bool ended() const { return next_ == sensor_->time.size(); }
  [[nodiscard]] double time() const { return sensor_->time[next_]; }  // s, of the next one

  // The next one. Of a slower channel the latest row that is complete, before its first one that first one.
  SensorFrame take();

 private:
  const SensorRecord* sensor_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  std::size_t next_ = 0;
};

}  // namespace slipbench

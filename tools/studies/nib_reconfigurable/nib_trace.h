// A trial on the nib pad's lever bench (scenes/nib_pad), as its figures are made of it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "detectors/nib/features.h"
#include "sim/core/detector.h"
#include "sim/core/parameters.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::reproduce {

class NibTrace {
 public:
  // `record`: full, of a scene with one nib pad and a recorded body "lever". Throws std::logic_error of any other.
  explicit NibTrace(const TrialRecord& record);

  [[nodiscard]] std::size_t size() const { return time_.size(); }
  [[nodiscard]] double time(std::size_t sample) const { return time_[sample]; }      // s
  [[nodiscard]] double normal(std::size_t sample) const { return normal_[sample]; }  // N, true, of all nibs
  [[nodiscard]] double lever(std::size_t sample) const { return lever_[sample]; }    // m, where the lever is, along the pull
  [[nodiscard]] const FrameSource& source() const { return source_; }

  // The first sample at or after `time` [s]; size() where there is none.
  [[nodiscard]] std::size_t at(double time) const;
  // The first sample from `from` on at which the lever has gone by `way` [m] since; empty: it never has.
  [[nodiscard]] std::optional<std::size_t> moved(std::size_t from, double way) const;

  // The sample as the sensor emitted it.
  [[nodiscard]] SensorFrame frame(std::size_t sample) const {
    return {time_[sample], std::span(frames_).subspan(sample * frame_size_, frame_size_)};
  }
  // The sample in which a detector that is fed all of them first says gross; empty: in none.
  [[nodiscard]] std::optional<std::size_t> detection(Detector& detector) const;

  // Features at the end of a window.
  struct Window {
    std::size_t sample;
    nib::Features features;
  };
  // Of all windows, with the parameters of nib::feature_specs().
  [[nodiscard]] std::vector<Window> windows(const Parameters& parameters) const;

 private:
  FrameSource source_;
  std::size_t frame_size_ = 0;
  std::vector<double> time_, normal_, lever_;
  std::vector<float> frames_;
};

}  // namespace slipbench::reproduce

// Signals of the nib pad in a grasp: the laws that they follow, a recorded trial of them, what marks a slip in them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "detectors/nib/features.h"
#include "sim/core/detector.h"
#include "sim/core/parameters.h"
#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

// The friction laws that the nib pad's slip tests are repeated with.

// A change of the scene's friction, of which everything else stays.
struct FrictionLaw {
  const char* name;
  const char* text;
  std::function<void(Scene&)> change;
};

// The scene's own law first.
const std::vector<FrictionLaw>& friction_laws();

// A trial on the nib pad's lever bench (scenes/nib_pad), as its figures are made of it.
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

  // The sample as the sensor emitted it; of a slow channel, before its first row is complete, that row.
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

// Where the nib pad's signal below 8 Hz comes from: its energy while the pad slips, under one friction law after the other.

// Of the difference of FL in the windows that lie within one slip.
struct Signature {
  bool wavy = false;                // the plate has waves
  double share = 0.0;               // of the energy above 0 Hz that is below 8 Hz
  double time = 0.0;                // s, that the slip takes
  double below = 0.0, above = 0.0;  // counts rms, below and above 8 Hz
};

// From when the lever has gone 0.3 mm beyond where it stood when the detector began to count, to 10 mm. Empty where that is
// shorter than a window, or the pad does not slip.
std::optional<Signature> signature_of(const Scene& scene, const NibTrace& trace);

// The table, without rows, and those of one law: in it and in `figures`, an array.
ResultTable signature_table();
void add_signatures(const char* law, const std::vector<std::optional<Signature>>& found, ResultTable& table, Json& figures);

}  // namespace slipbench::reproduce

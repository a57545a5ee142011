// Algorithm 1 of the nib pad's paper: slip along the pull, told from flags that the fast linear mode raises.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {
namespace nib {

// The algorithm itself. Once a spectrum:
//   the counter grows by one when the magnitude is above `threshold`, and falls by one, to 0 at least, when the last such flag is more
//   than `patience` ago; slip is detected when it has reached CounterMax = M - alpha |F_S,y|/F_N, which is at least 1.
class FlagCounter {
 public:
  struct Settings {
    double threshold;  // counts
    double most;       // M
    double weight;     // alpha
    double patience;   // s
  };
  explicit FlagCounter(const Settings& settings) : settings_(settings) {}

  // The spectrum at `time` [s] with this magnitude [counts], and shear over normal force at that time. Whether slip is detected, now or before.
  bool update(double time, double magnitude, double ratio);

  [[nodiscard]] int count() const { return count_; }

 private:
  Settings settings_;
  int count_ = 0;
  double last_flag_ = 0.0;  // s; counts only while count_ > 0, and then there was one
  bool detected_ = false;
};

}  // namespace nib

// The catalogue's entry.
Entry nib_linear_slip_entry();

// `parameters`: those of nib_linear_slip_entry(), all present. `source` must be a nib pad (detectors/nib/features.h). An estimate a
// frame, without latency: no_contact, non_slip, and gross from the detection on until the pad touches nothing. It hands on the features of
// nib::handed_on().
std::unique_ptr<Detector> make_nib_linear_slip(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench

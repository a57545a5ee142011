// Slip detectors of the nib pad: Algorithm 1 and the kinds of slip.
#pragma once

#include <cstdint>

#include "detectors/nib/features.h"

namespace slipbench::nib {

// Algorithm 1 of the nib pad's paper: detects slip along the pull from flags raised by the fast
// linear mode.

// The algorithm itself. At each spectrum the counter grows by one if the magnitude is above
// `threshold`, and falls by one, not below 0, if the last such flag is more than `patience` ago.
// Slip is detected once the counter reaches CounterMax = M - alpha |F_S,y|/F_N, which is at least
// 1.
class FlagCounter {
 public:
  struct Settings {
    double threshold;  // counts
    double most;       // M
    double weight;     // alpha
    double patience;   // s
  };
  explicit FlagCounter(const Settings& settings) : settings_(settings) {}

  // Takes the spectrum at `time` [s] with this magnitude [counts], and the ratio of shear to normal
  // force at that time. Returns true if slip is detected, now or before.
  bool update(double time, double magnitude, double ratio);

  [[nodiscard]] int count() const { return count_; }

 private:
  Settings settings_;
  int count_ = 0;
  double last_flag_ = 0.0;  // s; valid only while count_ > 0
  bool detected_ = false;
};

// No slip, linear or rotational slip, from the three features of the nib pad's paper.

// Values of the feature `kind`.
enum class SlipKind : std::uint8_t { none = 0, linear = 1, rotational = 2 };

// Thresholds on the features. The paper draws them (Fig. 12) without numbers.
struct KindBounds {
  double fl, fr;  // counts: a magnitude above its bound is a slip
  double curl;    // |curl| at and above which slip is rotational
};

SlipKind slip_kind(const Features& features, const KindBounds& bounds);

}  // namespace slipbench::nib

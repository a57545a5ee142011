// The nib pad's detectors of slip: Algorithm 1, and the kinds of slip.
#pragma once

#include <cstdint>

#include "detectors/nib/features.h"

namespace slipbench::nib {

// Algorithm 1 of the nib pad's paper: slip along the pull, told from flags that the fast linear mode raises.

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

// No slip, linear or rotational slip, from the three features of the nib pad's paper.

// Values are those of the feature `kind`.
enum class SlipKind : std::uint8_t { none = 0, linear = 1, rotational = 2 };

// Bounds in the space of the features, which the paper draws (Fig. 12) and gives no numbers for.
struct KindBounds {
  double fl, fr;  // counts: a magnitude above its bound is a slip
  double curl;    // |curl| from which on it is a rotation
};

SlipKind slip_kind(const Features& features, const KindBounds& bounds);

}  // namespace slipbench::nib

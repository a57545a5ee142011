// Effects of a sensor's electronics on its readings, and how much of the difference between two
// recordings they explain.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tools/calibrate/recordings.h"

namespace slipbench::calibrate {

// Model of a reading y of one component of a channel, the same for every unit:
//   y = s + gain (s - s_begin) + sum of coupling (s' - s'_begin) + offset + remainder
// s is the ideal reading, s_begin its first value, s' runs over the unit's other components. Gain
// and couplings are drawn once per device, the offset once per recording.
struct Disturbance {
  double gain_sd = 0.0;       // relative
  double coupling_sd = 0.0;   // dimensionless, since all components of a channel have one unit
  double offset_sd = 0.0;     // in the channel's unit
  double remainder_sd = 1.0;  // of the mean of a stretch, in the channel's unit; the sensor's repeatability
};

// The columns of several recordings, [recording](bins, columns).
using Waves = std::vector<Eigen::MatrixXd>;

// Distance between recordings and simulated ones after subtracting possible effects of the
// electronics.
struct Distance {
  Eigen::VectorXd
      residual;  // of all stretches by recording and column, over remainder_sd; then offsets, gains and couplings over their sds
  std::vector<Eigen::Index>
      group;                      // of each entry of `residual`; entries of one group may be correlated (a column of a recording)
  Waves explained;                // the simulated recordings with the best gains, couplings and offsets
  Eigen::VectorXd gain;           // by column
  Eigen::MatrixXd offset;         // by recording and column
  double squared = 0.0;           // residual' residual
  bool possible = true;           // false: the scene refuses too many trials to compare any; `squared` is then very large
  Eigen::Index compared = 0;      // number of entries of `residual` that are of recordings
  double compared_squared = 0.0;  // sum of squares of those
};

class Disturbances {
 public:
  // Estimates the disturbances from pairs of readings of a scene with and without its electronics,
  // where each pair is another device. `floor`: the least remainder of a component, as a share of
  // its range over all recordings.
  Disturbances(const Columns& columns, const std::vector<Waves>& read, const std::vector<Waves>& ideal, double floor);

  [[nodiscard]] const Columns& columns() const { return columns_; }
  // Ordered by channel, then by component.
  [[nodiscard]] const std::vector<Disturbance>& by_component() const { return disturbances_; }

  // Returns the best linear fit of `read` by `ideal` under these disturbances: ridge regression
  // with a Gaussian prior of each sd, the linear part of a variable projection [golub1973]. The
  // gains of a component have the mean 1 over its units, weighted by the units' signal energy: a
  // gain common to all units cannot be distinguished from the sensor's stiffness or sensitivity.
  [[nodiscard]] Distance distance(const Waves& read, const Waves& ideal) const;

  // Returns, by column, the common gain: a device's changes from its first value, divided by it,
  // have gains with the mean 1.
  [[nodiscard]] Eigen::VectorXd common_gain(const Waves& read, const Waves& ideal) const;

 private:
  Columns columns_;
  std::vector<Disturbance> disturbances_;
};

}  // namespace slipbench::calibrate

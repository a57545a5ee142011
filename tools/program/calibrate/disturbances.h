// What a sensor's electronics do to its readings, and how much of the difference between two recordings they explain.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tools/program/calibrate/recordings.h"

namespace slipbench::calibrate {

// What one component of a channel is taken for, in every unit alike. Read as: y = s + gain (s - s_begin) + coupling * (the same of the unit's
// other components) + offset + remainder, with a gain and couplings a device, an offset a recording.
struct Disturbance {
  double gain_sd = 0.0;       // relative
  double coupling_sd = 0.0;   // unit of the component over unit of the channel, which is one
  double offset_sd = 0.0;     // in the channel's unit
  double remainder_sd = 1.0;  // of the mean of a stretch, in the channel's unit: the sensor's repeatability
};

// The columns of several recordings, [recording](bins, columns).
using Waves = std::vector<Eigen::MatrixXd>;

// How far recordings are from simulated ones once what electronics may do is taken off.
struct Distance {
  Eigen::VectorXd
      residual;  // of all stretches by recording and column in remainder_sd; then what gains, couplings and offsets take, in their sds
  std::vector<Eigen::Index> group;  // of each entry of `residual`: which of them may hang together (a column of a recording)
  Waves explained;                  // the simulated recordings with the gains, couplings and offsets that fit best
  Eigen::VectorXd gain;             // by column
  Eigen::MatrixXd offset;           // by recording and column
  double squared = 0.0;             // residual' residual
  bool possible = true;       // false: the scene refuses so much that there is nothing to compare; `squared` is then very large
  Eigen::Index compared = 0;  // how many of `residual` are of recordings
  double compared_squared = 0.0;  // sum of squares of those
};

class Disturbances {
 public:
  // Learns them from pairs of what a scene reads with its electronics and without; each pair is a device of its own. `floor`: the least
  // remainder of a component, as a share of its range over all recordings.
  Disturbances(const Columns& columns, const std::vector<Waves>& read, const std::vector<Waves>& ideal, double floor);

  [[nodiscard]] const Columns& columns() const { return columns_; }
  // In the order of channels and, in each, of components.
  [[nodiscard]] const std::vector<Disturbance>& by_component() const { return disturbances_; }

  // The best linear fit of `read` by `ideal` under these disturbances (ridge regression: a Gaussian prior of each sd; McCulloch and others call the
  // whole variable projection, Golub and Pereyra 1973). The gains of a component have the mean 1 over its units, weighted by what these carry: what
  // all units share is the sensor's stiffness or sensitivity, which no recording tells from a common gain.
  [[nodiscard]] Distance distance(const Waves& read, const Waves& ideal) const;

  // By column what a device's departures from where it begins are to be divided by for its gains to have that mean.
  [[nodiscard]] Eigen::VectorXd common_gain(const Waves& read, const Waves& ideal) const;

 private:
  Columns columns_;
  std::vector<Disturbance> disturbances_;
};

}  // namespace slipbench::calibrate

#include "sim/grasp/push.h"

#include <algorithm>
#include <utility>

#include "sim/core/error.h"

namespace slipbench {

Push::Push(NumberTable rows) : rows_(std::move(rows)) {
  const std::vector<std::vector<double>>& all = rows_.rows;
  if (!all.empty() && all.front()[0] == all.back()[0])
    throw SceneValueError("box.push", "has rows at a single time; it needs at least two times, between which the force acts");
  check_times(rows_, "box.push");
}

Eigen::Vector3d Push::mean(double begin, double end) const {
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k < rows_.rows.size(); ++k) {
    const std::vector<double>&first = rows_.rows[k - 1], &last = rows_.rows[k];
    const double from = std::max(begin, first[0]), until = std::min(end, last[0]);
    if (!(from < until)) continue;
    const Eigen::Vector3d force = Eigen::Vector3d::Map(&first[1]);
    const Eigen::Vector3d slope = (Eigen::Vector3d::Map(&last[1]) - force) / (last[0] - first[0]);
    impulse += (until - from) * (force + (0.5 * (from + until) - first[0]) * slope);
  }
  return impulse / (end - begin);
}

}  // namespace slipbench

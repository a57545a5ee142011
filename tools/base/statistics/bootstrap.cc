#include "tools/base/statistics/bootstrap.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim/core/random.h"
#include "tools/base/statistics/descriptive.h"

namespace slipbench {

std::vector<Interval> bootstrap_intervals(std::size_t groups, std::size_t draws, std::uint64_t seed,
                                          const std::function<std::vector<double>(std::span<const std::size_t>)>& figures) {
  if (draws == 0) throw std::logic_error("a bootstrap needs a draw");
  std::vector<std::size_t> drawn(groups);
  std::vector<std::vector<double>> values;  // [figure][draw]
  for (std::size_t draw = 0; draw < draws; ++draw) {
    RandomStream stream(seed, draw, "intervals");
    for (std::size_t& group : drawn) group = stream.integer(groups);
    const std::vector<double> found = figures(drawn);
    values.resize(found.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (!std::isnan(found[k])) values[k].push_back(found[k]);
    }
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Interval> intervals;
  for (const std::vector<double>& of_figure : values) {
    intervals.push_back(groups < 2 ? Interval{nan, nan} : Interval{quantile(of_figure, 0.025), quantile(of_figure, 0.975)});
  }
  return intervals;
}

}  // namespace slipbench

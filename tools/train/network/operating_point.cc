#include "tools/train/network/operating_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "sim/core/math.h"
#include "tools/statistics/descriptive.h"
#include "tools/train/network/examples.h"

namespace slipbench::train {
namespace {

// Probabilities of the unmasked frames by truth: hold, slip. Sorted.
std::array<std::vector<double>, 2> sorted_by_truth(std::span<const SlipSeries> series) {
  std::array<std::vector<double>, 2> by_truth;
  for (const SlipSeries& one : series) {
    for (std::size_t t = 0; t < one.truth.size(); ++t) {
      if (one.truth[t] != masked) by_truth.at(one.truth[t]).push_back(one.probability[t]);
    }
  }
  for (std::vector<double>& part : by_truth) std::ranges::sort(part);
  return by_truth;
}

std::vector<double> merged(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> all;
  std::ranges::merge(a, b, std::back_inserter(all));
  return all;
}

}  // namespace

double AlarmCounts::alarms_per_minute(double period) const {
  const double held = static_cast<double>(samples_in(frames, PadState::non_slip)) * period;
  return held > 0.0 ? 60.0 * static_cast<double>(false_alarms) / held : std::numeric_limits<double>::quiet_NaN();
}

double AlarmCounts::score(double period) const {
  const double wrong = share_of(samples_in(frames, PadState::non_slip, PadState::gross), samples_in(frames, PadState::non_slip));
  return credit / static_cast<double>(slips) * std::min(1.0, alarm_limit / alarms_per_minute(period)) - wrong;
}

AlarmCounts counts_at(std::span<const SlipSeries> series, double period, double threshold, const network::Alarm& alarm) {
  AlarmCounts counts;
  for (const SlipSeries& one : series) {
    const std::size_t onset = static_cast<std::size_t>(std::ranges::find(one.truth, 1) - one.truth.begin());
    counts.slips += onset < one.truth.size() ? 1 : 0;
    network::AlarmGate gate(alarm);
    bool before = false, ever = false;
    for (std::size_t t = 0; t < one.truth.size(); ++t) {
      const bool said = gate.push(one.probability[t] >= threshold), begins = !std::exchange(before, said) && said;
      if (one.truth[t] == masked) continue;
      count(counts.frames, one.truth[t] == 1, said);
      counts.false_alarms += begins && one.truth[t] == 0 ? 1U : 0U;
      if (said && !std::exchange(ever, true) && t >= onset)
        counts.credit += half_delay / (half_delay + static_cast<double>(t - onset) * period);
    }
  }
  return counts;
}

OperatingPoint most_accurate_point(std::span<const SlipSeries> series, double period) {
  const auto [hold, slip] = sorted_by_truth(series);
  OperatingPoint point;
  if (!hold.empty() && !slip.empty()) {
    const std::vector<double> all = merged(hold, slip);
    double accuracy = 0.0;
    std::size_t held = 0, missed = 0;  // below the threshold, by truth
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      if (all[i] == all[i + 1]) continue;
      const double here = 0.5 * (all[i] + all[i + 1]);
      while (held < hold.size() && hold[held] < here) ++held;
      while (missed < slip.size() && slip[missed] < here) ++missed;
      const double right = static_cast<double>(held) / static_cast<double>(hold.size()) + 1.0 -
                           static_cast<double>(missed) / static_cast<double>(slip.size());
      if (right > accuracy || (right == accuracy && std::abs(here - 0.5) < std::abs(point.threshold - 0.5))) {
        point.threshold = here;
        accuracy = right;
      }
    }
  }
  point.alarms_per_minute = counts_at(series, period, point.threshold, point.alarm).alarms_per_minute(period);
  return point;
}

OperatingPoint best_point(std::span<const SlipSeries> series, double period, std::optional<double> alarms) {
  const auto [hold, slip] = sorted_by_truth(series);
  const bool timeless = std::ranges::all_of(series, [](const SlipSeries& one) { return one.truth.size() < 2; });
  if (timeless || hold.empty() || slip.empty()) return most_accurate_point(series, period);
  constexpr std::size_t steps = 48;
  const std::vector<double> all = merged(hold, slip);
  std::set<double> thresholds{most_accurate_point(series, period).threshold};
  for (std::size_t k = 0; k < steps; ++k) {
    const double above = math::pow(static_cast<double>(hold.size()), 1.0 - static_cast<double>(k) / (steps - 1));
    const double below = hold[hold.size() - static_cast<std::size_t>(above)];
    if (const auto next = std::ranges::upper_bound(all, below); next != all.end()) thresholds.insert(0.5 * (below + *next));
  }
  std::set<std::size_t> rows;
  for (const double seconds : {0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5})
    rows.insert(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(seconds / period))));

  OperatingPoint best;
  std::pair<double, double> worth{-std::numeric_limits<double>::infinity(),
                                  0.0};  // negative number of excess alarms, then accuracy or score
  for (const std::size_t on : rows) {
    for (const std::size_t off : rows) {
      for (const std::size_t least : {std::size_t{1}, *rows.rbegin()}) {
        for (const double threshold : thresholds) {
          const network::Alarm alarm{on, off, least};
          const AlarmCounts counts = counts_at(series, period, threshold, alarm);
          const double rate = counts.alarms_per_minute(period);
          const std::pair here = alarms ? std::pair{-std::max(rate - *alarms, 0.0), balanced_slip_accuracy(counts.frames)}
                                        : std::pair{0.0, counts.score(period)};
          if (here <= worth) continue;
          worth = here;
          best = {threshold, alarm, rate};
        }
      }
    }
  }
  return best;
}

}  // namespace slipbench::train

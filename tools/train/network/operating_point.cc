#include "tools/train/network/operating_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "sim/core/math.h"
#include "tools/files/reject.h"
#include "tools/statistics/descriptive.h"
#include "tools/statistics/slip_score.h"
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

bool all_single_frames(std::span<const SlipSeries> series) {
  return std::ranges::all_of(series, [](const SlipSeries& one) { return one.truth.size() < 2; });
}

// Thresholds, and numbers of consecutive frames, that a choice tries.
struct Candidates {
  std::set<double> thresholds;
  std::set<std::size_t> frames;
};

Candidates candidates_of(std::span<const SlipSeries> series, double period) {
  constexpr std::size_t steps = 48;
  const auto [hold, slip] = sorted_by_truth(series);
  const std::vector<double> all = merged(hold, slip);
  Candidates candidates{{most_accurate_point(series, period).threshold}, {}};
  for (std::size_t k = 0; k < steps; ++k) {
    const double above = math::pow(static_cast<double>(hold.size()), 1.0 - static_cast<double>(k) / (steps - 1));
    const double below = hold[hold.size() - static_cast<std::size_t>(above)];
    if (const auto next = std::ranges::upper_bound(all, below); next != all.end())
      candidates.thresholds.insert(0.5 * (below + *next));
  }
  for (const double seconds : {0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5})
    candidates.frames.insert(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(seconds / period))));
  return candidates;
}

// Returns the candidate with the greatest `worth` of its counts, the first of equals.
template <class Worth>
OperatingPoint most_worthy_point(std::span<const SlipSeries> series, double period, Worth&& worth) {
  const Candidates candidates = candidates_of(series, period);
  OperatingPoint best;
  std::pair<double, double> greatest{-std::numeric_limits<double>::infinity(), 0.0};
  for (const std::size_t on : candidates.frames) {
    for (const std::size_t off : candidates.frames) {
      for (const std::size_t least : {std::size_t{1}, *candidates.frames.rbegin()}) {
        for (const double threshold : candidates.thresholds) {
          const network::Alarm alarm{on, off, least};
          const AlarmCounts counts = counts_at(series, threshold, alarm);
          const std::pair<double, double> here = worth(counts);
          if (here <= greatest) continue;
          greatest = here;
          best = {threshold, alarm, counts.alarms_per_minute(period)};
        }
      }
    }
  }
  return best;
}

}  // namespace

void FrameCounts::add(bool slips, bool answer, bool begins) {
  count(frames, slips, answer);
  false_alarms += begins && !slips ? 1U : 0U;
}

double FrameCounts::alarms_per_minute(double period) const {
  const double held = static_cast<double>(samples_in(frames, PadState::non_slip)) * period;
  return held > 0.0 ? 60.0 * static_cast<double>(false_alarms) / held : std::numeric_limits<double>::quiet_NaN();
}

double AlarmCounts::score() const {
  const double false_share =
      without_slip.series == 0 ? 0.0 : share_of(without_slip.series - without_slip.silent, without_slip.series);
  return recording_score(credit / static_cast<double>(slips), false_share);
}

double AlarmCounts::specificity() const {
  double least = std::numeric_limits<double>::quiet_NaN();
  for (const Holding& one : holding) {
    if (one.series >= least_holding) least = std::fmin(least, share_of(one.silent, one.series));
  }
  return least;
}

AlarmCounts counts_at(std::span<const SlipSeries> series, double threshold, const network::Alarm& alarm) {
  AlarmCounts counts;
  for (const SlipSeries& one : series) {
    const std::size_t onset = static_cast<std::size_t>(std::ranges::find(one.truth, 1) - one.truth.begin());
    const double begin = onset == 0 || one.path.empty() ? 0.0 : one.path[onset - 1];
    const bool scored = one.dataset == 0;
    const bool credited =
        scored && onset < one.truth.size() && !one.path.empty() && one.path.back() - begin >= least_slip_distance;
    counts.slips += credited ? 1 : 0;
    network::AlarmGate gate(alarm);
    bool before = false, ever = false;
    for (std::size_t t = 0; t < one.truth.size(); ++t) {
      const bool said = gate.push(one.probability[t] >= threshold), begins = !std::exchange(before, said) && said;
      if (said && !std::exchange(ever, true) && t >= onset && credited) counts.credit += distance_credit(one.path[t] - begin);
      if (one.truth[t] == masked) continue;
      counts.add(one.truth[t] == 1, said, begins);
    }
    if (scored && !credited && !one.path.empty()) {
      ++counts.without_slip.series;
      counts.without_slip.silent += ever ? 0 : 1;
    }
    if (!one.holds) continue;
    if (counts.holding.size() <= one.dataset) counts.holding.resize(one.dataset + 1);
    ++counts.holding[one.dataset].series;
    counts.holding[one.dataset].silent += ever ? 0 : 1;
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
  point.alarms_per_minute = counts_at(series, point.threshold, point.alarm).alarms_per_minute(period);
  return point;
}

OperatingPoint best_point(std::span<const SlipSeries> series, double period, double alarms) {
  const auto [hold, slip] = sorted_by_truth(series);
  if (all_single_frames(series) || hold.empty() || slip.empty()) return most_accurate_point(series, period);
  return most_worthy_point(series, period, [&](const AlarmCounts& counts) {
    return std::pair{-std::max(counts.alarms_per_minute(period) - alarms, 0.0), balanced_slip_accuracy(counts.frames)};
  });
}

OperatingPoint best_scoring_point(std::span<const SlipSeries> series, double period, double specificity) {
  const AlarmCounts counts = counts_at(series, 0.5, {});
  if (counts.slips == 0)
    reject("no score: no validation trial of the first dataset slips by {:g} mm or more; choose by false alarms",
           1e3 * least_slip_distance);
  const auto has_hold = [](const SlipSeries& one) {
    return one.dataset == 0 && std::ranges::find(one.truth, 0) != one.truth.end();
  };
  if (std::ranges::none_of(series, has_hold))
    reject("no score: the validation trials of the first dataset slip all the time; add trials that hold");
  return most_worthy_point(series, period, [&](const AlarmCounts& at) {
    const double held = at.specificity();
    return std::pair{std::isnan(held) ? 0.0 : std::min(held - specificity, 0.0), at.score()};
  });
}

}  // namespace slipbench::train

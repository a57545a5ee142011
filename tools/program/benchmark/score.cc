#include "tools/program/benchmark/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tools/base/statistics/descriptive.h"

namespace slipbench::benchmark {
namespace {

constexpr double seconds_a_minute = 60.0;
constexpr std::size_t bootstrap_draws = 1000;
constexpr std::uint64_t bootstrap_seed = 1;

// All but the credit.
Part alarms_of(const eval::Judgement& judgement) {
  Part part;
  part.alarms = static_cast<double>(judgement.stick_alarms + judgement.air_alarms);
  part.quiet = judgement.stick_time + judgement.air_time;
  for (const PadState state : {PadState::no_contact, PadState::non_slip}) {
    const StateCounts& row = judgement.frames[static_cast<std::size_t>(state)];
    for (std::size_t seen = 0; seen < row.size(); ++seen) {
      part.still += static_cast<double>(row[seen]);
      if (seen >= static_cast<std::size_t>(PadState::incipient)) part.said += static_cast<double>(row[seen]);
    }
  }
  return part;
}

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

Part recording_part(const eval::Judgement& judgement) {
  Part part = alarms_of(judgement);
  part.credited = !std::isnan(judgement.slip_time);
  if (judgement.detection == Detection::seen) part.credit = half_delay / (half_delay + judgement.delay);
  return part;
}

Part grasp_part(const eval::Judgement& judgement, const GraspOutcome& grasp, const GraspOutcome& untightened) {
  Part part = alarms_of(judgement);
  part.credited = untightened.dropped;
  if (!part.credited) {
    const double ratio = grasp.max_grip_force / untightened.max_grip_force;
    part.needless = std::clamp((ratio - 1.0) / (worst_force_ratio - 1.0), 0.0, 1.0);
  } else if (!grasp.dropped) {
    const double ratio = grasp.max_grip_force / grasp.ideal_grip_force;
    part.credit = std::clamp((worst_force_ratio - ratio) / (worst_force_ratio - 1.0), 0.0, 1.0);
  }
  return part;
}

Score score_of(std::span<const Part> parts, const Held& held) {
  Part sum;
  double credited = 0.0;
  for (const Part& part : parts) {
    sum.credit += part.credit;
    sum.needless += part.needless;
    credited += part.credited ? 1.0 : 0.0;
    sum.alarms += part.alarms;
    sum.quiet += part.quiet;
    sum.said += part.said;
    sum.still += part.still;
  }
  Score score;
  score.credit = share(sum.credit, credited);
  score.needless = share(sum.needless, static_cast<double>(parts.size()) - credited);
  score.alarms_per_minute = seconds_a_minute * share(sum.alarms, sum.quiet);
  score.said = share(sum.said, sum.still);
  const double counts = held.track == Track::loop ? 1.0 : alarm_limit / std::max(score.alarms_per_minute, alarm_limit);
  score.value = score.credit * counts - score.said - (held.needless ? score.needless : 0.0);
  return score;
}

Interval score_interval(std::span<const Part> parts, const Held& held) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (parts.size() < eval::fewest_experiments) return {nan, nan};
  return bootstrap_intervals(parts.size(), bootstrap_draws, bootstrap_seed,
                             [&](std::span<const std::size_t> drawn) {
                               std::vector<Part> some;
                               some.reserve(drawn.size());
                               for (const std::size_t k : drawn) some.push_back(parts[k]);
                               return std::vector<double>{score_of(some, held).value};
                             })
      .front();
}

}  // namespace slipbench::benchmark

#include "tools/studies/piezo_fft_gru/piezo_alarms.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/base/statistics/descriptive.h"

namespace slipbench::reproduce {

double alarm_delay(std::span<const double> time, std::span<const std::uint8_t> called, double onset) {
  // The answer that stands at the onset is that of the last frame that is complete then.
  auto frame = static_cast<std::size_t>(std::ranges::upper_bound(time, onset) - time.begin());
  if (frame > 0 && called[frame - 1] == 1) {
    do --frame;
    while (frame > 0 && called[frame - 1] == 1);
    return time[frame] - onset;
  }
  while (frame < time.size() && called[frame] != 1) ++frame;
  return frame < time.size() ? time[frame] - onset : std::numeric_limits<double>::quiet_NaN();
}

void Alarms::add(std::span<const double> time, std::span<const std::uint8_t> called, double onset) {
  std::vector<PadState> states;
  for (const std::uint8_t one : called) states.push_back(one == 1 ? PadState::gross : PadState::non_slip);
  first.add(time, states, onset);
  if (std::isnan(onset)) return;
  const double delay = alarm_delay(time, called, onset);
  if (std::isnan(delay)) {
    ++silent;
  } else {
    near.push_back(delay);
  }
}

DelaySpread delay_spread(const std::vector<double>& times) {
  if (times.empty()) return {};
  const MeanSd mean = mean_sd(times);
  return {mean.mean, mean.sd, median(times), quantile(times, 0.1), quantile(times, 0.9), *std::ranges::max_element(times)};
}

Json json_of(const DelaySpread& spread) {
  return {{"mean_s", spread.mean}, {"sd_s", spread.sd},   {"median_s", spread.median},
          {"p10_s", spread.p10},   {"p90_s", spread.p90}, {"greatest_s", spread.greatest}};
}

std::string cell(const DelaySpread& spread) {
  if (std::isnan(spread.median)) return "-";
  return fmt::format("{:.0f} ({:.0f} to {:.0f})", 1e3 * spread.median, 1e3 * spread.p10, 1e3 * spread.p90);
}

}  // namespace slipbench::reproduce

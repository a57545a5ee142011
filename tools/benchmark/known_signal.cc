#include "tools/benchmark/known_signal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tools/statistics/descriptive.h"

namespace slipbench::benchmark {
namespace {

constexpr double most_friction = 100.0;  // greatest value that a scene may have

struct Noise {
  double correlation = 0.0;  // between consecutive samples
  double deviation = 0.0;    // of the noise that a sample adds
};

// `values`: one value of a channel in each sample. `touching`: the first sample in contact.
Noise noise_of(const std::vector<double>& values, std::size_t touching) {
  Noise noise;
  double mean = 0.0, square = 0.0, product = 0.0;
  for (std::size_t t = 0; t < touching; ++t) mean += values[t] / static_cast<double>(touching);
  for (std::size_t t = 0; t < touching; ++t) {
    square += (values[t] - mean) * (values[t] - mean);
    if (t > 0) product += (values[t] - mean) * (values[t - 1] - mean);
  }
  if (square > 0.0) noise.correlation = std::clamp(product / square, 0.0, 1.0);
  // Second differences, because the load changes the level and, slowly, its slope. Their variance
  // in noise of one pole is 2 (3 - phi)/(1 + phi) times that of what a sample adds.
  std::vector<double> second;
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t t = std::max<std::size_t>(touching, 2); t < values.size(); ++t) {
    second.push_back(values[t] - 2.0 * values[t - 1] + values[t - 2]);
    if (const double change = std::abs(values[t] - values[t - 1]); change > 0.0) step = std::min(step, change);
  }
  const double middle = median(second);
  for (double& one : second) one = std::abs(one - middle);
  constexpr double of_a_normal = 1.4826;
  const double share = std::sqrt((1.0 + noise.correlation) / (2.0 * (3.0 - noise.correlation)));
  noise.deviation = std::max(of_a_normal * share * median(second), std::isinf(step) ? 0.0 : step / std::sqrt(12.0));
  return noise;
}

}  // namespace

Scene without_slip(const Scene& scene) {
  Scene slipless = scene;
  slipless.friction.static_coefficient = slipless.friction.kinetic_coefficient = most_friction;
  return slipless;
}

eval::Replayed no_reports(const eval::Truth& truth) {
  eval::Replayed seen;
  seen.seen.assign(truth.time.size(), PadState::non_slip);
  seen.seen_since = truth.time;
  seen.stuck_fraction.assign(truth.time.size(), std::numeric_limits<double>::quiet_NaN());
  seen.probability = seen.stuck_fraction;
  return seen;
}

eval::Replayed signal_known(const TrialRecord& record, const TrialRecord& slipless, std::size_t sensor,
                            const eval::Truth& truth) {
  std::vector<std::pair<double, double>> energy;  // time [s], energy added
  for (std::size_t c = 0; c < record.sensors[sensor].channels.size(); ++c) {
    const SensorColumn &column = record.sensors[sensor].channels[c], &without = slipless.sensors[sensor].channels[c];
    const std::vector<double>& time = record.sensors[sensor].times_of(column);
    const auto contact = std::ranges::find_if(truth.state, [](PadState state) { return state != PadState::no_contact; });
    const double touch =
        contact == truth.state.end() ? truth.time.back() : truth.time[static_cast<std::size_t>(contact - truth.state.begin())];
    const auto touching = static_cast<std::size_t>(std::ranges::lower_bound(time, touch) - time.begin());
    const auto before = static_cast<std::size_t>(std::ranges::lower_bound(time, truth.first_slip) - time.begin());
    const std::size_t width = column.row_size();
    for (std::size_t k = 0; k < width; ++k) {
      std::vector<double> values(time.size()), signal(time.size());
      double earlier = 0.0;  // difference that an earlier slip has left
      bool differs = false;
      for (std::size_t t = 0; t < time.size(); ++t) {
        values[t] = static_cast<double>(without.values[t * width + k]);
        const double difference = static_cast<double>(column.values[t * width + k]) - values[t];
        if (t < before) {
          earlier = difference;
          continue;
        }
        signal[t] = difference - earlier;
        differs = differs || signal[t] != 0.0;
      }
      if (!differs) continue;
      const Noise noise = noise_of(values, touching);
      if (!(noise.deviation > 0.0)) continue;
      for (std::size_t t = 1; t < time.size(); ++t) {
        const double added = (signal[t] - noise.correlation * signal[t - 1]) / noise.deviation;
        if (std::isfinite(added) && added != 0.0) energy.emplace_back(time[t], added * added);
      }
    }
  }
  std::ranges::sort(energy);
  double sum = 0.0, from = std::numeric_limits<double>::infinity();
  for (const auto& [time, added] : energy) {
    sum += added;
    if (sum < known_signal_deviations * known_signal_deviations) continue;
    from = std::max(time, truth.first_slip);
    break;
  }
  eval::Replayed seen = no_reports(truth);
  for (std::size_t row = 0; row < truth.time.size(); ++row) {
    const bool begins = truth.time[row] >= from && (row == 0 || truth.time[row - 1] < from);
    if (begins || (truth.time[row] >= from && slips(truth.state[row]))) seen.seen[row] = PadState::gross;
  }
  return seen;
}

}  // namespace slipbench::benchmark

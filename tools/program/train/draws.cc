#include "tools/program/train/draws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "sim/core/random.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {
namespace {

// Upper ends of the bands of compression [m]; the rounding of decimal fractions must not move a sequence to the next.
constexpr std::array<double, 3> compression_bands{0.75e-3 + 1e-9, 1e-3 + 1e-9, 1.125e-3 + 1e-9};

// Octaves below this are one condition, that of a pad at rest [mm/s].
constexpr int slowest_octave = -10;

}  // namespace

std::size_t condition_of(const CommandedMotion& motion) {
  const auto band = static_cast<std::size_t>(
      std::lower_bound(compression_bands.begin(), compression_bands.end(), motion.compression) - compression_bands.begin());
  const double speed = 1e3 * std::max(std::abs(motion.speed), corner_radius * std::abs(motion.rotation));
  const int octave = speed > 0.0 ? std::max(slowest_octave, static_cast<int>(std::lround(std::log2(speed)))) : slowest_octave;
  return static_cast<std::size_t>(octave - slowest_octave) * (compression_bands.size() + 1) + band;
}

std::size_t BootstrapDraw::training_size() const { return std::accumulate(times.begin(), times.end(), std::size_t{0}); }

std::size_t BootstrapDraw::distinct() const {
  return static_cast<std::size_t>(std::count_if(times.begin(), times.end(), [](std::uint32_t n) { return n > 0; }));
}

BootstrapDraw bootstrap(std::span<const std::size_t> conditions, std::uint64_t seed, std::size_t draw) {
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t item = 0; item < conditions.size(); ++item) members[conditions[item]].push_back(item);
  BootstrapDraw result{std::vector<std::uint32_t>(conditions.size(), 0)};
  RandomStream random(seed, draw, "bootstrap");
  for (const auto& [condition, items] : members) {
    for (std::size_t i = 0; i < items.size(); ++i) ++result.times[items[random.integer(items.size())]];
  }
  return result;
}

void Delays::add(std::span<const double> time, std::span<const PadState> called, double onset) {
  ++sequences;
  const auto alarm =
      std::ranges::find_if(called, [](PadState state) { return state == PadState::incipient || state == PadState::gross; });
  TrialOutcome outcome;
  if (alarm != called.end()) {
    const double first = time[static_cast<std::size_t>(alarm - called.begin())];
    (first >= onset ? outcome.detection_time : outcome.false_alarm_time) = first;  // without an onset it is a false alarm
  }
  settle_detection(outcome, !std::isnan(onset));
  if (!std::isnan(onset)) ++slipping;
  switch (*outcome.detection) {
    case Detection::quiet: break;
    case Detection::false_alarm: ++false_alarms; break;
    case Detection::early: ++early; break;
    case Detection::seen: delay.push_back(outcome.detection_time - onset); break;
    case Detection::missed: ++missed; break;
  }
}

void Delays::add(const Delays& other) {
  delay.insert(delay.end(), other.delay.begin(), other.delay.end());
  early += other.early;
  missed += other.missed;
  false_alarms += other.false_alarms;
  slipping += other.slipping;
  sequences += other.sequences;
}

}  // namespace slipbench

#include "tools/program/samples/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "detectors/hd/words.h"
#include "sim/core/error.h"
#include "tools/base/record/layout.h"

namespace slipbench {
namespace {

// The latest rows of a column that has one at each of `times`.
template <class T>
std::vector<T> rows_at(const std::vector<T>& values, const std::vector<double>& times, const std::vector<double>& instants) {
  const std::size_t width = times.empty() ? 0 : values.size() / times.size();
  std::vector<T> taken;
  taken.reserve(instants.size() * width);
  for (const double instant : instants) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(*latest_row(times, instant) * width);
    taken.insert(taken.end(), row, row + static_cast<std::ptrdiff_t>(width));
  }
  return taken;
}

constexpr std::array rules{hd::Word<SlipRule>{"strict", SlipRule::strict}, hd::Word<SlipRule>{"micro", SlipRule::micro},
                           hd::Word<SlipRule>{"paper", SlipRule::paper},
                           hd::Word<SlipRule>{"has_slipped", SlipRule::has_slipped}};

}  // namespace

std::vector<std::string> chosen_sensors(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked) {
  reader.check_recorded(trial);
  std::vector<std::string> names = reader.sensors(trial);
  if (asked.empty()) return names;
  for (const std::string& name : asked) {
    if (std::ranges::find(names, name) == names.end()) {
      throw InputError(fmt::format("trial {}: unknown sensor '{}'{}", trial, name, allowed_names(name, names)));
    }
  }
  std::erase_if(names, [&](const std::string& name) { return std::ranges::find(asked, name) == asked.end(); });
  return names;
}

std::optional<std::size_t> latest_row(std::span<const double> times, double time) {
  const auto after = std::upper_bound(times.begin(), times.end(), time + time_rounding);
  if (after == times.begin()) return std::nullopt;
  return static_cast<std::size_t>(after - times.begin()) - 1;
}

SensorRecord at_rate(SensorRecord sensor, double rate, std::size_t trial) {
  if (rate > sensor.rate * (1.0 + time_rounding)) {
    throw InputError(fmt::format("trial {}: a rate of {} Hz repeats samples of '{}'; allowed: up to {} Hz, its own", trial, rate,
                                 sensor.name, sensor.rate));
  }
  const std::vector<double> times = sensor.time;
  double start = times.empty() ? std::numeric_limits<double>::infinity() : times.front();
  for (const SensorColumn& channel : sensor.channels) {
    if (channel.time)
      start = channel.time->empty() ? std::numeric_limits<double>::infinity() : std::max(start, channel.time->front());
  }
  std::vector<double> instants;
  if (!times.empty() && times.back() + time_rounding >= start) {
    const auto rows = static_cast<std::size_t>(std::floor((times.back() - start + time_rounding) * rate)) + 1;
    for (std::size_t row = 0; row < rows; ++row) instants.push_back(start + static_cast<double>(row) / rate);
  }
  if (instants.size() < 2) {
    throw InputError(fmt::format("trial {}: has fewer than two rows of '{}' at {} Hz; allowed: --rate with a higher rate", trial,
                                 sensor.name, rate));
  }
  for (SensorColumn& channel : sensor.channels) {
    channel.values = rows_at(channel.values, channel.time ? *channel.time : times, instants);
    channel.time.reset();
  }
  for_each_label(sensor.labels, sensor.labels.units(),
                 [&](const char*, const char*, const Extents&, auto& column) { column = rows_at(column, times, instants); });
  sensor.time = std::move(instants);
  sensor.rate = rate;
  return sensor;
}

SlipRule parse_slip_rule(const std::string& name) {
  if (const std::optional<SlipRule> rule = hd::value_of(rules, name)) return *rule;
  throw InputError(fmt::format("unknown slip rule '{}'{}", name, allowed_names(name, slip_rule_names())));
}

std::vector<std::string> slip_rule_names() { return hd::names_of(rules); }
std::string slip_rule_name(SlipRule rule) { return hd::name_of(rules, rule); }

}  // namespace slipbench

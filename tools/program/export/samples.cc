#include "tools/program/export/samples.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"

namespace slipbench {

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

}  // namespace slipbench

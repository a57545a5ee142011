#include "tools/program/import/import_format.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "sim/core/error.h"
#include "sim/core/sensor.h"
#include "tools/program/catalogue/sensor_catalogue.h"
#include "tools/program/import/source_table.h"

namespace slipbench {

std::size_t count_lines(const SourceFile& file) {
  SourceTable table(file);
  std::size_t lines = 0;
  while (table.next()) ++lines;
  return lines == 0 ? 0 : lines - 1;
}

std::size_t count_one(const SourceFile&) { return 1; }

TrialRecord make_recording(const Json& params, const std::string& object) {
  TrialRecord record;
  record.material = object;
  record.params = params.dump();
  record.outcome.max_slip_distance = std::numeric_limits<double>::quiet_NaN();
  return record;
}

bool is_plain_name(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());  // which refuses what is not UTF-8
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
  return !text.empty() && printable(text) == text;
}

SensorRecord make_imported_sensor(const std::string& name, const std::string& type, double rate, const std::string& frame,
                                  const std::vector<std::string>& channels) {
  SensorRecord record;
  record.name = name;
  record.type = type;
  record.rate = rate;
  record.frame = frame;
  record.labels.truth = false;
  const std::vector<Entry> known = pad_catalogues().sensors;
  const auto entry = std::ranges::find(known, type, &Entry::name);
  if (entry == known.end()) throw std::logic_error("no sensor is called " + type);
  const std::unique_ptr<Sensor> sensor = make_sensor({name, type, defaults_of(entry->parameters), {}}, 0, 0);
  for (const std::string& wanted : channels) {
    const auto channel = std::ranges::find(sensor->channels(), wanted, &Channel::name);
    if (channel == sensor->channels().end()) throw std::logic_error(type + " has no channel " + wanted);
    record.channels.push_back({channel->name, channel->unit, channel->shape, {}});
    record.channel_names.insert(record.channel_names.end(), channel->channel_names.begin(), channel->channel_names.end());
  }
  return record;
}

PadState state_of_units(std::size_t touching, std::size_t slipping) {
  if (touching == 0) return PadState::no_contact;
  if (slipping == 0) return PadState::non_slip;
  return slipping < touching ? PadState::incipient : PadState::gross;
}

double rate_of(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t row = 1; row < times.size(); ++row) steps.push_back(times[row] - times[row - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double microseconds = std::round(1e6 * *middle);
  return microseconds > 0.0 ? 1e6 / microseconds : 1.0 / *middle;
}

}  // namespace slipbench

#include "tools/program/report/report_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sim/core/contact_frame.h"
#include "sim/core/error.h"

namespace slipbench::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double earliest(const std::vector<double>& times) {
  double first = nan;
  for (const double time : times) first = std::fmin(first, time);
  return first;
}

Json shares(const std::vector<std::uint8_t>& states) {
  std::array<std::size_t, 4> count{};
  for (const std::uint8_t state : states) ++count.at(state);
  Json result = Json::array();
  for (const std::size_t n : count) result.push_back(static_cast<double>(n) / static_cast<double>(states.size()));
  return result;
}

// When gross slip begins: the last slip event in the step that ends at the first gross sample, else that sample's time.
double gross_start(const SensorRecord& sensor) {
  const LabelRecord& labels = sensor.labels;
  const auto found = std::find(labels.state.begin(), labels.state.end(), static_cast<std::uint8_t>(PadState::gross));
  if (found == labels.state.end()) return nan;
  const auto row = static_cast<std::size_t>(found - labels.state.begin());
  const double end = sensor.time[row];
  const double begin = row == 0 ? end : sensor.time[row - 1];
  double start = nan;
  for (std::size_t i = 0; i < labels.event_time.size(); ++i) {
    const double time = labels.event_time[i];
    if (labels.event_kind[i] == static_cast<std::uint8_t>(EventKind::slip) && time > begin && time <= end) {
      start = std::fmax(start, time);
    }
  }
  return std::isnan(start) ? end : start;
}

double disagreement(const std::vector<std::uint8_t>& truth, const std::vector<std::uint8_t>& other) {
  std::size_t in_contact = 0, different = 0;
  for (std::size_t row = 0; row < truth.size(); ++row) {
    if (truth[row] == 0 && other[row] == 0) continue;
    ++in_contact;
    if (truth[row] != other[row]) ++different;
  }
  return in_contact == 0 ? nan : static_cast<double>(different) / static_cast<double>(in_contact);
}

}  // namespace

Json numbers_or_null(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(or_null(value));
  return list;
}

std::vector<double> touch_times(const LabelRecord& labels) {
  std::vector<double> times(labels.units(), nan);
  for (std::size_t i = 0; i < labels.event_time.size(); ++i) {
    if (labels.event_kind[i] != static_cast<std::uint8_t>(EventKind::touch)) continue;
    double& time = times.at(labels.event_unit[i]);
    time = std::fmin(time, labels.event_time[i]);
  }
  return times;
}

void check_labels(const SensorRecord& sensor, const std::string& place) {
  const LabelRecord& labels = sensor.labels;
  const std::string subject = place + ": labels/" + sensor.name;
  if (sensor.time.empty() || labels.units() == 0) throw InputError(subject + " holds no sample");
  if (!std::all_of(sensor.time.begin(), sensor.time.end(), [](double time) { return std::isfinite(time); })) {
    throw InputError(place + ": sensors/" + sensor.name + " has a time that is not finite");
  }
  for (const auto* states : {&labels.unit_state, &labels.state, &labels.state_micro, &labels.state_paper}) {
    for (const std::uint8_t state : *states) {
      if (state > 3) throw InputError(subject + " holds state " + std::to_string(state) + "; allowed: 0 to 3");
    }
  }
  for (const std::uint32_t unit : labels.event_unit) {
    if (unit >= labels.units()) {
      throw InputError(subject + " has an event of unit " + std::to_string(unit) + "; there are " +
                       std::to_string(labels.units()));
    }
  }
  for (const std::uint8_t kind : labels.event_kind) {
    if (kind > static_cast<std::uint8_t>(EventKind::part_sticks)) {
      throw InputError(subject + " has an event of kind " + std::to_string(kind) + "; allowed: 0 to 5");
    }
  }
  std::size_t values = 0;
  for (const SensorColumn& channel : sensor.channels) values += channel.row_size();
  if (sensor.channel_names.size() != values) {
    throw InputError(place + ": sensors/" + sensor.name + " names " + std::to_string(sensor.channel_names.size()) +
                     " channels; its samples hold " + std::to_string(values) + " values");
  }
}

double motion_start(const TrialRecord& trial, double from) {
  double first = nan;
  for (const BodyRecord& body : trial.bodies) {
    for (std::size_t row = 0; row < trial.body_time.size(); ++row) {
      const float* const v = &body.velocity[6 * row];
      const bool moves = std::hypot(v[0], v[1]) > at_rest || std::hypot(v[3], v[4], v[5]) > at_rest;
      if (moves && trial.body_time[row] >= from) {
        first = std::fmin(first, trial.body_time[row]);
        break;
      }
    }
  }
  return first;
}

Json summarise(const SensorRecord& sensor) {
  const LabelRecord& labels = sensor.labels;
  const double micro = earliest(labels.micro_onset_time);
  const double gross = gross_start(sensor);
  double max_slip = 0.0;
  for (const float distance : labels.slip_distance) max_slip = std::fmax(max_slip, static_cast<double>(distance));
  return {{"units", labels.units()},
          {"shares",
           {{"strict", shares(labels.state)}, {"micro", shares(labels.state_micro)}, {"paper", shares(labels.state_paper)}}},
          {"first_touch_s", or_null(earliest(touch_times(labels)))},
          {"first_micro_s", or_null(micro)},
          {"first_full_s", or_null(earliest(labels.onset_time))},
          {"gross_s", or_null(gross)},
          {"incipient_s", or_null(gross - micro)},
          {"max_slip_m", max_slip},
          {"disagreement",
           {{"paper", or_null(disagreement(labels.state, labels.state_paper))},
            {"micro", or_null(disagreement(labels.state, labels.state_micro))}}}};
}

}  // namespace slipbench::report

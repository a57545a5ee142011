#include "tools/report/report_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sim/api/contact_frame.h"
#include "sim/core/counted.h"
#include "sim/core/math.h"
#include "sim/core/quantity.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"

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

// Difference of two times [s]; 0 if it is within their rounding.
double time_between(double from, double to) {
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(from), std::abs(to));
  return std::abs(to - from) <= rounding ? 0.0 : to - from;
}

// Start of gross slip: the last slip event in the step that ends at the first gross sample, else
// that sample's time.
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
    // An event at the time of the previous sample is not yet in that sample's state.
    const bool within = time > begin || time_between(begin, time) == 0.0;
    if (labels.event_kind[i] == static_cast<std::uint8_t>(EventKind::slip) && within && time <= end) {
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

// Scene keys that are not parameters of an entry.
constexpr std::array<std::pair<std::string_view, Quantity>, 3> scene_keys = {{
    {"duration", Quantity::time},
    {"time_step", Quantity::time},
    {"label_speed", Quantity::speed},
}};

// The last part of a dotted path that is a name and not an index: "tilt" of "motion.tilt.0".
std::string_view key_of(std::string_view path) {
  while (true) {
    const std::size_t dot = path.rfind('.');
    const std::string_view last = dot == std::string_view::npos ? path : path.substr(dot + 1);
    const bool index = !last.empty() && last.find_first_not_of("0123456789") == std::string_view::npos;
    if (!index || dot == std::string_view::npos) return last;
    path = path.substr(0, dot);
  }
}

// Entries whose parameters are below the first part of a path: "motion" of "motion.speed".
const std::vector<Entry>& entries_below(std::string_view first) {
  static const Catalogues catalogues = program_catalogues();
  static const std::vector<Entry> none;
  static const std::array<std::pair<std::string_view, const std::vector<Entry>*>, 10> places{
      {{"motion", &catalogues.motions},
       {"sensors", &catalogues.sensors},
       {"surface", &catalogues.surfaces},
       {"effects", &catalogues.effects},
       {"detector", &catalogues.detectors},
       {"controller", &catalogues.controllers},
       {"box", &catalogues.grasp},
       {"grip", &catalogues.grasp},
       {"scatter", &catalogues.grasp},
       {"bodies", &catalogues.bodies}}};
  const auto found = std::ranges::find(places, first, &std::pair<std::string_view, const std::vector<Entry>*>::first);
  return found == places.end() ? none : *found->second;
}

// Quantity of the path's parameter, if all entries with a parameter of this name agree; the path
// does not state the entry.
Quantity quantity_of_path(const std::string& path) {
  const std::string_view key = key_of(path);
  // No catalogue has the parameters of a plugin's library, whatever their names.
  if (path.starts_with("detector.parameters.") || path.starts_with("controller.parameters.")) return Quantity::none;
  std::optional<Quantity> found;
  for (const Entry& entry : entries_below(std::string_view(path).substr(0, path.find('.')))) {
    for (const ParameterSpec& spec : entry.parameters) {
      if (spec.name != key) continue;
      if (found && *found != spec.quantity) return Quantity::none;
      found = spec.quantity;
    }
  }
  if (found) return *found;
  for (const auto& [known, quantity] : scene_keys) {
    if (known == key) return quantity;
  }
  return Quantity::none;
}

std::string unit_of_path(const std::string& path) { return std::string(si_symbol(quantity_of_path(path))); }

// A list such as a pivot, element by element: "(4 mm, 1 mm)".
std::string list_text(const std::string& path, const Json& list) {
  std::string text;
  for (const Json& entry : list) {
    if (!text.empty()) text += ", ";
    if (entry.is_number()) {
      text += format_quantity(entry.get<double>(), quantity_of_path(path));
    } else {
      text += entry.is_string() ? entry.get<std::string>() : entry.dump();
    }
  }
  return "(" + text + ")";
}

// Text with a unit, or a plain number, as a number in SI with its symbol; empty for a name.
std::optional<std::pair<double, std::string>> number_with_unit(const std::string& path, const std::string& text) {
  try {
    const Quantity quantity = quantity_of(text);
    return std::pair{parse_quantity(text, quantity),
                     quantity == Quantity::none ? unit_of_path(path) : std::string(si_symbol(quantity))};
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
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
  if (sensor.time.empty() || labels.units() == 0) throw InputError(subject + " contains no sample");
  if (!std::ranges::all_of(sensor.time, [](double time) { return std::isfinite(time); }))
    reject("{}: sensors/{} has a time that is not finite", place, sensor.name);
  for (const auto* states : {&labels.unit_state, &labels.state, &labels.state_micro, &labels.state_paper}) {
    for (const std::uint8_t state : *states) {
      if (state > 3) reject("{} contains state {}; allowed: 0 to 3", subject, state);
    }
  }
  for (const std::uint32_t unit : labels.event_unit) {
    if (unit >= labels.units()) reject("{} has an event of unit {}, but there are {} units", subject, unit, labels.units());
  }
  for (const std::uint8_t kind : labels.event_kind) {
    if (kind > static_cast<std::uint8_t>(EventKind::part_sticks))
      reject("{} has an event of kind {}; allowed: 0 to 5", subject, kind);
  }
  std::size_t values = 0;
  for (const SensorColumn& channel : sensor.channels) values += channel.row_size();
  if (sensor.channel_names.size() != values)
    reject("{}: sensors/{} names {}, but its samples have {}", place, sensor.name,
           counted(sensor.channel_names.size(), "channel"), counted(values, "value"));
}

double motion_start(const TrialRecord& trial, double from) {
  double first = nan;
  for (const BodyRecord& body : trial.bodies) {
    for (std::size_t row = 0; row < trial.body_time.size(); ++row) {
      const float* const v = &body.velocity[6 * row];
      const bool moves = math::hypot(v[0], v[1]) > at_rest || std::sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5]) > at_rest;
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
          {"incipient_s", or_null(time_between(micro, gross))},
          {"max_slip_m", max_slip},
          {"disagreement",
           {{"paper", or_null(disagreement(labels.state, labels.state_paper))},
            {"micro", or_null(disagreement(labels.state, labels.state_micro))}}}};
}

Json plain_value(const std::string& path, const Json& drawn) {
  if (drawn.is_number()) return {{"value", drawn.get<double>()}, {"unit", unit_of_path(path)}};
  if (drawn.is_array()) return {{"text", list_text(path, drawn)}};
  if (!drawn.is_string()) return {{"text", drawn.dump()}};
  const auto text = drawn.get<std::string>();
  if (const auto number = number_with_unit(path, text)) {
    return {{"value", std::isfinite(number->first) ? Json(number->first) : Json(nullptr)}, {"unit", number->second}};
  }
  return {{"text", text}};
}

Json axes(const std::vector<Json>& trials) {
  std::vector<std::string> paths;
  for (const Json& trial : trials) {
    for (const auto& [path, value] : trial.items()) {
      if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
    }
  }
  Json list = Json::array();
  for (const std::string& path : paths) {
    Json axis{{"path", path}, {"unit", ""}, {"numeric", true}, {"varied", false}};
    for (const Json& trial : trials) {
      const Json value = trial.value(path, Json());
      if (value != trials.front().value(path, Json())) axis["varied"] = true;
      if (value.is_null()) continue;
      if (!value.contains("value")) axis["numeric"] = false;
      if (axis["unit"].get_ref<const std::string&>().empty()) axis["unit"] = value.value("unit", "");
    }
    list.push_back(std::move(axis));
  }
  return list;
}

}  // namespace slipbench::report

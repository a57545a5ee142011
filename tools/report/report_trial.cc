#include "tools/report/report_trial.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "detectors/nib/features.h"
#include "tools/page/page.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/report/report_summary.h"

namespace slipbench::report {
namespace {

struct Curve {
  std::string key;
  std::string origin;
  std::string unit;  // SI symbol, "" for a pure number
  std::vector<std::string> components;
  bool per_unit;
  std::span<const float> values;
};

std::vector<Curve> label_curves(const LabelRecord& labels) {
  return {{"force", "labels", "N", {"FX", "FY", "FZ"}, true, labels.force},
          {"slip_velocity", "labels", "m/s", {"VX", "VY"}, true, labels.slip_velocity},
          {"slip_distance", "labels", "m", {"distance"}, true, labels.slip_distance},
          {"margin", "labels", "", {"margin"}, true, labels.margin},
          {"stuck_fraction", "labels", "", {"stuck fraction"}, false, labels.stuck_fraction},
          {"slip_direction", "labels", "rad", {"direction"}, false, labels.slip_direction},
          {"slip_angle", "labels", "rad", {"angle"}, false, labels.slip_angle},
          {"slip_centre", "labels", "m", {"x", "y"}, false, labels.slip_centre}};
}

// "P3_FX" -> "FX": name of a channel's value within its unit.
std::string component_name(const std::string& channel_name) {
  const std::size_t underscore = channel_name.find('_');
  return underscore == std::string::npos ? channel_name : channel_name.substr(underscore + 1);
}

// Stride that reduces `values` values to at most `most`.
std::size_t stride_for(std::size_t values, std::size_t most) { return values <= most ? 1 : (values + most - 1) / most; }

// True if a channel belongs to the units: its first extent is their number, or it has one value for
// each. The values of a pad with one unit belong to the sensor as a whole.
bool per_unit(const SensorColumn& channel, std::size_t units) {
  return units > 1 && !channel.time && (channel.row_size() == units || (!channel.shape.empty() && channel.shape[0] == units));
}

std::string shown_unit(const std::string& unit) { return unit == "1" ? "" : unit; }

std::vector<Curve> sensor_curves(const SensorRecord& sensor) {
  const std::size_t units = sensor.labels.units();
  std::vector<Curve> curves;
  std::size_t offset = 0;  // index of the channel's first value in channel_names
  for (const SensorColumn& channel : sensor.channels) {
    const std::size_t size = channel.row_size();
    if (per_unit(channel, units)) {
      std::vector<std::string> components;
      for (std::size_t i = 0; i < size / units; ++i) components.push_back(component_name(sensor.channel_names.at(offset + i)));
      curves.push_back({channel.name, "sensor", shown_unit(channel.unit), components, true, channel.values});
    }
    offset += size;
  }
  return curves;
}

// Channels of the sensor as a whole, or of parts that are not units.
Json whole_channels(const SensorRecord& sensor, std::size_t most_values) {
  Json channels = Json::array();
  auto name = sensor.channel_names.begin();
  for (const SensorColumn& channel : sensor.channels) {
    const std::size_t size = channel.row_size();
    const std::vector<std::string> names(name, name + static_cast<std::ptrdiff_t>(size));
    name += static_cast<std::ptrdiff_t>(size);
    if (per_unit(channel, sensor.labels.units())) continue;
    const std::size_t stride = stride_for(channel.values.size(), most_values);
    std::vector<double> kept;
    const std::vector<double>& time = sensor.times_of(channel);
    for (std::size_t row = 0; row < time.size(); row += stride) kept.push_back(time[row]);
    channels.push_back({{"key", channel.name},
                        {"unit", shown_unit(channel.unit)},
                        {"names", names},
                        {"time", page::pack_times(kept)},
                        {"data", page::pack_curves(channel.values, size, stride)}});
  }
  return channels;
}

// One value per row: the difference of a channel's first two values, or its only value.
std::vector<double> signal_of(const SensorColumn& channel) {
  const std::size_t values = channel.shape.empty() ? 1 : channel.shape.front();
  std::vector<double> signal;
  for (std::size_t i = 0; i < channel.values.size(); i += values) {
    signal.push_back(values == 1 ? channel.values[i] : double{channel.values[i]} - double{channel.values[i + 1]});
  }
  return signal;
}

Json spectrogram(const SpectrumView& view, const SensorColumn& channel, const SensorRecord& sensor, std::size_t most_values) {
  const std::vector<double> signal = signal_of(channel);
  const std::vector<double>& time = sensor.times_of(channel);
  const auto window = static_cast<std::size_t>(std::lround(view.window * sensor.rate));
  auto hop = static_cast<std::size_t>(std::lround(view.hop * sensor.rate));
  if (window < 4 || hop == 0 || signal.size() < window) return nullptr;
  nib::WindowSpectrum spectrum(window, sensor.rate);
  const auto bins = std::min(window / 2, static_cast<std::size_t>(std::floor(view.top / spectrum.bin_width() + 1e-9))) + 1;
  const std::size_t most_windows = std::max<std::size_t>(1, most_values / bins);
  hop = std::max(hop, (signal.size() - window) / most_windows + 1);
  std::vector<float> rows;
  std::vector<double> ends;
  for (std::size_t end = window; end <= signal.size(); end += hop) {
    const auto magnitudes = spectrum.magnitudes(std::span(signal).subspan(end - window, window));
    rows.insert(rows.end(), magnitudes.begin(), magnitudes.begin() + static_cast<std::ptrdiff_t>(bins));
    ends.push_back(time[end - 1]);
  }
  return {{"name", view.title},
          {"unit", channel.unit},
          {"window_s", view.window},
          {"bin_hz", spectrum.bin_width()},
          {"time", page::pack_times(ends)},
          {"data", page::pack_curves(rows, bins, 1)}};
}

}  // namespace

Json trial_payload(const SensorRecord& sensor, const ControlRecord* control, std::size_t curve_values) {
  const LabelRecord& labels = sensor.labels;
  const std::size_t units = labels.units();
  std::vector<Curve> curves = label_curves(labels);
  for (Curve& curve : sensor_curves(sensor)) curves.push_back(std::move(curve));
  std::size_t total = 0;
  for (const Curve& curve : curves) total += curve.values.size();
  const std::size_t stride = stride_for(total, curve_values);

  Json payload = {{"name", sensor.name},
                  {"type", sensor.type},
                  {"place", sensor.follows.empty() ? sensor.name : sensor.follows},
                  {"touch_s", numbers_or_null(touch_times(labels))},
                  {"micro_onset_s", numbers_or_null(labels.micro_onset_time)},
                  {"onset_s", numbers_or_null(labels.onset_time)},
                  {"time", page::pack_times(sensor.time)},
                  {"stride", stride}};
  for (std::size_t unit = 0; unit < units; ++unit) {
    payload["positions"].push_back({labels.unit_positions[2 * unit], labels.unit_positions[2 * unit + 1]});
  }
  for (const Curve& curve : curves) {
    const std::size_t columns = curve.components.size() * (curve.per_unit ? units : 1);
    payload["curves"].push_back({{"key", curve.key},
                                 {"origin", curve.origin},
                                 {"unit", curve.unit},
                                 {"components", curve.components},
                                 {"per_unit", curve.per_unit},
                                 {"data", page::pack_curves(curve.values, columns, stride)}});
  }
  payload["channels"] = whole_channels(sensor, curve_values);
  payload["spectra"] = spectra_of(sensor, curve_values);
  payload["states"] = {{"unit", page::pack_bytes(labels.unit_state, units)},
                       {"strict", page::pack_bytes(labels.state, 1)},
                       {"micro", page::pack_bytes(labels.state_micro, 1)},
                       {"paper", page::pack_bytes(labels.state_paper, 1)}};
  if (control != nullptr && control->sensor == sensor.name)
    payload["states"]["seen"] = page::pack_bytes(control->detector_class, 1);
  return payload;
}

Json view_payload(const std::string& type) {
  const SensorView view = sensor_kind(type).view;
  Json payload = {{"unit", view.unit},
                  {"units", view.units},
                  {"letter", view.letter},
                  {"first", view.first},
                  {"from_behind", view.from_behind},
                  {"orientation", view.orientation},
                  {"channels", Json::object()},
                  {"picture", nullptr}};
  for (const ChannelView& channel : view.channels) {
    payload["channels"][channel.channel] = {{"name", channel.name}, {"note", channel.note}};
  }
  if (const auto& picture = view.picture) {
    payload["picture"] = {{"channel", picture->channel},    {"cells", picture->cells}, {"width", picture->width},
                          {"rest", or_null(picture->rest)}, {"falls", picture->falls}, {"note", picture->note}};
  }
  return payload;
}

Json spectra_of(const SensorRecord& sensor, std::size_t most_values) {
  const SensorView view = sensor_kind(sensor.type).view;
  Json spectra = Json::array();
  for (const SensorColumn& channel : sensor.channels) {
    const std::optional<SpectrumView> spectrum = view.channel_view(channel.name).spectrum;
    if (!spectrum) continue;
    if (Json one = spectrogram(*spectrum, channel, sensor, most_values); !one.is_null()) spectra.push_back(std::move(one));
  }
  return spectra;
}

}  // namespace slipbench::report

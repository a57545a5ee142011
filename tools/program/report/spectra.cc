#include "tools/program/report/report_parts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "detectors/nib/stft.h"
#include "tools/base/page/pack.h"
#include "tools/program/catalogue/sensor_catalogue.h"

namespace slipbench::report {
namespace {

// One value a row: the difference of a channel's first two values, or its only one.
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
  return {{"name", view.of},
          {"unit", channel.unit},
          {"window_s", view.window},
          {"bin_hz", spectrum.bin_width()},
          {"time", page::pack_times(ends)},
          {"data", page::pack_curves(rows, bins, 1)}};
}

}  // namespace

Json spectra_of(const SensorRecord& sensor, std::size_t most_values) {
  const SensorView view = sensor_view(sensor.type);
  Json spectra = Json::array();
  for (const SensorColumn& channel : sensor.channels) {
    const std::optional<SpectrumView> spectrum = view.of(channel.name).spectrum;
    if (!spectrum) continue;
    if (Json one = spectrogram(*spectrum, channel, sensor, most_values); !one.is_null()) spectra.push_back(std::move(one));
  }
  return spectra;
}

}  // namespace slipbench::report

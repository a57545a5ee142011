#include "tools/studies/nib_reconfigurable/nib_signature.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "detectors/nib/stft.h"
#include "tools/base/statistics/descriptive.h"

namespace slipbench::reproduce {
namespace {

constexpr double slow = 8.0;                                   // Hz, the paper's effective response
constexpr double slip_begins = 0.3e-3, slip_ends = 10e-3;      // m, of the lever
constexpr std::size_t window_samples = 150, hop_samples = 30;  // samples at 300 Hz, as in the paper

// Median of `figure` over those of the slips that have waves or not; empty of none.
std::optional<double> median_of(const std::vector<std::optional<Signature>>& found, bool wavy, double Signature::*figure) {
  std::vector<double> values;
  for (const std::optional<Signature>& signature : found) {
    if (signature && signature->wavy == wavy) values.push_back(*signature.*figure);
  }
  if (values.empty()) return std::nullopt;
  return median(std::move(values));
}

}  // namespace

std::optional<Signature> signature_of(const Scene& scene, const NibTrace& trace) {
  const std::size_t begun = trace.at(scene.detector->parameters.number("start"));
  const std::optional<std::size_t> first = trace.moved(begun, slip_begins);
  if (!first) return std::nullopt;
  const std::size_t last = trace.moved(begun, slip_ends).value_or(trace.size());
  if (last - *first < window_samples) return std::nullopt;
  const std::size_t fl = trace.source().channels.front().size();  // behind the image
  nib::SlidingSpectrum spectrum(window_samples, hop_samples, trace.source().rate);
  const double bin = trace.source().rate / static_cast<double>(window_samples);
  double below = 0.0, above = 0.0, windows = 0.0;
  for (std::size_t k = *first; k < last; ++k) {
    const std::span<const float> values = trace.frame(k).values;
    if (!spectrum.push(double{values[fl]} - double{values[fl + 1]})) continue;
    windows += 1.0;
    for (std::size_t n = 1; n < spectrum.magnitudes().size(); ++n) {
      const double energy = spectrum.magnitudes()[n] * spectrum.magnitudes()[n];
      (static_cast<double>(n) * bin <= slow ? below : above) += energy;
    }
  }
  // White noise of variance v has v sum w^2 in every bin, sum w^2 = (0.54^2 + 0.46^2/2) N; of N/2 bins.
  const auto n = static_cast<double>(window_samples);
  const auto rms = [&](double energy) { return std::sqrt(2.0 * energy / (0.3974 * n * n * windows)); };
  const bool wavy = std::ranges::any_of(scene.effects, [](const Named& effect) { return effect.name == "texture"; });
  return Signature{wavy, below / (below + above), static_cast<double>(last - *first) / trace.source().rate, rms(below),
                   rms(above)};
}

ResultTable signature_table() {
  return {
      "Energy of the linear mode below 8 Hz while the pad slips",
      {"law", "plates", "slips that last", "share below 8 Hz", "below, counts rms", "above", "time of the slip, s"},
      {},
      "Medians over slips. Of C_N - C_S in windows of 0.5 s, less their line, Hamming, that lie wholly between 0.3 and 10 mm of the lever; shorter slips are left out. The converter's noise alone has a share of 0.05 and 1.7 counts above 8 Hz."};
}

void add_signatures(const char* law, const std::vector<std::optional<Signature>>& found, ResultTable& table, Json& figures) {
  for (const bool wavy : {false, true}) {
    const auto slips = std::ranges::count_if(found, [&](const auto& signature) { return signature && signature->wavy == wavy; });
    const auto text = [&](double Signature::*figure, int digits) {
      const std::optional<double> value = median_of(found, wavy, figure);
      return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
    };
    table.rows.push_back({law, wavy ? "wavy" : "flat", std::to_string(slips), text(&Signature::share, 3),
                          text(&Signature::below, 1), text(&Signature::above, 1), text(&Signature::time, 2)});
    Json row{{"law", law}, {"wavy", wavy}, {"slips", slips}};
    if (slips > 0) {
      row.update({{"share", *median_of(found, wavy, &Signature::share)},
                  {"below_counts", *median_of(found, wavy, &Signature::below)},
                  {"above_counts", *median_of(found, wavy, &Signature::above)},
                  {"time_s", *median_of(found, wavy, &Signature::time)}});
    }
    figures.push_back(std::move(row));
  }
}

}  // namespace slipbench::reproduce

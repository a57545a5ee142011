#include "detectors/detector_kinds.h"

#include <cmath>
#include <numeric>
#include <string>

#include "detectors/channel.h"
#include "detectors/spectral/spectral_features.h"
#include "sim/core/error.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace {

// Converts a length [s] to samples of `source`.
std::size_t whole_samples(double length, const std::string& key, const FrameSource& source) {
  constexpr double most = 1e6;  // samples per transform, far more than needed
  const double samples = length * source.rate;
  const double whole = std::round(samples);
  if (whole < 1.0 || whole > most || std::abs(samples - whole) > source.rate_rounding * whole) {
    throw SceneValueError("detector." + key, format_quantity(length, Quantity::time) +
                                                 " must be a whole number of sampling times of sensors." + source.sensor + " (" +
                                                 format_quantity(source.rate, Quantity::frequency) + "), 1 to 1,000,000" +
                                                 even_rates_text(length, samples));
  }
  return static_cast<std::size_t>(whole);
}

SpectralLayout layout_of(const Parameters& parameters, const FrameSource& source) {
  SpectralLayout layout{.rate = source.rate,
                        .window = whole_samples(parameters.number("window"), "window", source),
                        .hop = whole_samples(parameters.number("hop"), "hop", source),
                        .low = parameters.number("low"),
                        .high = parameters.number("high")};
  const double width = source.rate / static_cast<double>(layout.window);
  if (std::floor(std::min(layout.high, 0.5 * source.rate) / width) < std::ceil(layout.low / width)) {
    throw SceneValueError("detector.high",
                          "no bin of the spectrum lies between " + format_quantity(layout.low, Quantity::frequency) + " and " +
                              format_quantity(layout.high, Quantity::frequency) + "; the band must contain a multiple of " +
                              readable_quantity(width, Quantity::frequency) + ", below half the sensor's rate");
  }
  return layout;
}

class BandEnergy final : public Detector {
 public:
  BandEnergy(const Parameters& parameters, const FrameSource& source)
      : place_(scalar_channel(source, "signal", "band_energy")),
        features_(layout_of(parameters, source)),
        threshold_(parameters.number("threshold")),
        release_(parameters.number("release") * threshold_) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    if (!features_.push(frame.values[place_])) return estimate_;
    const auto density = features_.density();
    const double rms = std::sqrt(features_.bin_width() * std::accumulate(density.begin(), density.end(), 0.0));
    slips_ = rms >= (slips_ ? release_ : threshold_);
    estimate_.state = slips_ ? PadState::gross : PadState::non_slip;
    return estimate_;
  }

 private:
  std::size_t place_;
  SpectralFeatures features_;
  double threshold_, release_;  // in the channel's unit, rms
  bool slips_ = false;
  SlipEstimate estimate_;
};

}  // namespace

DetectorKind band_energy_detector() {
  return {
      {.name = "band_energy",
       .summary =
           "Band energy: the pad slips when its signal's power in a band of frequencies is above a threshold; no training.",
       .law = "r^2 = rate/window sum_k S_k over the bins k within [low, high]: the mean square of the signal in the band\n"
              "S: power spectral density of a window less its mean\n"
              "slip from the first window with r >= threshold until the first with r < release threshold\n"
              "gross: slip; non-slip: no slip or no contact, which a signal without a static part cannot distinguish",
       .source =
           "friction vibration of a piezoelectric skin: FFT-GRU slip detection, sections IV-A and V-B (20 ms windows every 10 ms, 50 to 600 Hz); threshold and hysteresis: assumed",
       .parameters =
           {number_spec("window", Quantity::time, "20 ms", positive, "Length of the signal for one spectrum.",
                        "FFT-GRU slip detection, section IV-A"),
            number_spec("hop", Quantity::time, "10 ms", positive, "Time from one window to the next.",
                        "FFT-GRU slip detection, section IV-A"),
            number_spec("low", Quantity::frequency, "50 Hz", non_negative, "Lower end of the band.",
                        "FFT-GRU slip detection, table II: slip begins at 50 Hz"),
            number_spec("high", Quantity::frequency, "600 Hz", positive, "Upper end of the band.",
                        "FFT-GRU slip detection, table II: the range of its other experiments"),
            number_spec(
                "threshold", Quantity::none, "40", positive,
                "Root mean square of the signal in the band above which the pad slips, in the unit of the channel.",
                "assumed: 1.65 times the typical noise of the piezo_skin in the band, 24.2 counts, whose rms varies by 14 % from window to window"),
            number_spec("release", Quantity::none, "0.7", positive_up_to(1.0), "Share of the threshold below which a slip ends.",
                        "assumed")}},
      created<BandEnergy>,
      nullptr,
      FrameSpacing::evened,
      {"FFTW"}};
}

}  // namespace slipbench

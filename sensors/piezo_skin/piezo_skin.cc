#include "sensors/piezo_skin/piezo_skin.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "sensors/electronics/band_pass.h"
#include "sensors/electronics/pad_sensor.h"
#include "sim/api/sensor.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/parameters.h"

namespace slipbench {
namespace piezo {
namespace {

// Largest radius of a contact that fits on the 20 x 10 mm patch.
constexpr double patch_half_width = 5e-3;  // m
constexpr double converter_counts = 65536.0;
// Noise of the converter and of its input. Only its ratio to the signal of slip is measured
// (README.md, section Noise).
constexpr double noise = 35e-3;  // N rms

// Samples of the sensor per sample of the bench's position sensor.
std::size_t label_stride(const Parameters& parameters, const std::string& sensor_name) {
  constexpr double rounding = 1e-9;  // relative, of a quotient of decimal numbers
  const double ratio = parameters.number("rate") / parameters.number("label_rate");
  const double whole = std::round(ratio);
  if (whole < 1.0 || std::abs(ratio - whole) > rounding * whole) {
    throw SceneValueError("sensors." + sensor_name + ".label_rate",
                          format_quantity(parameters.number("label_rate"), Quantity::frequency) + " does not divide the rate " +
                              format_quantity(parameters.number("rate"), Quantity::frequency) +
                              "; allowed: the rate divided by a whole number");
  }
  return static_cast<std::size_t>(whole);
}

// Points of equal area on the contact's disc (Vogel's spiral): r_i^2 = radius^2 (i + 1/2)/n. A tip
// of curvature 1/R leaves the gap r^2/2R; its mean, radius^2/4R, is subtracted.
PadLayout make_layout(const Parameters& parameters) {
  const auto count = static_cast<std::size_t>(parameters.integer("elements"));
  const double radius = parameters.number("radius"), curvature = 1.0 / parameters.number("tip_radius");
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  PadLayout layout;
  layout.unit_truth = UnitTruth::force;
  for (std::size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i), share = (place + 0.5) / static_cast<double>(count);
    const double r = radius * std::sqrt(share);
    Element element;
    element.tip = {r * math::cos(golden_angle * place), r * math::sin(golden_angle * place),
                   0.5 * curvature * radius * radius * (share - 0.5)};
    element.k_normal = parameters.number("k_normal") / static_cast<double>(count);
    element.k_tangential = parameters.number("k_tangential") / static_cast<double>(count);
    layout.elements.push_back(element);
  }
  layout.units.push_back({0, count});
  return layout;
}

SignalModel signal_model(double rate, double gain) {
  SignalModel model;
  model.rate = rate;
  model.sources = 1;
  model.source = {0};
  model.noise_sd = {noise * gain};
  model.offset_sd = {1.5e-3 * gain};
  model.drift_sd = {0.0};
  model.gain_sd = {0.0};
  model.converter = {{-0.5 * converter_counts, 0.5 * converter_counts - 1.0}};
  return model;
}

class PiezoSkin final : public PadSensor {
 public:
  PiezoSkin(const Parameters& parameters, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : PadSensor(parameters.number("rate"), make_layout(parameters), {{"signal", "counts", {1}, {"signal"}}}),
        gain_(parameters.number("gain")),
        shear_x_(parameters.vector("shear")[0]),
        shear_y_(parameters.vector("shear")[1]),
        label_step_(parameters.number("label_step")),
        label_stride_(static_cast<double>(label_stride(parameters, key.sensor_name))),
        amplifier_(parameters.number("corner"), parameters.number("anti_alias"), rate_,
                   std::span(memory_).first<BandPass::memory_size>()),
        electronics_(electronics, signal_model(rate_, gain_), key) {
    frame_.values = values_;
  }

  const SensorFrame& measure(const ContactFrame& truth) override {
    const double charge = truth.force(2, 0) + shear_x_ * truth.force(0, 0) + shear_y_ * truth.force(1, 0);
    values_[0] = static_cast<float>(gain_ * amplifier_.next(charge));
    electronics_.apply(values_, truth.time);
    frame_.time = truth.time;
    if (until_position() == 0.0) read_position(truth);
    until_position() -= 1.0;
    return frame_;
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override {
    std::vector<std::span<double>> memories = electronics_.memory();
    memories.insert(memories.begin(), std::span(memory_));
    return memories;
  }

  [[nodiscard]] std::uint64_t saturated() const override { return electronics_.saturated(); }

  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override {
    if (truth.state == PadState::no_contact) return PadState::no_contact;
    return memory_[moving] == 0.0 ? PadState::non_slip : PadState::gross;
  }

 private:
  // Layout of memory_ behind the amplifier's state.
  enum Place : std::size_t { until = BandPass::memory_size, known, moving, stage_x, stage_y, places };

  double& until_position() { return memory_[until]; }

  // Reads the bench's position sensor and records if its reading has changed.
  void read_position(const ContactFrame& truth) {
    const double x = truth.stage_position.x(), y = truth.stage_position.y();
    const bool moved = memory_[known] != 0.0 && math::hypot(x - memory_[stage_x], y - memory_[stage_y]) > label_step_;
    memory_[moving] = moved ? 1.0 : 0.0;
    memory_[known] = 1.0;
    memory_[stage_x] = x;
    memory_[stage_y] = y;
    until_position() = label_stride_;
  }

  double gain_, shear_x_, shear_y_;
  double label_step_, label_stride_;
  std::array<double, places> memory_{};
  BandPass amplifier_;
  Electronics electronics_;
  std::array<float, 1> values_{};
};

}  // namespace
}  // namespace piezo

namespace {

Entry piezo_skin_entry() {
  const std::string paper = "FFT-GRU slip detection paper, section II";
  return {
      .name = "piezo_skin",
      .summary = "PVDF-TrFE patch of 20 x 10 mm under a compliant layer: one signal, the charge of normal and tangential force.",
      .law =
          "charge/d33 = F_z + shear_x F_x + shear_y F_y  (direct effect, of all elements together)\n"
          "signal = gain * charge/d33 through a high-pass of first order at corner and a low-pass of first order at anti_alias\n"
          "Both filters are exact for a force that is linear between samples. Well below the corner the signal is the rate of\n"
          "stress, gain/(2 pi corner) d(charge/d33)/dt.\n"
          "contact: n springs k_normal/n, k_tangential/n on a disc; under a tip of radius R the gap is r^2/2R. The origin is at\n"
          "the springs' mean height: F_z = k_normal * compression once all touch, which needs F_z >= k_normal radius^2/4R",
      .source =
          paper +
          " (layers, size, rate); IEEE Std 176-1987 (direct effect); K. L. Johnson, Contact Mechanics (1985), sec. 4.3 (elastic foundation)",
      .parameters = {
          number_spec("rate", Quantity::frequency, "10 kHz", positive, "Sampling rate.", paper + ": 10 kHz"),
          integer_spec(
              "elements", "20", {1.0, 1000.0}, "Friction points of the contact, on Vogel's spiral, each of the same area.",
              "assumed. With 20 to 100 elements the spectrum has the same shape, but the stick-slip signal of 100 elements is a third smaller than that of 20"),
          number_spec("radius", Quantity::length, "5 mm", positive_up_to(piezo::patch_half_width),
                      "Radius of the disc that a tip can touch.", "half the patch's width of 10 mm, " + paper),
          number_spec("tip_radius", Quantity::length, "inf", positive_or_infinite, "Radius of the touching tip; inf: flat.",
                      "set for each scene"),
          number_spec("k_normal", Quantity::stiffness, "20 N/mm", positive, "Normal stiffness of the whole disc.",
                      "assumed: a layer of 2 mm and 0.5 MPa under a disc of 5 mm radius has E pi r^2/h = 19.6 N/mm"),
          number_spec("k_tangential", Quantity::stiffness, "6 N/mm", positive, "Tangential stiffness of the whole disc.",
                      "assumed: 4 to 9 N/mm were tried; G/E of the layer gives a third of the normal stiffness"),
          vector_spec(
              2, "shear", Quantity::none, "[0.35, 0.35]", any_value,
              "Charge per newton of tangential force along X and Y, relative to the charge per newton of normal force.",
              "assumed: stretch under shear (d31, d32) against thickness (d33); PVDF-TrFE is alike in X and Y. The single signal does not respond to shear at right angles to (shear_x, shear_y), by default at 135 and 315 deg"),
          number_spec("gain", Quantity::none, "2000", positive,
                      "Counts per newton of normal force, far above the corner frequency.",
                      "assumed: pressing then stays within 16 bits, whose steps are far below the noise"),
          number_spec("corner", Quantity::frequency, "3 Hz", positive, "Corner of the charge amplifier's high-pass.",
                      "assumed: nothing is published"),
          number_spec("anti_alias", Quantity::frequency, "inf", positive_or_infinite,
                      "Corner of a low-pass before the converter; inf: none.",
                      "inf: the field has no values between the samples, so nothing can alias"),
          number_spec("label_rate", Quantity::frequency, "100 Hz", positive,
                      "Rate of the bench's position sensor, from whose samples the paper derives its labels.",
                      "FFT-GRU slip detection paper, section III-A"),
          number_spec("label_step", Quantity::length, "10 um", positive,
                      "Change of the bench's position between two samples above which the paper's rule says slip.",
                      "assumed: 1 mm/s; the slowest published slide makes 33 um between two samples"),
      }};
}

std::vector<Entry> piezo_skin_electronics() {
  return electronics_of(
      "piezo_skin",
      {{"offset", "sd 3 counts: assumed", {}},
       {"noise",
        "35 mN rms, which is 70 counts: fitted to how much 129 bins of a real skin's spectrum vary over frames of slip and hold (thayral/tactile-slip-demo, by an author of the paper). Only the ratio of noise to slip is measured",
        {{"corner", "inf",
          "the mean spectrum of that skin is flat within 0.7 dB from 0.7 to 5 kHz; idle PVDF channels are nearly white, too (cosmiclab-unige)"}}},
       {"quantisation",
        "over -32768 to 32767 counts, 16 N either way: assumed; pressing does not reach the ends",
        {{"bits", "16", "assumed; 12 would add steps of a quarter of the noise"}}}});
}

}  // namespace

SensorKind piezo_skin_sensor() {
  return {.about = piezo_skin_entry(),
          .electronics = piezo_skin_electronics(),
          .create = created<piezo::PiezoSkin>,
          .view = {.unit = "patch",
                   .units = "patches",
                   .letter = "S",
                   .channels = {{.channel = "signal",
                                 .name = "Signal",
                                 .note = "charge of the patch through its amplifier: the rate of its force",
                                 .spectrum = SpectrumView{"the signal", 0.02, 0.01, 1000.0},
                                 .unit = "counts"}}}};
}

}  // namespace slipbench

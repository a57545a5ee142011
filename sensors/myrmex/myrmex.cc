#include "sensors/myrmex/myrmex.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>

#include "sensors/electronics/pad_sensor.h"
#include "sensors/myrmex/foam_cell.h"
#include "sim/api/sensor.h"
#include "sim/core/math.h"
#include "sim/core/parameters.h"
#include "sim/core/vectorise.h"

namespace slipbench {
namespace myrmex {
namespace {

PadLayout make_layout(const Parameters& parameters) {
  const auto rows = static_cast<std::size_t>(parameters.integer("rows"));
  const auto columns = static_cast<std::size_t>(parameters.integer("columns"));
  const double pitch = parameters.number("pitch");
  const double stiffness = parameters.number("modulus") * pitch * pitch / parameters.number("thickness");
  const double right = 0.5 * static_cast<double>(columns - 1), top = 0.5 * static_cast<double>(rows - 1);
  PadLayout layout;
  layout.unit_truth = UnitTruth::force;
  layout.unit_height = parameters.number("thickness");
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      layout.units.push_back({layout.elements.size(), 1});
      layout.elements.push_back(
          {.tip = {(static_cast<double>(column) - right) * pitch, (top - static_cast<double>(row)) * pitch, 0.0},
           .k_normal = stiffness,
           .k_tangential = parameters.number("shear_share") * stiffness});
    }
  }
  return layout;
}

Channel make_channel(const Parameters& parameters) {
  const auto rows = static_cast<std::size_t>(parameters.integer("rows"));
  const auto columns = static_cast<std::size_t>(parameters.integer("columns"));
  Channel channel{"taxels", "counts", {rows, columns}, {}};
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      channel.channel_names.push_back("T" + std::to_string(row) + "_" + std::to_string(column));
    }
  }
  return channel;
}

SignalModel signal_model(double rate, std::size_t taxels, double noise) {
  SignalModel model;
  model.rate = rate;
  model.sources = taxels;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) model.source.push_back(taxel);
  model.noise_sd.assign(taxels, noise * full_scale);
  model.converter.assign(taxels, {0.0, full_scale});
  return model;
}

// `force`: of the taxels [N], three components each; `play_1`, `play_2`: their plays. Most groups
// of four have no pressed taxel and get the unloaded reading.
SLIPBENCH_DISPATCHED void read_cells(const FoamCell& cell_read, std::size_t taxels, const double* force, double* play_1,
                                     double* play_2, float* values) {
  const FoamCell cell = cell_read;  // a copy, so that the compiler knows that no store changes it
  const Quad none{};
  const QuadFloat rest = __builtin_convertvector(cell.reading(none), QuadFloat);
  std::size_t taxel = 0;
  for (; taxel + quad <= taxels; taxel += quad) {
    // Every third of twelve numbers (the normal forces), each kept in its lane of its vector.
    const Quad a = vector_at<Quad>(force + 3 * taxel), b = vector_at<Quad>(force + 3 * taxel + 4),
               c = vector_at<Quad>(force + 3 * taxel + 8);
    const Quad mixed = __builtin_shufflevector(__builtin_shufflevector(c, b, 0, 5, 2, 3), a, 0, 1, 6, 3);
    if (!any(mixed > 0.0)) {
      put_vector(play_1 + taxel, none);
      put_vector(play_2 + taxel, none);
      put_vector(values + taxel, rest);
      continue;
    }
    const Quad normal = __builtin_shufflevector(mixed, mixed, 2, 1, 0, 3), pressed = normal > 0.0 ? normal : none;
    Quad p_1 = vector_at<Quad>(play_1 + taxel), p_2 = vector_at<Quad>(play_2 + taxel);
    put_vector(values + taxel, __builtin_convertvector(cell.reading(cell.felt(pressed, p_1, p_2)), QuadFloat));
    put_vector(play_1 + taxel, p_1);
    put_vector(play_2 + taxel, p_2);
  }
  for (; taxel < taxels; ++taxel) {
    const double pressed = std::max(0.0, force[3 * taxel + 2]);
    values[taxel] = static_cast<float>(cell.reading(cell.felt(pressed, play_1[taxel], play_2[taxel])));
  }
}

// Creep of the foam: under a steady load the felt force grows by a fixed share per decade of time,
// by Boltzmann's superposition
//   f_c = f + creep sum_k y_k,  dy_k/dt = (f - y_k)/tau_k,  tau_k = 10 ms, 100 ms ... 1000 s
// Each y_k is advanced exactly for a force that is constant over a sample. Under a step the sum
// grows by exp(-t/tau_last) - exp(-10 t/tau_first) from t to 10 t, which is 1 well within the range
// of tau.
constexpr std::array<double, 6> creep_times{1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3};  // s

// Like read_cells(), with creep. `share`: factor on f - y_k per sample; `slow`: y_k of each taxel
// [N].
void read_creeping_cells(const FoamCell& cell, double creep, const std::array<double, creep_times.size()>& share,
                         std::size_t taxels, const double* force, double* play_1, double* play_2, double* slow, float* values) {
  for (std::size_t taxel = 0; taxel < taxels; ++taxel, slow += creep_times.size()) {
    const double felt = cell.felt(std::max(0.0, force[3 * taxel + 2]), play_1[taxel], play_2[taxel]);
    double sum = 0.0;
    for (std::size_t k = 0; k < creep_times.size(); ++k) {
      slow[k] = felt + share[k] * (slow[k] - felt);
      sum += slow[k];
    }
    values[taxel] = static_cast<float>(cell.reading(felt + creep * sum));
  }
}

SLIPBENCH_DISPATCHED bool any_loaded_out(std::size_t taxels, const float* values) {
  unsigned out = 0;
  SLIPBENCH_VECTORISE
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) out |= values[taxel] <= 0.0F ? 1U : 0U;
  return out != 0;
}

class Myrmex final : public PadSensor {
 public:
  Myrmex(const Parameters& parameters, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : PadSensor(parameters.number("rate"), make_layout(parameters), {make_channel(parameters)}),
        cell_{parameters.number("hysteresis"), 2.0 * parameters.number("resistance") / parameters.number("reference"),
              parameters.number("contact_resistance") / parameters.number("reference")},
        electronics_(electronics, signal_model(rate_, layout_.units.size(), parameters.number("noise")), key),
        creep_(parameters.number("creep")),
        plays_(2 * layout_.units.size()),
        values_(layout_.units.size()) {
    frame_.values = values_;
    if (creep_ > 0.0) slow_.resize(creep_times.size() * layout_.units.size());
    for (std::size_t k = 0; k < creep_times.size(); ++k) creep_share_[k] = math::exp(-1.0 / (rate_ * creep_times[k]));
  }

  const SensorFrame& measure(const ContactFrame& truth) override {
    const std::size_t taxels = values_.size();
    assert(static_cast<std::size_t>(truth.force.cols()) == taxels);
    if (slow_.empty()) {
      read_cells(cell_, taxels, truth.force.data(), plays_.data(), plays_.data() + taxels, values_.data());
    } else {
      read_creeping_cells(cell_, creep_, creep_share_, taxels, truth.force.data(), plays_.data(), plays_.data() + taxels,
                          slow_.data(), values_.data());
    }
    electronics_.apply(values_, truth.time);
    if (any_loaded_out(taxels, values_.data())) ++saturated_;
    frame_.time = truth.time;
    return frame_;
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override {
    std::vector<std::span<double>> memories = electronics_.memory();
    memories.emplace_back(plays_);
    if (!slow_.empty()) memories.emplace_back(slow_);
    return memories;
  }

  // Images with a taxel at 0 or below, the loaded end of the range. The unloaded end is not
  // counted: there the converter clips half of the noise in every image.
  [[nodiscard]] std::uint64_t saturated() const override { return saturated_; }

  // The paper labels slip by a separate sensor on the object; this sensor can only tell contact.
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override {
    return truth.state == PadState::no_contact ? PadState::no_contact : PadState::non_slip;
  }

 private:
  FoamCell cell_;
  Electronics electronics_;
  std::uint64_t saturated_ = 0;
  double creep_;                                          // per decade of time
  std::array<double, creep_times.size()> creep_share_{};  // factor on f - y_k per sample
  std::vector<double> plays_;                             // p_1 of all taxels, then p_2 [N]
  std::vector<double> slow_;                              // y_k of each taxel [N]; empty: no creep
  std::vector<float> values_;
};

}  // namespace
}  // namespace myrmex

namespace {

Entry myrmex_entry() {
  const std::string paper = "Tactile Convolutional Networks paper, section 2";
  const std::string cell = "fit to a comparable piezoresistive cell, bare (TAMS-Group/tams_tactile_sensor_array_hardware)";
  return {
      .name = "myrmex",
      .summary = "Array of piezoresistive cells under conductive foam: an image of counts, 4095 at rest, less under load.",
      .law =
          "counts = 4095 (1 - reference/R),  R = 2 resistance/f + contact_resistance,  not below 0\n"
          "f: the normal force F of a taxel with the foam's memory, two plays p <- min(max(p, (1 - w) F), (1 + w) F):\n"
          "f = (F + p_1 + p_2)/3 with w = hysteresis and 2 hysteresis\n"
          "f is (1 - hysteresis) F in first loading and (1 + hysteresis) F in unloading: the counts are then lower at the same force.\n"
          "With creep f becomes f + creep sum_k y_k, dy_k/dt = (f - y_k)/tau_k, tau_k = 10 ms to 1000 s, one per decade: under a steady load\n"
          "f grows by the share creep for every tenfold time\n"
          "foam: k_n = modulus pitch^2/thickness a taxel, k_t = shear_share k_n",
      .source = cell + "; A. Visintin, Differential Models of Hysteresis (1994), ch. III (generalised play)",
      .parameters = {
          number_spec("rate", Quantity::frequency, "1 kHz", positive_up_to(1900.0), "Image rate.",
                      paper + ": logged at 1 kHz, up to 1.9 kHz"),
          integer_spec("rows", "16", {1.0, 64.0}, "Taxels along Y.", paper),
          integer_spec("columns", "16", {1.0, 64.0}, "Taxels along X.", paper),
          number_spec("pitch", Quantity::length, "5 mm", positive, "Edge of a taxel.", paper),
          number_spec(
              "modulus", Quantity::none, "20000", positive, "Elastic modulus of the foam [Pa].",
              "assumed: a soft conductive foam. The makers' own simulation (ubi-agni/mujoco_contact_surfaces) has 5e4 Pa over a slab of 40 mm, a third as stiff"),
          number_spec("thickness", Quantity::length, "5 mm", positive, "Thickness of the foam; only modulus/thickness counts.",
                      "assumed: nothing is published"),
          number_spec(
              "shear_share", Quantity::none, "0.5", positive, "Tangential stiffness of a taxel over its normal one.",
              "G/E = 1/2 of a foam that does not bulge (Poisson's ratio 0): Gibson and Ashby, Cellular Solids (1997), ch. 5"),
          number_spec("resistance", Quantity::none, "16.96", positive,
                      "Rs, product of resistance and force of one electrode's contact [kOhm N].", cell),
          number_spec("contact_resistance", Quantity::none, "0.5", non_negative,
                      "R0, resistance that remains under any force [kOhm].", cell),
          number_spec(
              "reference", Quantity::none, "6.03", positive, "Reference resistance of the divider [kOhm].",
              "fitted to that cell's counts at 0.2 to 4 N; the fit of R then agrees with these counts within 4 % of the range"),
          number_spec("hysteresis", Quantity::none, "0.03", {0.0, 0.25},
                      "Hysteresis h: share by which unloading reads more, and loading less, than the force.",
                      "that cell: unloading minus loading up to 3 to 10 % of the range; 2 h (1 - 2h)/(1 + 2h) = 5.3 %"),
          number_spec(
              "creep", Quantity::none, "0", fraction,
              "Creep: share by which the reading of a steady load grows per decade of time; 0: no creep.",
              "0: off by default. 0.1 is plausible for a foam (assumed). The sum of a held array (Weiss) grows by 0.26 to 1.6 per decade from 0.3 to 4 s, including the creep of hand and grip"),
          number_spec(
              "noise", Quantity::none, "0.0087890625", fraction, "Noise of a taxel, sd over the converter's range.",
              "9 of 1024 counts: a comparable cell at rest on a bench's 10-bit converter (TAMS-Group/tams_tactile_sensor_array_hardware). Loaded cells of an industrial array (Weiss) have 0.0007 to 0.0015"),
      }};
}

std::vector<Entry> myrmex_electronics() {
  return electronics_of(
      "myrmex",
      {{"scan",
        "taxel by taxel, row by row, in the time of the fastest image",
        {{"duration", "526 us", "1/1.9 kHz, the paper's highest rate"}}},
       {"white_noise", "the sensor's parameter noise, of every taxel its own; white: assumed, no spectrum is published", {}},
       {"quantisation", "over 0 to 4095 counts", {{"bits", "12", "the paper, section 2"}}}});
}

}  // namespace

SensorKind myrmex_sensor() {
  return {.about = myrmex_entry(),
          .electronics = myrmex_electronics(),
          .create = created<myrmex::Myrmex>,
          .view = {.unit = "taxel",
                   .units = "taxels",
                   .letter = "T",
                   .from_behind = true,
                   .orientation = "row 0 of its image at the top",
                   .channels = {{.channel = "taxels", .name = "Taxels", .unit = "counts", .image = true}},
                   .picture = PadPicture{.channel = "taxels",
                                         .width = 0.98,
                                         .rest = myrmex::full_scale,
                                         .falls = true,
                                         .note = "Square behind each taxel: decrease of its counts from rest."}}};
}

}  // namespace slipbench

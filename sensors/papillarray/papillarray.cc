#include "sensors/papillarray/papillarray.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "sensors/electronics/pad_sensor.h"
#include "sim/api/sensor.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/random.h"

namespace slipbench {
namespace papillarray {
namespace {

// Measured disturbances by axis x, y, z, at the stiffness of the profile `gripper`.
struct Figures {
  std::array<double, axes> force;         // N, or N/s
  std::array<double, axes> displacement;  // m, or m/s
};
constexpr Figures noise_figures{{1.4e-3, 2.5e-3, 5.3e-3}, {0.4e-6, 0.7e-6, 1.4e-6}};
constexpr Figures offset_figures{{5.3e-3, 9.4e-3, 20e-3}, {0.86e-6, 1.5e-6, 3.0e-6}};
constexpr Figures drift_figures{{0.24e-3, 0.43e-3, 0.91e-3}, {0.07e-6, 0.12e-6, 0.24e-6}};
constexpr std::array<double, axes> gain_figures{0.18, 0.18, 0.093};  // force only

// Range in which the maker states an accuracy; for a pulled pillar none is stated.
constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr std::array<ConverterRange, axes> valid_force{{{-4.0, 4.0}, {-4.0, 4.0}, {-unlimited, 15.0}}};               // N
constexpr std::array<ConverterRange, axes> valid_displacement{{{-1e-3, 1e-3}, {-1e-3, 1e-3}, {-unlimited, 2.5e-3}}};  // m

// One channel's couplings. `share`: what this channel carries of a coefficient. In displacement a
// coefficient of force is multiplied by k_from/k_to: F_i = k_i d_i, so that c N/N of force read
// like c k_from/k_to m/m of displacement.
void append_couplings(SignalModel& model, std::size_t first, const std::array<double, axes>& stiffness, double share,
                      const CouplingFigures& figures) {
  const auto append = [&](std::size_t pillar, std::size_t to, std::size_t from, double limit) {
    const std::size_t x = first + axes * pillar;
    model.couplings.push_back({x + to, x + from, share * limit * stiffness[from] / stiffness[to]});
  };
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    append(pillar, 0, 2, figures.normal_to_shear);
    append(pillar, 1, 2, figures.normal_to_shear);
  }
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    append(pillar, 2, 0, figures.shear_to_normal);
    append(pillar, 2, 1, figures.shear_to_normal);
    append(pillar, 0, 1, figures.shear_to_shear);
    append(pillar, 1, 0, figures.shear_to_shear);
  }
}

// Force before displacement. The coefficients of the two are independent, so each carries half of
// the variance.
void append_couplings(SignalModel& model, const PillarStiffness& stiffness, const CouplingFigures& figures) {
  const bool both = figures.carrier == CouplingCarrier::both;
  const double share = both ? std::numbers::sqrt2 / 2.0 : 1.0;
  if (both || figures.carrier == CouplingCarrier::force) append_couplings(model, 0, {1.0, 1.0, 1.0}, share, figures);
  if (both || figures.carrier == CouplingCarrier::displacement)
    append_couplings(model, channel_size, {stiffness.tangential, stiffness.tangential, stiffness.normal}, share, figures);
}

std::string recorded(const std::string& figures) {
  return figures +
         " (public gripper recordings, Contactile_Data_Viz, 2022, stiffness profile gripper; force in proportion to the stiffness otherwise, assumed since the device computes force from displacement)";
}

}  // namespace

SignalModel signal_model(const PillarStiffness& stiffness, double rate, const CouplingFigures& coupling) {
  const double tangential = stiffness.tangential / gripper_stiffness.tangential;
  const std::array<double, axes> force_factor{tangential, tangential, stiffness.normal / gripper_stiffness.normal};

  SignalModel model;
  model.rate = rate;
  model.sources = channel_size;
  const auto append = [&](const std::array<double, axes>& factor, std::array<double, axes> Figures::*channel, bool has_gain,
                          const std::array<ConverterRange, axes>& valid) {
    for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
      for (std::size_t axis = 0; axis < axes; ++axis) {
        model.source.push_back(axes * pillar + axis);
        model.noise_sd.push_back(factor[axis] * (noise_figures.*channel)[axis]);
        model.offset_sd.push_back(factor[axis] * (offset_figures.*channel)[axis]);
        model.drift_sd.push_back(factor[axis] * (drift_figures.*channel)[axis]);
        model.gain_sd.push_back(has_gain ? gain_figures[axis] : 0.0);
        model.valid.push_back(valid[axis]);
      }
    }
  };
  append(force_factor, &Figures::force, true, valid_force);
  append({1.0, 1.0, 1.0}, &Figures::displacement, false, valid_displacement);
  if (coupling.any()) append_couplings(model, stiffness, coupling);
  return model;
}

namespace {

UnitDisturbance disturbance(double k_normal, double k_tangential, double rate) {
  const SignalModel model = signal_model({k_normal, k_tangential}, rate, {});
  UnitDisturbance unit{};
  for (std::size_t axis = 0; axis < axes; ++axis) {
    unit.gain_sd[axis] = model.gain_sd[axis];
    unit.noise_sd[axis] = model.noise_sd[axis];
    unit.noise_sd[axes + axis] = model.noise_sd[channel_size + axis];
  }
  return unit;
}

constexpr const char* coupling_source =
    "force against displacement of the four undamaged loaded pillars in 1,635 public snapshots (Contactile_Data, 2022): rms over pillars, at 7.1 and 3.9 N/mm, FZ of DX and DY 2.3, FX and FY of DZ 0.6, FX of DY and FY of DX 0.5 N/mm. A uniform coefficient has its limit at sqrt(3) times its rms. The same in x and y: assumed";

std::vector<ParameterSpec> coupling_parameters() {
  return {
      number_spec("shear_to_normal", Quantity::none, "1", non_negative,
                  "Largest coefficient from FX and FY to FZ, in N of FZ for a N of shear.",
                  "sqrt(3) * 2.3/3.9 = 1.02, from 1,635 public snapshots of one device"),
      number_spec("normal_to_shear", Quantity::none, "0.15", non_negative,
                  "Largest coefficient from FZ to FX and FY, in N of shear for a N of FZ.",
                  "sqrt(3) * 0.6/7.1 = 0.15, from the same snapshots; compression in gripper recordings: up to 0.3 N/mm, 0.042"),
      number_spec("shear_to_shear", Quantity::none, "0.22", non_negative, "Largest coefficient between FX and FY.",
                  "sqrt(3) * 0.5/3.9 = 0.22, from the same snapshots"),
      choice_spec(
          "carrier", "force", {"force", "displacement", "both"},
          "Quantity that has the gain error: the reported force, the reported displacement, or each with half of the variance.",
          "open: force against displacement does not show it. force: a hypervector memory learnt on a real device is right in 87 % of the frames of undisturbed simulated displacements")};
}

}  // namespace

CouplingFigures coupling_figures(const std::vector<Named>& electronics) {
  const auto part = std::ranges::find(electronics, "coupling", &Named::name);
  if (part == electronics.end()) return {};
  const Parameters& parameters = part->parameters;
  const std::string& carrier = parameters.choice("carrier");
  return {.shear_to_normal = parameters.number("shear_to_normal"),
          .normal_to_shear = parameters.number("normal_to_shear"),
          .shear_to_shear = parameters.number("shear_to_shear"),
          .carrier = carrier == "force"          ? CouplingCarrier::force
                     : carrier == "displacement" ? CouplingCarrier::displacement
                                                 : CouplingCarrier::both};
}

std::vector<Entry> electronics_parts() {
  return electronics_of(
      "PapillArray",
      {{"low_pass",
        "data sheet of version 2.1: -3 dB at 235 Hz, \"338.8 Hz\". Two equal poles of 338.8 Hz would have -3 dB at 218 Hz; two of 365 Hz have it at 235 Hz",
        {{"corner", "235 Hz", "data sheet of version 2.1"}}},
       {"coupling", coupling_source, {}, coupling_parameters()},
       {"gain",
        recorded(
            "ratio of reported force to reported displacement over the pillars of two devices: sd 9.3 % for FZ, 18 % for FX and FY. Both include the error of the fits and real differences of stiffness. Displacement has no gain error")},
       {"offset", recorded("at the start of 45 recordings: sd FZ 20 mN, DZ 3 um; x and y assumed in proportion to their noise")},
       {"drift",
        recorded(
            "90 % of slopes within 5 s below 1.5 mN/s FZ and 0.4 um/s DZ: sd 0.91 mN/s, 0.24 um/s; x and y assumed in proportion to their noise")},
       {"noise",
        recorded(
            "unloaded pillars over 5 s, less a linear trend: sd FX 1.4, FY 2.5, FZ 5.3 mN, DX 0.4, DY 0.7, DZ 1.4 um. The sd includes the rise below 3 Hz, which has no pole of its own")},
       {"valid_range",
        "data sheets of versions 2.0 and 2.1: DX, DY within 1 mm, DZ up to 2.5 mm, FX, FY within 4 N, FZ up to 15 N. Recorded devices report larger values and do not clip"}});
}

}  // namespace papillarray

namespace papillarray {
namespace {

constexpr std::size_t centre_pillar = 4;

constexpr double pitch = 7e-3;                            // m, vendor's drawing
constexpr double pillar_height = 4.2e-3;                  // m, vendor's data sheet
constexpr std::array<int, 4> rates{100, 250, 500, 1000};  // Hz, selectable on the device

PillarStiffness stiffness_of(const Parameters& parameters) {
  PillarStiffness stiffness = parameters.choice("profile") == "hexapod" ? hexapod_stiffness : gripper_stiffness;
  if (const double normal = parameters.number("k_normal"); normal > 0.0) stiffness.normal = normal;
  if (const double tangential = parameters.number("k_tangential"); tangential > 0.0) stiffness.tangential = tangential;
  return stiffness;
}

double checked_rate(const Parameters& parameters, const std::string& sensor_name) {
  const double rate = parameters.number("rate");
  if (std::none_of(rates.begin(), rates.end(), [&](int allowed) { return rate == allowed; })) {
    std::string allowed;
    for (const int r : rates) allowed += (allowed.empty() ? "" : ", ") + std::to_string(r) + " Hz";
    throw SceneValueError("sensors." + sensor_name + ".rate",
                          format_quantity(rate, Quantity::frequency) + " is not a rate of the PapillArray; allowed: " + allowed);
  }
  return rate;
}

// One flag per pillar, raised by any axis of its force or its displacement.
SignalModel model_of(const Parameters& parameters, const std::vector<Named>& electronics, double rate) {
  SignalModel model = signal_model(stiffness_of(parameters), rate, coupling_figures(electronics));
  if (parameters.flag("range_flag")) {
    for (std::size_t v = 0; v < 2 * channel_size; ++v) model.range_flag.push_back(v % channel_size / axes);
  }
  return model;
}

// Undeformed tip of a pillar in the pad frame: three columns from +Y to -Y, each from +X to -X; the
// pillars get shorter outwards.
Eigen::Vector3d tip_of(std::size_t pillar, double edge_drop, double corner_drop) {
  const int column = static_cast<int>(pillar) / 3;
  const int row = static_cast<int>(pillar) % 3;
  const int off_centre = std::abs(column - 1) + std::abs(row - 1);
  const std::array<double, 3> drop{0.0, edge_drop, corner_drop};
  return {(1 - row) * pitch, (1 - column) * pitch, drop[static_cast<std::size_t>(off_centre)]};
}

PadLayout make_layout(const Parameters& parameters, RandomStream stream) {
  const PillarStiffness stiffness = stiffness_of(parameters);
  const auto count = static_cast<std::size_t>(parameters.integer("bristles"));
  const double spread = parameters.number("bristle_spread");
  const double stiffness_sd = parameters.number("stiffness_sd");
  const double log_variance = math::log1p(stiffness_sd * stiffness_sd);

  PadLayout layout;
  layout.unit_height = pillar_height;
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    const double scatter = math::exp(std::sqrt(log_variance) * stream.normal() - 0.5 * log_variance);
    layout.units.push_back({layout.elements.size(), count});
    for (std::size_t bristle = 0; bristle < count; ++bristle) {
      const double place = count == 1 ? 0.5 : static_cast<double>(bristle) / static_cast<double>(count - 1);
      const double weight = 2.0 - spread - 2.0 * (1.0 - spread) * place;  // from 2-w to w, mean 1
      layout.elements.push_back({.tip = tip_of(pillar, parameters.number("edge_drop"), parameters.number("corner_drop")),
                                 .k_normal = scatter * stiffness.normal / static_cast<double>(count) * weight,
                                 .k_tangential = scatter * stiffness.tangential / static_cast<double>(count)});
    }
  }
  return layout;
}

Channel make_channel(const std::string& name, const std::string& unit, char symbol) {
  Channel channel{name, unit, {pillars, axes}, {}};
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    for (const char axis : {'X', 'Y', 'Z'}) {
      channel.channel_names.push_back({'P', static_cast<char>('0' + pillar), '_', symbol, axis});
    }
  }
  return channel;
}

Channel flag_channel() {
  Channel channel{"out_of_range", "1", {pillars}, {}};
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) channel.channel_names.push_back("P" + std::to_string(pillar) + "_OUT");
  return channel;
}

class PapillArray final : public PadSensor {
 public:
  PapillArray(const Parameters& parameters, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : PadSensor(checked_rate(parameters, key.sensor_name),
                  make_layout(parameters, RandomStream(key.seed, key.device, "papillarray." + key.sensor_name + ".stiffness")),
                  {make_channel("force", "N", 'F'), make_channel("displacement", "m", 'D')}),
        electronics_(electronics, model_of(parameters, electronics, rate_), key),
        flags_(electronics_.range_flags()),
        label_speed_(parameters.number("label_speed")) {
    if (parameters.flag("range_flag")) {
      if (flags_.empty()) {
        throw SceneValueError("sensors." + key.sensor_name + ".range_flag",
                              "needs the part valid_range; add it to electronics, or use electronics: typical");
      }
      channels_.push_back(flag_channel());
    }
    frame_.values = std::span(values_).first(readings + flags_.size());
  }

  const SensorFrame& measure(const ContactFrame& truth) override {
    read(truth, values_.data());
    electronics_.apply(std::span(values_).first<readings>(), truth.time);
    if (!flags_.empty()) std::ranges::copy(flags_, values_.begin() + readings);
    frame_.time = truth.time;
    return frame_;
  }

  // A low-pass before the converter also processes the contact between samples.
  [[nodiscard]] bool feels_every_tick() const override { return electronics_.feels_every_tick(); }
  void feel(const ContactFrame& truth) override {
    std::array<float, readings> felt;
    read(truth, felt.data());
    electronics_.feel(felt, truth.time);
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override { return electronics_.memory(); }
  [[nodiscard]] std::uint64_t saturated() const override { return electronics_.saturated(); }

  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool rotating) const override {
    bool in_contact = false;
    std::size_t judged = 0;
    std::size_t slipping = 0;
    for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
      if (truth.unit_state[pillar] == UnitState::detached) continue;
      in_contact = true;
      if (rotating && pillar == centre_pillar) continue;
      ++judged;
      if (truth.slip_velocity.col(static_cast<Eigen::Index>(pillar)).matrix().norm() > label_speed_) ++slipping;
    }
    return in_contact && judged == 0 ? PadState::non_slip : pad_state(judged, slipping);
  }

 private:
  static constexpr std::size_t readings = 2 * channel_size;  // force and displacement

  static void read(const ContactFrame& truth, float* values) {
    assert(truth.force.cols() == Eigen::Index{pillars} && truth.displacement.cols() == Eigen::Index{pillars});
    // One column per pillar, so the memory order is that of the channel {9,3}.
    using Values = Eigen::Map<Eigen::Array<float, axes, pillars>>;
    using Truth = Eigen::Map<const Eigen::Array<double, axes, pillars>>;
    Values{values} = Truth(truth.force.data()).cast<float>();
    Values{values + channel_size} = Truth(truth.displacement.data()).cast<float>();
  }

  Electronics electronics_;
  std::span<const float> flags_;  // of the electronics; empty without range_flag
  std::array<float, readings + pillars> values_{};
  double label_speed_;
};

}  // namespace
}  // namespace papillarray

namespace {

Entry papillarray_entry() {
  using namespace papillarray;
  return {
      .name = "papillarray",
      .summary = "Contactile PapillArray: nine silicone pillars of three heights; it reports force and displacement of each tip.",
      .law =
          "force: of the object on the pillar's tip; displacement: deformed tip minus undeformed tip\n"
          "n bristles per pillar: k_n,j = k_n/n * w_j, w_j linear from 2-w to w (mean 1); k_t,j = k_t/n",
      .source =
          "PTS 2.0 and 2.1 data sheets; public recordings (Contactile_Data_Viz, Contactile_Data); label: HD-computing slip paper, section III-A",
      .parameters = {
          number_spec("rate", Quantity::frequency, "1 kHz", positive, "Sampling rate: 100, 250, 500 or 1000 Hz.",
                      "selectable on the device; the published sequences have 1000 Hz"),
          choice_spec("profile", "gripper", {"gripper", "hexapod"},
                      "Stiffness of a pillar. gripper: 7.1 N/mm normal, 3.9 N/mm tangential; hexapod: 1.2 and 0.65 N/mm.",
                      "gripper: fits to public gripper recordings; hexapod: inferred from statistics of the published sequences"),
          number_spec("k_normal", Quantity::stiffness, "0 N/mm", non_negative,
                      "Normal stiffness of a pillar; 0: from the profile.",
                      "0: from the profile; `slipbench calibrate` fits the value to a particular pad"),
          number_spec("k_tangential", Quantity::stiffness, "0 N/mm", non_negative,
                      "Tangential stiffness of a pillar; 0: from the profile.",
                      "0: from the profile; `slipbench calibrate` fits the value to a particular pad"),
          integer_spec("bristles", "1", {1.0, 64.0},
                       "Friction points per pillar. With several, a pillar slips partially before it slips as a whole.",
                       "1: Coulomb's law for the whole pillar; 6 resembles published sequences"),
          number_spec(
              "bristle_spread", Quantity::none, "0.4", positive_up_to(1.0),
              "Load w of the least loaded bristle over the mean load. The most loaded bristle carries 2-w; 1: all loads are equal.",
              "assumed: resembles the statistics of published sequences"),
          number_spec("edge_drop", Quantity::length, "0.20 mm", {0.0, pillar_height},
                      "Height by which the four edge pillars are shorter than the centre pillar.",
                      "plane fits to public gripper recordings, 0.163 to 0.196 mm; the vendor's drawing scaled, 0.22 mm"),
          number_spec("corner_drop", Quantity::length, "0.45 mm", {0.0, pillar_height},
                      "Height by which the four corner pillars are shorter than the centre pillar.",
                      "plane fits to public gripper recordings, 0.29 to 0.45 mm; the vendor's drawing scaled, 0.52 mm"),
          number_spec(
              "stiffness_sd", Quantity::none, "0", {0.0, 1.0},
              "Relative standard deviation of the pillars' stiffness, lognormal with mean 1, normal and tangential alike.",
              "0: none. The ratio of reported normal force to displacement scatters by 9.3 %, which the part `gain` of the electronics models: use only one of the two"),
          choice_spec(
              "device", "fixed", {"fixed", "redrawn"},
              "fixed: all trials of a dataset use one device; redrawn: each trial draws its own stiffness scatter, gains and coupling.",
              "fixed: the published sequences were recorded with one device"),
          number_spec("label_speed", Quantity::speed, "0.1 mm/s", non_negative,
                      "Tip speed above which the paper's labelling rule says that a pillar slips.",
                      "assumed: the paper does not print its threshold"),
          flag_spec(
              "range_flag", "false",
              "Adds a channel out_of_range: 1 for a pillar with a reading beyond the range of the part valid_range, else 0.",
              "set for each scene; the range is that of the data sheets"),
      }};
}

}  // namespace

SensorKind papillarray_sensor() {
  return {
      .about = papillarray_entry(),
      .electronics = papillarray::electronics_parts(),
      .create = created<papillarray::PapillArray>,
      .view = {.unit = "pillar",
               .units = "pillars",
               .letter = "P",
               .channels = {{"force", "Force"}, {"displacement", "Displacement"}, {"out_of_range", "Out of the valid range"}}},
      .disturbance = papillarray::disturbance};
}

}  // namespace slipbench

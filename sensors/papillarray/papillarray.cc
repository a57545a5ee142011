#include "sensors/papillarray/papillarray.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "sensors/papillarray/signal_model.h"
#include "sim/core/error.h"
#include "sim/core/random.h"
#include "sim/core/sensor.h"

namespace slipbench {
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

// Undeformed tip of a pillar in the pad frame: three columns from +Y to -Y, each from +X to -X; the pillars get shorter outwards.
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
  const double log_variance = std::log1p(stiffness_sd * stiffness_sd);

  PadLayout layout;
  layout.unit_height = pillar_height;
  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    const double scatter = std::exp(std::sqrt(log_variance) * stream.normal() - 0.5 * log_variance);
    layout.units.push_back({layout.elements.size(), count});
    for (std::size_t bristle = 0; bristle < count; ++bristle) {
      const double place = count == 1 ? 0.5 : static_cast<double>(bristle) / static_cast<double>(count - 1);
      const double weight = 2.0 - spread - 2.0 * (1.0 - spread) * place;  // from 2-w to w, mean 1
      Element element;
      element.tip = tip_of(pillar, parameters.number("edge_drop"), parameters.number("corner_drop"));
      element.k_normal = scatter * stiffness.normal / static_cast<double>(count) * weight;
      element.k_tangential = scatter * stiffness.tangential / static_cast<double>(count);
      layout.elements.push_back(element);
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

class PapillArray final : public Sensor {
 public:
  PapillArray(const Parameters& parameters, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : rate_(checked_rate(parameters, key.sensor_name)),
        label_speed_(parameters.number("label_speed")),
        layout_(make_layout(parameters, RandomStream(key.seed, key.device, "papillarray." + key.sensor_name + ".stiffness"))),
        channels_{make_channel("force", "N", 'F'), make_channel("displacement", "m", 'D')},
        electronics_(electronics, signal_model(stiffness_of(parameters), rate_), key) {
    frame_.values = values_;
  }

  PapillArray(const PapillArray&) = delete;  // the frame points into the object
  PapillArray& operator=(const PapillArray&) = delete;

  [[nodiscard]] const PadLayout& layout() const override { return layout_; }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return channels_; }

  const SensorFrame& measure(const ContactFrame& truth) override {
    assert(truth.force.cols() == Eigen::Index{pillars} && truth.displacement.cols() == Eigen::Index{pillars});
    // One column a pillar, so the memory order is that of the channel's {9,3}.
    using Values = Eigen::Map<Eigen::Array<float, axes, pillars>>;
    using Truth = Eigen::Map<const Eigen::Array<double, axes, pillars>>;
    Values(values_.data()) = Truth(truth.force.data()).cast<float>();
    Values(values_.data() + channel_size) = Truth(truth.displacement.data()).cast<float>();
    electronics_.apply(values_, truth.time);
    frame_.time = truth.time;
    return frame_;
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override { return electronics_.memory(); }

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
    if (!in_contact) return PadState::no_contact;
    if (slipping == 0) return PadState::non_slip;
    return slipping == judged ? PadState::gross : PadState::incipient;
  }

 private:
  double rate_;
  double label_speed_;
  PadLayout layout_;
  std::vector<Channel> channels_;
  Electronics electronics_;
  std::array<float, 2 * channel_size> values_{};
  SensorFrame frame_;
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
          "n bristles a pillar: k_n,j = k_n/n * w_j, w_j linear from 2-w to w (mean 1); k_t,j = k_t/n",
      .source =
          "PTS 2.0 and 2.1 data sheets; public recordings (Contactile_Data_Viz, Contactile_Data); label: HD-computing slip paper, section III-A",
      .parameters = {
          number_spec("rate", Quantity::frequency, "1 kHz", positive, "Samples a second: 100, 250, 500 or 1000 Hz.",
                      "selectable on the device; the published sequences have 1000 Hz"),
          choice_spec("profile", "gripper", {"gripper", "hexapod"},
                      "Stiffness of a pillar. gripper: 7.1 N/mm normal, 3.9 N/mm tangential; hexapod: 1.2 and 0.65 N/mm.",
                      "gripper: fits to public gripper recordings; hexapod: inferred from statistics of the published sequences"),
          number_spec("k_normal", Quantity::stiffness, "0 N/mm", non_negative, "Normal stiffness of a pillar; 0: the profile's.",
                      "a pad of one's own, as `slipbench calibrate` finds it"),
          number_spec("k_tangential", Quantity::stiffness, "0 N/mm", non_negative,
                      "Tangential stiffness of a pillar; 0: the profile's.",
                      "a pad of one's own, as `slipbench calibrate` finds it"),
          integer_spec("bristles", "1", {1.0, 64.0},
                       "Friction points a pillar. A pillar with several slips in parts before it slips as a whole.",
                       "1: Coulomb's law for the whole pillar; 6 resembles published sequences"),
          number_spec(
              "bristle_spread", Quantity::none, "0.4", positive_up_to(1.0),
              "Load share w of the least loaded bristle over the mean share. The most loaded bristle has 2-w; 1: all are equal.",
              "assumed: resembles the statistics of published sequences"),
          number_spec("edge_drop", Quantity::length, "0.20 mm", {0.0, pillar_height},
                      "How much shorter the four edge pillars are than the centre pillar.",
                      "plane fits to public gripper recordings, 0.163 to 0.196 mm; the vendor's drawing scaled, 0.22 mm"),
          number_spec("corner_drop", Quantity::length, "0.45 mm", {0.0, pillar_height},
                      "How much shorter the four corner pillars are than the centre pillar.",
                      "plane fits to public gripper recordings, 0.29 to 0.45 mm; the vendor's drawing scaled, 0.52 mm"),
          number_spec(
              "stiffness_sd", Quantity::none, "0", {0.0, 1.0},
              "Scatter of the pillars' stiffness, relative, lognormal with mean 1, normal and tangential alike.",
              "0: none. The ratio of reported normal force to displacement scatters by 9.3 %, which part `gain` of the electronics stands for: use one of the two"),
          choice_spec(
              "device", "fixed", {"fixed", "redrawn"},
              "Whether all trials of a dataset use one device, or each draws its own stiffness scatter, gains and coupling.",
              "fixed: the published sequences were recorded with one device"),
          number_spec("label_speed", Quantity::speed, "0.1 mm/s", non_negative,
                      "Tip speed above which the paper's labelling rule says that a pillar slips.",
                      "assumed: the paper does not print its threshold"),
      }};
}

std::unique_ptr<Sensor> make_papillarray(const Parameters& parameters, const std::vector<Named>& electronics, std::uint64_t seed,
                                         std::uint64_t trial, const std::string& sensor_name) {
  const std::uint64_t device = parameters.choice("device") == "fixed" ? 0 : trial;
  return std::make_unique<papillarray::PapillArray>(parameters, electronics, ElectronicsKey{seed, trial, device, sensor_name});
}

}  // namespace

SensorKind papillarray_sensor() {
  return {.about = papillarray_entry(),
          .electronics = papillarray::electronics_parts(),
          .create = make_papillarray,
          .view = {.unit = "pillar",
                   .units = "pillars",
                   .letter = "P",
                   .channels = {{"force", "Force"}, {"displacement", "Displacement"}}}};
}

}  // namespace slipbench

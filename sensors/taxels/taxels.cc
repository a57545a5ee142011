#include "sensors/taxels/taxels.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/core/sensor.h"

namespace slipbench {
namespace {

constexpr Eigen::Index axes = 3;

// Rows from +Y to -Y, each from -X to +X, one element and one unit a taxel.
PadLayout grid_of(const Parameters& p) {
  const auto rows = static_cast<std::size_t>(p.integer("rows")), columns = static_cast<std::size_t>(p.integer("columns"));
  const double pitch = p.number("pitch");
  const double right = 0.5 * static_cast<double>(columns - 1), top = 0.5 * static_cast<double>(rows - 1);
  PadLayout layout;
  layout.element_truth = true;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      Element element;
      element.tip = {(static_cast<double>(column) - right) * pitch, (top - static_cast<double>(row)) * pitch, 0.0};
      element.k_normal = p.number("k_normal");
      element.k_tangential = p.number("k_tangential");
      layout.units.push_back({layout.elements.size(), 1});
      layout.elements.push_back(element);
    }
  }
  return layout;
}

Channel channel_of(const std::string& name, const std::string& unit, char symbol, std::size_t taxels) {
  Channel channel{name, unit, {taxels, std::size_t{axes}}, {}};
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    for (const char axis : {'X', 'Y', 'Z'}) channel.channel_names.push_back("T" + std::to_string(taxel) + "_" + symbol + axis);
  }
  return channel;
}

class Taxels final : public Sensor {
 public:
  explicit Taxels(const Parameters& p)
      : rate_(p.number("rate")),
        layout_(grid_of(p)),
        channels_{channel_of("force", "N", 'F', layout_.units.size()),
                  channel_of("displacement", "m", 'D', layout_.units.size())},
        values_(2 * static_cast<std::size_t>(axes) * layout_.units.size()) {
    frame_.values = values_;
  }

  Taxels(const Taxels&) = delete;  // the frame points into the object
  Taxels& operator=(const Taxels&) = delete;

  [[nodiscard]] const PadLayout& layout() const override { return layout_; }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return channels_; }

  const SensorFrame& measure(const ContactFrame& truth) override {
    const Eigen::Index taxels = truth.force.cols();
    using Values = Eigen::Map<Eigen::Array3Xf>;
    Values(values_.data(), axes, taxels) = truth.force.cast<float>();
    Values moved(values_.data() + axes * taxels, axes, taxels);
    moved.topRows<2>() = truth.element_shear.leftCols<2>().transpose().cast<float>();
    moved.row(2) = (truth.element_shear.col(2) + truth.element_depth).transpose().cast<float>();
    frame_.time = truth.time;
    return frame_;
  }

  // Nobody has published a rule for it: the truth by the rule `strict`.
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override { return truth.state; }

 private:
  double rate_;
  PadLayout layout_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  SensorFrame frame_;
};

}  // namespace

SensorKind taxels_sensor() {
  const std::string yours = "assumed: a pad of one's own";
  return {
      .about =
          {"taxels",
           "A flat grid of three-axis taxels of one's own, without electronics.",
           "force: of the object on the taxel; displacement: deformed surface minus undeformed surface, of an elastic skin also where nothing touches it",
           "none: a sensor of one's own",
           {number_spec("rate", Quantity::frequency, "100 Hz", positive, "Samples a second.", yours),
            integer_spec("rows", "4", {1.0, 64.0}, "Taxels along Y.", yours),
            integer_spec("columns", "4", {1.0, 64.0}, "Taxels along X.", yours),
            number_spec("pitch", Quantity::length, "4 mm", positive, "Distance of taxels.", yours),
            number_spec("k_normal", Quantity::stiffness, "1 N/mm", positive,
                        "Normal stiffness of a taxel; the effect elastic_skin takes its place.", yours),
            number_spec("k_tangential", Quantity::stiffness, "0.5 N/mm", positive, "Tangential stiffness, alike.", yours)}},
      .electronics = {},
      .create = [](const Parameters& p, const std::vector<Named>&, std::uint64_t, std::uint64_t,
                   const std::string&) -> std::unique_ptr<Sensor> { return std::make_unique<Taxels>(p); },
      .view = {
          .unit = "taxel", .units = "taxels", .letter = "T", .channels = {{"force", "Force"}, {"displacement", "Displacement"}}}};
}

}  // namespace slipbench

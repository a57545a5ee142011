#include "sim/mujoco/pads/element_table.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/field/field.h"

namespace slipbench {
namespace {

constexpr const char* allowed_row = "[x, y, z, k_n, k_t], or [x, y, z, k_n, k_t, ax, ay, az] with the element's axis";

double number_of(const YamlNode& node, const std::string& subject, Quantity quantity) {
  if (node.kind != YamlNode::Kind::scalar) fail(node.origin, subject + " is " + described(node) + "; allowed: a number");
  try {
    const double value = parse_quantity(node.text, quantity);
    if (!std::isfinite(value)) throw std::invalid_argument("'" + node.text + "' is infinite; allowed: a finite number");
    return value;
  } catch (const std::invalid_argument& error) {
    fail(node.origin, subject + ": " + error.what());
  }
}

Element read_row(const YamlNode& row, const std::string& subject) {
  const std::size_t columns = row.kind == YamlNode::Kind::sequence ? row.children.size() : 0;
  if (columns != 5 && columns != 8) fail(row.origin, subject + " is no row; allowed: " + allowed_row);
  const auto entry = [&](std::size_t k, Quantity quantity) {
    return number_of(row.children[k], subject + ", entry " + std::to_string(k), quantity);
  };
  Element element;
  for (std::size_t k = 0; k < 3; ++k) element.tip[static_cast<Eigen::Index>(k)] = entry(k, Quantity::length);
  element.k_normal = entry(3, Quantity::stiffness);
  element.k_tangential = entry(4, Quantity::stiffness);
  if (!(element.k_normal > 0.0) || !(element.k_tangential > 0.0)) {
    fail(row.origin, subject + ": a stiffness is not positive; allowed: > 0 N/m");
  }
  if (columns == 8) {
    for (std::size_t k = 0; k < 3; ++k) element.axis[static_cast<Eigen::Index>(k)] = entry(5 + k, Quantity::none);
    if (!(element.axis.norm() > 0.0)) fail(row.origin, subject + ": the axis has no length");
    element.axis.normalize();
  }
  return element;
}

std::size_t count_of(const YamlNode& node, const std::string& subject) {
  const double count = number_of(node, subject, Quantity::none);
  if (!(count >= 1.0) || !(count <= static_cast<double>(Field::max_elements)) || count != std::floor(count)) {
    fail(node.origin,
         subject + " is '" + node.text + "'; allowed: a whole number from 1 to " + std::to_string(Field::max_elements));
  }
  return static_cast<std::size_t>(count);
}

class TableSensor final : public Sensor {
 public:
  TableSensor(const PadLayout& layout, double rate, bool of_elements)
      : layout_(layout),
        rate_(rate),
        of_elements_(of_elements),
        channels_{channel("force", "N", 'F'), channel("displacement", "m", 'D')} {
    const std::size_t elements = of_elements ? layout.elements.size() : 0;
    if (of_elements) {
      channels_.push_back({"depth", "m", {elements}, {}});
      channels_.push_back({"shear", "m", {3, elements}, {}});
    }
    values_.resize(6 * layout.units.size() + 4 * elements);
    frame_.values = values_;
  }

  TableSensor(const TableSensor&) = delete;  // the frame points into the object
  TableSensor& operator=(const TableSensor&) = delete;

  [[nodiscard]] const PadLayout& layout() const override { return layout_; }
  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return channels_; }

  const SensorFrame& measure(const ContactFrame& truth) override {
    const auto units = static_cast<Eigen::Index>(layout_.units.size());
    using Values = Eigen::Map<Eigen::Array3Xf>;
    Values(values_.data(), 3, units) = truth.force.cast<float>();
    Values(values_.data() + 3 * units, 3, units) = truth.displacement.cast<float>();
    if (of_elements_) {
      Eigen::Map<Eigen::ArrayXXf> each(values_.data() + 6 * units, truth.element_depth.size(), 4);
      each.col(0) = truth.element_depth.cast<float>();
      each.rightCols<3>() = truth.element_shear.cast<float>();
    }
    frame_.time = truth.time;
    return frame_;
  }

  // No paper has labelled such a pad: the truth by the micro rule, which is what an ideal camera would see.
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override { return truth.state_micro; }

 private:
  [[nodiscard]] Channel channel(const std::string& name, const std::string& unit, char symbol) const {
    Channel result{name, unit, {layout_.units.size(), 3}, {}};
    for (std::size_t u = 0; u < layout_.units.size(); ++u) {
      for (const char axis : {'X', 'Y', 'Z'}) result.channel_names.push_back("U" + std::to_string(u) + '_' + symbol + axis);
    }
    return result;
  }

  PadLayout layout_;
  double rate_;
  bool of_elements_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  SensorFrame frame_;
};

}  // namespace

PadLayout read_element_table(const YamlNode& rows, const YamlNode* units) {
  if (rows.kind != YamlNode::Kind::sequence) {
    fail(rows.origin, "elements is " + described(rows) + "; allowed: a sequence of " + allowed_row);
  }
  PadLayout layout;
  for (const YamlNode& row : rows.children) {
    layout.elements.push_back(read_row(row, "element " + std::to_string(layout.elements.size())));
  }
  if (layout.elements.empty() || layout.elements.size() > Field::max_elements) {
    fail(rows.origin, std::to_string(layout.elements.size()) + " elements; allowed: 1 to " + std::to_string(Field::max_elements));
  }
  std::size_t first = 0;
  if (units == nullptr) {
    for (; first < layout.elements.size(); ++first) layout.units.push_back({first, 1});
    return layout;
  }
  if (units->kind != YamlNode::Kind::sequence)
    fail(units->origin, "units is " + described(*units) + "; allowed: a sequence of counts");
  for (const YamlNode& node : units->children) {
    layout.units.push_back({first, count_of(node, "unit " + std::to_string(layout.units.size()))});
    first += layout.units.back().count;
  }
  if (first != layout.elements.size()) {
    fail(units->origin, "the units have " + std::to_string(first) + " elements; allowed: as many as there are, " +
                            std::to_string(layout.elements.size()));
  }
  return layout;
}

std::unique_ptr<Sensor> make_table_sensor(const PadLayout& layout, double rate, bool of_elements) {
  return std::make_unique<TableSensor>(layout, rate, of_elements);
}

}  // namespace slipbench

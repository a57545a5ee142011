#include "sensors/taxels/taxels.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sensors/electronics/pad_sensor.h"
#include "sim/api/sensor.h"
#include "sim/core/counted.h"
#include "sim/core/error.h"

namespace slipbench {
namespace {

constexpr std::size_t axes = 3;
constexpr std::size_t most_points = 4096;  // as many as a grid of 64 x 64
constexpr std::int64_t grid_size = 4;      // rows and columns by default
constexpr double grid_pitch = 4e-3;        // m, by default

// Quantity that a channel reads from a taxel. Its values are named T0_ (S0_ with a matrix) and
// `symbol`, then X, Y, Z if there are several.
struct Reading {
  const char *name, *unit;
  char symbol;
  std::size_t values;
};
constexpr Reading readings[] = {{"force", "N", 'F', 3}, {"displacement", "m", 'D', 3}, {"normal_force", "N", 'N', 1},
                                {"shear", "N", 'S', 2}, {"pressure", "Pa", 'P', 1},    {"signal", "", 'C', 1}};
const Reading& reading(const std::string& name) { return *std::ranges::find(readings, name, &Reading::name); }

using Rows = std::vector<std::vector<double>>;

// The columns of `places`.
enum Column : std::size_t { x, y, z, nx, ny, nz, k_normal, k_tangential };

// A scene's description of one sensor.
struct Description {
  // `sensor_path`: of the sensor in the scene. Throws SceneValueError there for conflicting values.
  Description(const Parameters& parameters, std::string sensor_path)
      : p(parameters),
        path(std::move(sensor_path)),
        points(static_cast<std::size_t>(p.integer("points") * p.integer("points"))),
        matrix(p.table("matrix").rows),
        curve(p.table("curve").rows),
        channels(p.map("channels").empty() ? ParameterMap{{"force", "force"}, {"displacement", "displacement"}}
                                           : p.map("channels")) {
    take_places();
    check_channels();
    check_signals();
  }

  [[nodiscard]] bool reads(const std::string& what) const {
    return std::ranges::find(channels, what, &ParameterMap::value_type::second) != channels.end();
  }
  [[nodiscard]] std::size_t count(const Reading& read) const {
    return read.symbol == 'C' && !matrix.empty() ? matrix.size() : places.size();
  }
  [[noreturn]] void refuse(const std::string& key, const std::string& what) const {
    throw SceneValueError(path + "." + key, what);
  }

  // Fills `places`, complete: rows from +Y to -Y, each from -X to +X, or as the scene lists them.
  void take_places() {
    const auto rows = static_cast<std::size_t>(p.integer("rows")), columns = static_cast<std::size_t>(p.integer("columns"));
    const double right = 0.5 * static_cast<double>(columns - 1), top = 0.5 * static_cast<double>(rows - 1), none = std::nan("");
    places = p.table("places").rows;
    const bool grid = p.integer("rows") != grid_size || p.integer("columns") != grid_size || p.number("pitch") != grid_pitch ||
                      p.choice("scan_order") != "rows";
    if (!places.empty() && grid)
      refuse("places", "cannot be combined with rows, columns, pitch or scan_order, which define a grid");
    for (std::size_t i = 0; p.table("places").rows.empty() && i < rows * columns; ++i) {
      const std::size_t above = i / columns, beside = i % columns;
      const auto row = static_cast<double>(above), column = static_cast<double>(beside);
      places.push_back(
          {(column - right) * p.number("pitch"), (top - row) * p.number("pitch"), none, none, none, none, none, none});
    }
    if (places.size() * points > most_points)
      refuse("points", "the pad has " + std::to_string(places.size() * points) + " friction points; allowed: up to " +
                           std::to_string(most_points));
    const double k_n = p.number("k_normal"), k_t = p.number("k_tangential");
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::vector<double>& place = places[i];
      Eigen::Map<Eigen::Vector3d> direction(&place[nx]);
      if (direction.array().isNaN().all()) direction = Element{}.axis;
      for (const auto& [column, otherwise] : {std::pair{z, 0.0}, {k_normal, k_n}, {k_tangential, k_t}}) {
        if (std::isnan(place[column])) place[column] = otherwise;
      }
      const bool stiff = place[k_normal] > 0.0 && place[k_tangential] > 0.0;
      if (!(direction.norm() > 0.0) || !stiff)
        refuse("places", "taxel " + std::to_string(i) +
                             (stiff ? " needs a direction nx, ny, nz that is not 0; give all three, or none"
                                    : " needs a stiffness above 0 N/m"));
      direction.normalize();
    }
  }

  void check_channels() const {
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
      if (channel->first == "t") refuse("channels.t", "is the name of the times in a dataset; choose another name");
      if (std::find_if(channels.begin(), channel, [&](const auto& other) { return other.second == channel->second; }) != channel)
        refuse("channels." + channel->first, channel->second + " is already read by another channel");
    }
  }

  void check_signals() const {
    if (!reads("signal") && !(matrix.empty() && curve.empty()))
      refuse(matrix.empty() ? "curve" : "matrix", "defines a signal that no channel reads; add channels: {NAME: signal}");
    if (!(p.vector("range")[0] < p.vector("range")[1])) refuse("range", "must be [lowest, highest]");
    if (!matrix.empty() && matrix.front().size() != axes * places.size())
      refuse("matrix", "has rows of " + counted(matrix.front().size(), "number") + "; expected " +
                           std::to_string(axes * places.size()) + ", the x, y and z of each taxel");
    const auto back = std::ranges::adjacent_find(curve, [](const auto& a, const auto& b) { return b[0] <= a[0]; });
    if (curve.size() == 1 || back != curve.end())
      refuse("curve",
             curve.size() == 1 ? "needs at least two points" : "does not ascend after the input " + format_number((*back)[0]));
  }

  // One unit per taxel, its friction points on a square lattice over its face.
  [[nodiscard]] PadLayout layout() const {
    PadLayout layout;
    layout.unit_height = p.number("height");
    layout.element_truth = reads("displacement");
    const auto edge = static_cast<std::size_t>(p.integer("points"));
    const double share = 1.0 / static_cast<double>(points), gap = p.number("width") / static_cast<double>(edge);
    for (const std::vector<double>& place : places) {
      Element element{.axis = {place[nx], place[ny], place[nz]},
                      .k_normal = share * place[k_normal],
                      .k_tangential = share * place[k_tangential]};
      const Eigen::Matrix3d frame = element_frame(element.axis);
      layout.units.push_back({layout.elements.size(), points});
      for (std::size_t i = 0; i < points; ++i) {
        const auto from_middle = [&](std::size_t j) {
          return (static_cast<double>(j) - 0.5 * static_cast<double>(edge - 1)) * gap;
        };
        const Eigen::Vector3d beside = frame * Eigen::Vector3d(from_middle(i % edge), from_middle(i / edge), 0.0);
        element.tip = Eigen::Vector3d(place[x], place[y], place[z]) + beside;
        layout.elements.push_back(element);
      }
    }
    return layout;
  }

  [[nodiscard]] std::vector<Channel> made_channels() const {
    std::vector<Channel> made;
    for (const auto& [name, read] : channels) {
      const Reading& what = reading(read);
      Channel channel{name, what.symbol == 'C' ? p.choice("unit") : what.unit, {count(what)}, {}};
      if (what.values > 1) channel.shape.push_back(what.values);
      const std::string letter = what.symbol == 'C' && !matrix.empty() ? "S" : "T";
      for (std::size_t i = 0; i < channel.size(); ++i) {
        std::string& value = channel.channel_names.emplace_back(letter + std::to_string(i / what.values) + "_" + what.symbol);
        if (what.values > 1) value += "XYZ"[i % what.values];
      }
      made.push_back(std::move(channel));
    }
    return made;
  }

  // Disturbances are shares of the range of a value: +-max_force for a force, and for a
  // displacement the deflection of the taxel's springs under max_force.
  [[nodiscard]] SignalModel signal_model() const {
    SignalModel model;
    model.rate = p.number("rate");
    model.sources = axes * places.size();
    for (const auto& [name, read] : channels) {
      const Reading& what = reading(read);
      for (std::size_t i = 0; i < count(what) * what.values; ++i) {
        const std::size_t taxel = i / what.values, axis = what.values == 1 ? axes - 1 : i % what.values,
                          value = model.source.size();
        double full = p.number("max_force");
        if (what.symbol == 'D') full /= places[taxel][axis == 2 ? k_normal : k_tangential];
        if (what.symbol == 'P') full /= p.number("width") * p.number("width");
        ConverterRange range{-full, full};  // a range from 0 would clip the noise without load
        if (what.symbol == 'C') {
          range = {p.vector("range")[0], p.vector("range")[1]};
          full = std::max(std::abs(range.lowest), std::abs(range.highest));
        }
        if (i >= what.values) model.couplings.push_back({value, value - what.values, p.number("coupling")});
        model.source.push_back(what.symbol == 'C' ? model.sources++ : axes * taxel + axis);
        model.noise_sd.push_back(p.number("noise") * full);
        model.offset_sd.push_back(p.number("offset") * full);
        model.drift_sd.push_back(p.number("drift") * full);
        model.gain_sd.push_back(p.number("gain"));
        model.converter.push_back(range);
        model.scan_share.push_back(scan_share(taxel, count(what)));
      }
    }
    return model;
  }

  // Time from the reading of value `i` of `count` to the end of the scan, as a share of the scan.
  [[nodiscard]] double scan_share(std::size_t i, std::size_t count) const {
    const std::string& order = p.choice("scan_order");
    const auto rows = static_cast<std::size_t>(p.integer("rows")), columns = static_cast<std::size_t>(p.integer("columns"));
    const std::size_t row = i / columns, column = i % columns;
    std::size_t turn = i;
    if (count == rows * columns && order == "columns") turn = column * rows + row;
    if (count == rows * columns && order == "zigzag" && row % 2 == 1) turn = row * columns + (columns - 1 - column);
    return static_cast<double>(count - 1 - turn) / static_cast<double>(count);
  }

  const Parameters& p;
  std::string path;
  std::size_t points;  // friction points per taxel
  const Rows &matrix, &curve;
  ParameterMap channels;
  Rows places = {};
};

class Taxels final : public PadSensor {
 public:
  Taxels(const Parameters& parameters, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : Taxels(Description(parameters, "sensors." + key.sensor_name), electronics, key) {}

  const SensorFrame& measure(const ContactFrame& truth) override {
    if (turned_) {
      for (Eigen::Index i = 0; i < own_.cols(); ++i)
        own_.col(i) = turns_[static_cast<std::size_t>(i)] * truth.force.col(i).matrix();
    }
    float* at = values_.data();
    for (const Reading* read : reads_) at = read_channel(*read, truth, at);
    electronics_.apply(values_, truth.time);
    frame_.time = truth.time;
    return frame_;
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override { return electronics_.memory(); }
  [[nodiscard]] std::uint64_t saturated() const override { return electronics_.saturated(); }

  // Returns the truth by the rule `strict`, as no rule is published for this sensor.
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override { return truth.state; }

 private:
  Taxels(const Description& description, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : PadSensor(description.p.number("rate"), description.layout(), description.made_channels()),
        area_(description.p.number("width") * description.p.number("width")),
        curve_(description.curve),
        electronics_(electronics, description.signal_model(), key),
        own_(Eigen::Array3Xd::Zero(axes, static_cast<Eigen::Index>(description.places.size()))),
        matrix_(static_cast<Eigen::Index>(description.matrix.size()), static_cast<Eigen::Index>(axes) * own_.cols()) {
    std::size_t count = 0;
    for (const Channel& channel : channels_) count += channel.size();
    values_.resize(count);
    frame_.values = values_;
    for (const auto& [name, read] : description.channels) reads_.push_back(&reading(read));
    turned_ = std::ranges::any_of(reads_, [](const Reading* read) { return read->symbol != 'F' && read->symbol != 'D'; });
    for (const UnitRange& unit : layout_.units) turns_.push_back(element_frame(layout_.elements[unit.first].axis).transpose());
    for (Eigen::Index row = 0; row < matrix_.rows(); ++row)
      matrix_.row(row) =
          Eigen::Map<const Eigen::RowVectorXd>(description.matrix[static_cast<std::size_t>(row)].data(), matrix_.cols());
    signal_.setZero(matrix_.rows() == 0 ? own_.cols() : matrix_.rows());
  }

  // Writes the channel's values at `at`; returns the end of what it wrote.
  float* read_channel(const Reading& read, const ContactFrame& truth, float* at) {
    const auto put = [&](const auto& values) {
      Eigen::Map<Eigen::ArrayXXf>(at, values.rows(), values.cols()) = values.template cast<float>();
      return at + values.size();
    };
    switch (read.symbol) {
      case 'F': return put(truth.force);
      case 'N': return put(own_.row(2));
      case 'S': return put(own_.topRows<2>());
      case 'P': return put(own_.row(2) / area_);
      case 'C': return put(signal(truth));
      default: break;
    }
    for (const UnitRange& unit : layout_.units) {
      const auto first = static_cast<Eigen::Index>(unit.first), points = static_cast<Eigen::Index>(unit.count);
      const Eigen::Array3d shear = truth.element_shear.middleRows(first, points).colwise().mean();
      at = put(
          Eigen::Array3d(shear - truth.element_depth.segment(first, points).mean() * layout_.elements[unit.first].axis.array()));
    }
    return at;
  }

  const Eigen::ArrayXd& signal(const ContactFrame& truth) {
    if (matrix_.rows() == 0) {
      signal_ = own_.row(2);
    } else {
      signal_.matrix().noalias() = matrix_ * Eigen::Map<const Eigen::VectorXd>(truth.force.data(), truth.force.size());
    }
    for (double& value : signal_) {
      if (curve_.empty()) break;
      const auto to = std::find_if(curve_.begin() + 1, curve_.end() - 1, [&](const auto& point) { return value < point[0]; });
      const std::vector<double>& from = to[-1];
      value = from[1] + (value - from[0]) * ((*to)[1] - from[1]) / ((*to)[0] - from[0]);
    }
    return signal_;
  }

  double area_;  // m2
  Rows curve_;   // points of input and output; empty: no curve
  Electronics electronics_;
  std::vector<float> values_;
  std::vector<const Reading*> reads_;
  bool turned_ = false;                 // a channel reads forces in the taxels' own frames
  std::vector<Eigen::Matrix3d> turns_;  // from P into each taxel's own frame
  Eigen::Array3Xd own_;                 // N, force in the taxels' own frames
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> matrix_;  // of the signals; no rows: no matrix
  Eigen::ArrayXd signal_;
};

const char* const yours = "assumed: a custom pad";

ParameterSpec figure(std::string name, std::string share, std::string doc) {
  return number_spec(std::move(name), Quantity::none, std::move(share), fraction, std::move(doc), yours);
}

std::vector<ParameterSpec> parameters() {
  using enum Quantity;
  std::vector<std::string> names;
  for (const Reading& read : readings) names.emplace_back(read.name);
  const std::vector<TableColumn> columns{{"x", length}, {"y", length}, {"z", length},           {"nx"},
                                         {"ny"},        {"nz"},        {"k_normal", stiffness}, {"k_tangential", stiffness}};
  return {
      number_spec("rate", frequency, "100 Hz", positive, "Sampling rate.", yours),
      integer_spec("rows", "4", {1.0, 64.0}, "Taxels along Y.", yours),
      integer_spec("columns", "4", {1.0, 64.0}, "Taxels along X.", yours),
      number_spec("pitch", length, "4 mm", positive, "Distance between neighbouring taxels.", yours),
      table_spec(2, "places", columns, "Position of each taxel, its direction (default: 0, 0, -1) and its own stiffness.", yours),
      number_spec("k_normal", stiffness, "1 N/mm", positive, "Normal stiffness of a taxel; elastic_skin replaces it.", yours),
      number_spec("k_tangential", stiffness, "0.5 N/mm", positive, "Tangential stiffness of a taxel; elastic_skin replaces it.",
                  yours),
      number_spec("width", length, "4 mm", positive, "Edge of a taxel's square face; a pressure is a force divided by its area.",
                  yours),
      integer_spec("points", "1", {1.0, 16.0}, "Friction points along each edge of a taxel, so that it can slip partially.",
                   yours),
      number_spec("height", length, "inf", positive, "Height of a taxel, which limits its compression.", yours),
      map_spec("channels", "Quantity of each channel by name. none: channels force and displacement.", yours, names),
      table_spec(1, "matrix", {},
                 "Weights of x, y and z of each taxel's force, one row per signal. none: the normal force of each taxel.", yours),
      table_spec(2, "curve", {{"input"}, {"output"}},
                 "Points of the characteristic of each signal, extrapolated linearly beyond the ends.", yours),
      choice_spec("unit", "counts", {"counts", "V", "mV", "N", "Pa", "kPa", "uT", "pF", "ohm"}, "Unit of the signals.", yours),
      vector_spec(2, "range", none, "[0, 4095]", any_value, "Range of the converter of a signal.", yours),
      number_spec("max_force", force, "10 N", positive,
                  "Range of the converter of forces; that of displacements follows from the stiffness.", yours),
      choice_spec("scan_order", "rows", {"rows", "columns", "zigzag"}, "Order in which the electronics part scan reads a grid.",
                  yours),
      figure("noise", "0.001", "Standard deviation of the part white_noise, as a share of the larger end of the range."),
      figure("offset", "0.002", "Standard deviation of the part offset, as a share of the larger end of the range."),
      figure("drift", "0.0001",
             "Standard deviation of the slope of the part drift, as a share of the larger end of the range [1/s]."),
      figure("gain", "0.02", "Standard deviation of the gain of the part gain."),
      figure("coupling", "0.005", "Largest share of the previous taxel or signal that the part coupling adds."),
  };
}

}  // namespace

SensorKind taxels_sensor() {
  std::vector<PartFigures> parts{{"scan", "taxel by taxel in scan_order, signals of a matrix in its order"}};
  for (const char* part : {"coupling", "gain", "offset", "drift", "white_noise", "quantisation"})
    parts.push_back({part, "values from the sensor's own keys"});
  return {
      .about =
          {"taxels", "Custom taxels, defined entirely in the scene: positions, readings and electronics.",
           "force: of the object on the taxel, in the pad's frame; displacement: deformed surface minus undeformed surface; with an elastic skin also without contact\n"
           "normal_force, shear: the force in the taxel's own frame, whose z axis is opposite to the taxel's direction; pressure: normal_force/width^2\n"
           "signal: curve(matrix f), f: x, y and z of the force of all taxels",
           "none: a custom sensor", parameters()},
      .electronics = electronics_of("taxels", parts),
      .create = created<Taxels>,
      .view = {
          .unit = "taxel", .units = "taxels", .letter = "T", .channels = {{"force", "Force"}, {"displacement", "Displacement"}}}};
}

}  // namespace slipbench

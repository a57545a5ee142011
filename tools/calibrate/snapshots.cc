#include "tools/calibrate/snapshots.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Dense>

#include "sim/core/counted.h"
#include "sim/core/math.h"
#include "tools/files/reject.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/statistics/descriptive.h"

namespace slipbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixX3d;
using Eigen::VectorXd;

// Fewest snapshots from which the matrix of a unit, or its noise, is computed.
constexpr Index least_snapshots = 30;
// A stiffness counts as determined above so many of its standard errors.
constexpr double least_errors = 2.0;
// The standard error of a median of normal values over that of their mean.
const double median_error = std::sqrt(0.5 * std::numbers::pi);

struct Snapshots {
  std::string sensor, type;
  double rate = 0.0;                    // Hz
  std::vector<MatrixX3d> force;         // of each unit [N], a row a snapshot
  std::vector<MatrixX3d> displacement;  // of each unit [m]
};

struct UnitFit {
  Index pressed = 0, pulled = 0, idle = 0;
  bool determined = false;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();    // K [N/m]: row = axis of the force, column = axis of the displacement
  Eigen::Matrix3d error = Eigen::Matrix3d::Zero();     // standard errors [N/m]
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // RMS [N]
  Eigen::Vector3d share = Eigen::Vector3d::Zero();     // the residual over the sd of the force
  std::optional<Eigen::Matrix<double, 6, 1>> noise;    // sd of force [N] and displacement [m] while idle

  [[nodiscard]] double normal() const { return matrix(2, 2); }
  [[nodiscard]] double tangential() const { return 0.5 * (matrix(0, 0) + matrix(1, 1)); }
  // N of the force of axis `to` over N of the force of axis `from`, since F_from = K_from,from
  // d_from.
  [[nodiscard]] double coupling(Index to, Index from) const { return matrix(to, from) / matrix(from, from); }
};

// The coefficients that one key of the part coupling bounds, as pairs of axes {to, from}.
struct CouplingKey {
  const char* name;
  std::vector<std::pair<Index, Index>> pairs;
};
const CouplingKey coupling_keys[] = {
    {"shear_to_normal", {{2, 0}, {2, 1}}}, {"normal_to_shear", {{0, 2}, {1, 2}}}, {"shear_to_shear", {{0, 1}, {1, 0}}}};

const SensorColumn* channel_of(const SensorRecord& sensor, const std::string& name, const std::string& unit) {
  const auto found = std::ranges::find(sensor.channels, name, &SensorColumn::name);
  const bool fits = found != sensor.channels.end() && found->unit == unit && found->shape.size() == 2 && found->shape[1] == 3;
  return fits ? &*found : nullptr;
}

// True if a sensor has the force and the displacement of its units at the same instants.
bool has_law(const SensorRecord& sensor) {
  const SensorColumn* force = channel_of(sensor, "force", "N");
  const SensorColumn* displacement = channel_of(sensor, "displacement", "m");
  return force != nullptr && displacement != nullptr && force->values.size() == displacement->values.size();
}

Snapshots snapshots_of(const std::vector<RawRecording>& recordings, const std::string& asked) {
  std::vector<std::string> names;
  for (const SensorRecord& sensor : recordings.front().sensors) {
    if (has_law(sensor)) names.push_back(sensor.name);
  }
  if (names.empty())
    reject("{}: no sensor has the channels force (N) and displacement (m) with the shape [units, 3], which --snapshots needs",
           recordings.front().name);
  if (asked.empty() && names.size() > 1)
    reject("{}: several sensors have force and displacement: {}; choose one with --sensor", recordings.front().name,
           fmt::join(names, ", "));
  const std::string name = asked.empty() ? names.front() : asked;

  Snapshots result;
  result.sensor = name;
  Index rows = 0;
  std::size_t units = 0;
  std::vector<const SensorRecord*> sensors;
  for (const RawRecording& recording : recordings) {
    const auto found = std::ranges::find(recording.sensors, name, &SensorRecord::name);
    if (found == recording.sensors.end() || !has_law(*found))
      reject("{}: has no sensor '{}' with the channels force (N) and displacement (m); expected {}", recording.name, name,
             fmt::join(names, ", "));
    const std::size_t count = channel_of(*found, "force", "N")->shape[0];
    if (units != 0 && count != units)
      reject("{}: sensor '{}' has {}, but in {} {}; expected recordings of the same sensor", recording.name, name,
             counted(count, "unit"), recordings.front().name, units);
    units = count;
    rows += static_cast<Index>(found->time.size());
    sensors.push_back(&*found);
  }
  result.type = sensors.front()->type;
  result.rate = sensors.front()->rate;
  result.force.assign(units, MatrixX3d(rows, 3));
  result.displacement.assign(units, MatrixX3d(rows, 3));
  Index first = 0;
  for (const SensorRecord* sensor : sensors) {
    const std::vector<float>& force = channel_of(*sensor, "force", "N")->values;
    const std::vector<float>& displacement = channel_of(*sensor, "displacement", "m")->values;
    for (std::size_t value = 0; value < force.size(); ++value) {
      const Index row = first + static_cast<Index>(value / (3 * units)), axis = static_cast<Index>(value % 3);
      const std::size_t unit = value / 3 % units;
      result.force[unit](row, axis) = force[value];
      result.displacement[unit](row, axis) = displacement[value];
    }
    first += static_cast<Index>(sensor->time.size());
  }
  return result;
}

Eigen::Vector3d deviation(const MatrixX3d& values) {
  return ((values.rowwise() - values.colwise().mean()).colwise().squaredNorm() / static_cast<double>(values.rows() - 1))
      .cwiseSqrt()
      .transpose();
}

// K by least squares with the errors of White (HC1), which do not assume that residuals are alike
// at all loads.
void fit_matrix(UnitFit& fit, const MatrixX3d& displacement, const MatrixX3d& force) {
  const Index rows = displacement.rows();
  const MatrixX3d centred = displacement.rowwise() - displacement.colwise().mean();
  const Eigen::Vector3d scale = deviation(displacement);
  const MatrixX3d design = centred * scale.cwiseInverse().asDiagonal();
  const MatrixX3d centred_force = force.rowwise() - force.colwise().mean();
  const Eigen::Matrix3d gram = design.transpose() * design;
  const Eigen::ColPivHouseholderQR<MatrixX3d> solver(design);
  if (scale.minCoeff() == 0.0 || solver.rank() < 3) return;
  const Eigen::Matrix3d bread = gram.inverse();
  const Eigen::Matrix3d solution = solver.solve(centred_force);  // column = axis of the force
  const MatrixX3d residual = centred_force - design * solution;
  const double freedom = static_cast<double>(rows) / static_cast<double>(rows - 4);
  for (Index axis = 0; axis < 3; ++axis) {
    const VectorXd square = residual.col(axis).cwiseAbs2();
    const Eigen::Matrix3d meat = design.transpose() * square.asDiagonal() * design;
    const Eigen::Matrix3d covariance = freedom * bread * meat * bread;
    fit.matrix.row(axis) = solution.col(axis).cwiseQuotient(scale).transpose();
    fit.error.row(axis) = covariance.diagonal().cwiseSqrt().cwiseQuotient(scale).transpose();
  }
  fit.residual = (residual.colwise().squaredNorm() / static_cast<double>(rows)).cwiseSqrt().transpose();
  fit.share = fit.residual.cwiseQuotient(deviation(force));
  fit.determined = true;
  for (Index axis = 0; axis < 3; ++axis)
    fit.determined = fit.determined && fit.matrix(axis, axis) > least_errors * fit.error(axis, axis);
}

MatrixX3d rows_of(const MatrixX3d& values, const std::vector<Index>& rows) { return values(rows, Eigen::all); }

UnitFit fit_unit(const MatrixX3d& force, const MatrixX3d& displacement, double idle) {
  std::vector<Index> pressed, still;
  UnitFit fit;
  for (Index row = 0; row < force.rows(); ++row) {
    if (displacement.row(row).norm() < idle) still.push_back(row);
    if (displacement(row, 2) > idle) pressed.push_back(row);
    if (displacement(row, 2) < -idle) ++fit.pulled;
  }
  fit.pressed = static_cast<Index>(pressed.size());
  fit.idle = static_cast<Index>(still.size());
  if (fit.pressed >= least_snapshots) fit_matrix(fit, rows_of(displacement, pressed), rows_of(force, pressed));
  if (fit.idle >= least_snapshots) {
    fit.noise.emplace();
    *fit.noise << deviation(rows_of(force, still)), deviation(rows_of(displacement, still));
  }
  return fit;
}

struct Estimate {
  double value = 0.0, error = 0.0;
};

double sd_of(const VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().sum() / static_cast<double>(values.size() - 1));
}

// The mean over the units. Its error follows from their scatter; that of a single unit from its own
// fit.
Estimate mean_of(const VectorXd& values, double own_error) {
  if (values.size() == 1) return {values(0), own_error};
  return {values.mean(), sd_of(values) / std::sqrt(static_cast<double>(values.size()))};
}

// The sensor's stiffness and coupling from its single units.
struct Summary {
  VectorXd normal, tangential, x, y;                  // N/m, of the units that determine them
  std::vector<VectorXd> coupling;                     // of each of coupling_keys, two a unit
  VectorXd shear;                                     // N/m of normal force over lateral displacement, two a unit
  double normal_error = 0.0, tangential_error = 0.0;  // of the first unit
};

Summary summary_of(const std::vector<UnitFit>& units) {
  std::vector<const UnitFit*> known;
  for (const UnitFit& unit : units) {
    if (unit.determined) known.push_back(&unit);
  }
  const auto count = static_cast<Index>(known.size());
  Summary summary{VectorXd(count),
                  VectorXd(count),
                  VectorXd(count),
                  VectorXd(count),
                  std::vector<VectorXd>(std::size(coupling_keys), VectorXd(2 * count)),
                  VectorXd(2 * count)};
  for (Index k = 0; k < count; ++k) {
    const UnitFit& unit = *known[static_cast<std::size_t>(k)];
    summary.normal(k) = unit.normal();
    summary.tangential(k) = unit.tangential();
    summary.x(k) = unit.matrix(0, 0);
    summary.y(k) = unit.matrix(1, 1);
    for (std::size_t key = 0; key < std::size(coupling_keys); ++key) {
      Index at = 2 * k;
      for (const auto& [to, from] : coupling_keys[key].pairs) summary.coupling[key](at++) = unit.coupling(to, from);
    }
    summary.shear.segment<2>(2 * k) = unit.matrix.block<1, 2>(2, 0).transpose();
  }
  if (count > 0) {
    const Eigen::Matrix3d& error = known.front()->error;
    summary.normal_error = error(2, 2);
    summary.tangential_error = 0.5 * math::hypot(error(0, 0), error(1, 1));
  }
  return summary;
}

Json key_json(const std::string& key, const std::string& unit, const Estimate& estimate) {
  return {{"key", key}, {"unit", unit}, {"value", estimate.value}, {"standard_error", estimate.error}};
}

// Adds the keys of the electronics: the largest coefficients of coupling, and `scale` of gain and
// noise, a factor on the device's own figures.
void add_parts(Json& keys, const SensorKind& kind, const Snapshots& snapshots, const Summary& summary,
               const std::vector<UnitFit>& units) {
  const UnitDisturbance device = kind.disturbance(summary.normal.mean(), summary.tangential.mean(), snapshots.rate);
  const auto add = [&](const std::string& parameter, const Estimate& estimate) {
    keys.push_back(key_json(fmt::format("sensors.{}.electronics.{}", snapshots.sensor, parameter), "1", estimate));
  };
  // c is uniform within its limit, so E[c^2] = limit^2/3. The error of the mean square is passed on
  // to its root.
  for (std::size_t key = 0; key < std::size(coupling_keys); ++key) {
    const VectorXd square = 3.0 * summary.coupling[key].cwiseAbs2();
    const double limit = std::sqrt(square.mean());
    const double error = limit > 0.0 ? 0.5 / limit * sd_of(square) / std::sqrt(static_cast<double>(square.size())) : 0.0;
    add(fmt::format("coupling.{}", coupling_keys[key].name), {limit, error});
  }
  const Index count = summary.normal.size();
  if (count > 1) {
    const auto ratio = [&](const VectorXd& values, std::size_t axis) {
      return sd_of(values) / values.mean() / device.gain_sd[axis];
    };
    const Eigen::Vector3d ratios(ratio(summary.x, 0), ratio(summary.y, 1), ratio(summary.normal, 2));
    const double gain = std::sqrt(ratios.squaredNorm() / 3.0);
    // The relative error of a standard deviation with f degrees of freedom is 1/sqrt(2 f).
    add("gain.scale", {gain, gain / std::sqrt(6.0 * static_cast<double>(count - 1))});
  }
  std::vector<double> scales;
  for (const UnitFit& unit : units) {
    if (!unit.noise) continue;
    double sum = 0.0;
    for (std::size_t k = 0; k < 6; ++k) sum += math::pow((*unit.noise)(static_cast<Index>(k)) / device.noise_sd[k], 2);
    scales.push_back(std::sqrt(sum / 6.0));
  }
  if (scales.size() > 1) {
    const VectorXd all = Eigen::Map<const VectorXd>(scales.data(), static_cast<Index>(scales.size()));
    add("noise.scale", {median(scales), median_error * sd_of(all) / std::sqrt(static_cast<double>(scales.size()))});
  }
}

Json unit_json(const UnitFit& unit) {
  Json json{{"pressed", unit.pressed}, {"pulled", unit.pulled}, {"idle", unit.idle}, {"determined", unit.determined}};
  for (const auto& [name, matrix] : {std::pair{"matrix", &unit.matrix}, std::pair{"standard_error", &unit.error}}) {
    for (Index row = 0; row < 3; ++row) json[name].push_back({(*matrix)(row, 0), (*matrix)(row, 1), (*matrix)(row, 2)});
  }
  for (Index axis = 0; axis < 3; ++axis) {
    json["residual"].push_back(unit.residual(axis));
    json["residual_share"].push_back(unit.share(axis));
  }
  return json;
}

// Standard deviations while idle, the median over the units; null where no unit has been idle often
// enough.
Json noise_json(const std::vector<UnitFit>& units) {
  Json json{{"units", 0}, {"force", nullptr}, {"displacement", nullptr}};
  std::vector<std::vector<double>> values(6);
  for (const UnitFit& unit : units) {
    for (std::size_t k = 0; unit.noise && k < 6; ++k) values[k].push_back((*unit.noise)(static_cast<Index>(k)));
  }
  if (values.front().empty()) return json;
  json["units"] = values.front().size();
  for (std::size_t k = 0; k < 6; ++k) {
    Json& array = json[k < 3 ? "force" : "displacement"];
    if (array.is_null()) array = Json::array();
    array.push_back(median(values[k]));
  }
  return json;
}

}  // namespace

Json fit_snapshots(const std::vector<RawRecording>& recordings, const std::string& sensor, double idle) {
  const Snapshots snapshots = snapshots_of(recordings, sensor);
  std::vector<UnitFit> units;
  for (std::size_t unit = 0; unit < snapshots.force.size(); ++unit)
    units.push_back(fit_unit(snapshots.force[unit], snapshots.displacement[unit], idle));
  const Summary summary = summary_of(units);
  if (summary.normal.size() == 0)
    reject(
        "{}: no unit of '{}' determines a stiffness; expected at least {} snapshots of a unit that is pressed by more than {:g} um, "
        "with displacements along x, y and z that vary independently",
        recordings.front().name, snapshots.sensor, least_snapshots, 1e6 * idle);
  const std::string key = fmt::format("sensors.{}.", snapshots.sensor);
  Json keys = Json::array();
  keys.push_back(key_json(key + "k_normal", "N/m", mean_of(summary.normal, summary.normal_error)));
  keys.push_back(key_json(key + "k_tangential", "N/m", mean_of(summary.tangential, summary.tangential_error)));
  const SensorKind kind = sensor_kind(snapshots.type);
  if (kind.disturbance != nullptr) add_parts(keys, kind, snapshots, summary, units);
  Json result{{"slipbench_snapshots", 1},
              {"sensor", snapshots.sensor},
              {"type", snapshots.type},
              {"snapshots", snapshots.force.front().rows()},
              {"idle_below", idle},
              {"keys", keys},
              {"shear_to_normal", std::sqrt(summary.shear.squaredNorm() / static_cast<double>(summary.shear.size()))},
              {"noise", noise_json(units)}};
  for (const UnitFit& unit : units) result["units"].push_back(unit_json(unit));
  return result;
}

page::TextTable snapshot_key_table(const Json& result) {
  page::TextTable table{{"key", "value", "standard error"}};
  for (const Json& one : result.at("keys")) {
    const bool stiffness = one.at("unit") == "N/m";
    const double factor = stiffness ? 1e-3 : 1.0;
    const char* unit = stiffness ? " N/mm" : "";
    table.rows.push_back({one.at("key").get<std::string>(), fmt::format("{:.4g}{}", factor * one.at("value").get<double>(), unit),
                          fmt::format("{:.2g}{}", factor * one.at("standard_error").get<double>(), unit)});
  }
  return table;
}

page::TextTable snapshot_unit_table(const Json& result) {
  page::TextTable table{{"unit", "pressed", "pulled", "idle", "k_normal [N/mm]", "k_tangential [N/mm]", "residual Fx, Fy, Fz"}};
  std::size_t number = 0;
  for (const Json& unit : result.at("units")) {
    const auto entry = [&](const char* name, std::size_t axis) { return 1e-3 * unit.at(name).at(axis).at(axis).get<double>(); };
    std::vector<std::string> row{fmt::format("{}", number++)};
    for (const char* name : {"pressed", "pulled", "idle"}) row.push_back(fmt::format("{}", unit.at(name).get<std::size_t>()));
    if (unit.at("determined").get<bool>()) {
      const Json& share = unit.at("residual_share");
      row.push_back(fmt::format("{:.3g} +- {:.1g}", entry("matrix", 2), entry("standard_error", 2)));
      row.push_back(fmt::format("{:.3g} +- {:.1g}", 0.5 * (entry("matrix", 0) + entry("matrix", 1)),
                                0.5 * math::hypot(entry("standard_error", 0), entry("standard_error", 1))));
      row.push_back(fmt::format("{:.0f}, {:.0f}, {:.0f} %", 100.0 * share.at(0).get<double>(), 100.0 * share.at(1).get<double>(),
                                100.0 * share.at(2).get<double>()));
    } else {
      row.insert(row.end(), {"not determined", "not determined", ""});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

namespace {

// Returns all parts of the sensor's `typical`, with `fitted` parameters; parts that are not listed
// would be off.
std::string electronics_lines(const std::vector<Entry>& parts, const std::map<std::string, std::string>& fitted) {
  std::string lines = "    electronics:\n";
  for (const Entry& part : parts) {
    const auto found = fitted.find(part.name);
    lines += fmt::format("      - {}{}\n", part.name, found == fitted.end() ? "" : fmt::format(": {{{}}}", found->second));
  }
  return lines;
}

}  // namespace

std::string snapshot_text(const Json& result) {
  const SensorKind kind = sensor_kind(result.at("type").get<std::string>());
  std::string text;
  const Json& noise = result.at("noise");
  if (noise.at("force").is_null()) {
    text += fmt::format("Noise: not determined, because no unit is idle (moved by less than {:g} um) in {} snapshots.\n",
                        1e6 * result.at("idle_below").get<double>(), least_snapshots);
  } else {
    const auto sds = [&](const char* channel, double factor) {
      const Json& values = noise.at(channel);
      return fmt::format("{:.3g}, {:.3g}, {:.3g}", factor * values.at(0).get<double>(), factor * values.at(1).get<double>(),
                         factor * values.at(2).get<double>());
    };
    text += fmt::format("Noise of idle units, sd along x, y, z: force {} mN, displacement {} um.\n", sds("force", 1e3),
                        sds("displacement", 1e6));
  }
  text += fmt::format("Normal force per lateral displacement: {:.2g} N/mm rms{}.\n",
                      1e-3 * result.at("shear_to_normal").get<double>(),
                      kind.disturbance != nullptr ? "" : "; scenes have no key for it");
  text += fmt::format("For a scene:\n\nsensors:\n  {}:\n    type: {}\n", result.at("sensor").get<std::string>(),
                      result.at("type").get<std::string>());
  std::map<std::string, std::string> fitted;  // parameters of each part of the electronics
  for (const Json& one : result.at("keys")) {
    const std::string path = one.at("key");
    const double value = one.at("value");
    const std::string part = ".electronics.";
    if (const std::size_t at = path.find(part); at == std::string::npos) {
      text += fmt::format("    {}: {:.4g} N/mm\n", path.substr(path.rfind('.') + 1), 1e-3 * value);
    } else {
      const std::string name = path.substr(at + part.size());
      const std::size_t dot = name.find('.');
      std::string& parameters = fitted[name.substr(0, dot)];
      parameters += fmt::format("{}{}: {:.3g}", parameters.empty() ? "" : ", ", name.substr(dot + 1), value);
    }
  }
  return fitted.empty() ? text : text + electronics_lines(kind.electronics, fitted);
}

}  // namespace slipbench::calibrate

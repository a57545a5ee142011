#include "tools/studies/myrmex_tactile_cnn/myrmex_onset.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>

#include "sensors/myrmex/foam_cell.h"
#include "sim/core/error.h"

namespace slipbench::reproduce {
namespace {

constexpr double rest = myrmex::full_scale;

const std::vector<float>& taxels_of(const SensorRecord& sensor) {
  for (const SensorColumn& column : sensor.channels) {
    if (column.name == "taxels") return column.values;
  }
  throw InputError("sensor " + sensor.name + " has no taxels; allowed: a myrmex");
}

// Of each sample, the counts that are missing of the taxel that misses most.
std::vector<double> most_missing(const SensorRecord& sensor) {
  const std::vector<float>& taxels = taxels_of(sensor);
  const std::size_t units = sensor.labels.units();
  std::vector<double> most;
  for (std::size_t k = 0; k < sensor.time.size(); ++k) {
    most.push_back(rest - static_cast<double>(*std::ranges::min_element(std::span(taxels).subspan(k * units, units))));
  }
  return most;
}

}  // namespace

std::vector<double> sum_of_contacts(const SensorRecord& sensor) {
  const std::vector<float>& taxels = taxels_of(sensor);
  const std::size_t units = sensor.labels.units();
  std::vector<double> sums;
  for (std::size_t k = 0; k < sensor.time.size(); ++k) {
    double sum = 0.0;
    for (std::size_t u = 0; u < units; ++u) sum += rest - static_cast<double>(taxels[k * units + u]);
    sums.push_back(sum);
  }
  return sums;
}

std::vector<double> backward_mean(std::span<const double> time, std::span<const double> values, double window) {
  std::vector<double> averaged(values.begin(), values.end());
  if (!(window > 0.0)) return averaged;
  std::size_t first = 0;
  double total = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    total += values[k];
    while (first < k && time[k] - time[first] >= window) total -= values[first++];
    averaged[k] = total / static_cast<double>(k - first + 1);
  }
  return averaged;
}

std::optional<double> decrease_onset(std::span<const double> time, std::span<const double> sum, const OnsetRule& rule,
                                     double from, double to, double end, double least) {
  const std::vector<double> averaged = backward_mean(time, sum, rule.window);
  double n = 0.0, mean = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (time[k] < from || time[k] >= to) continue;
    n += 1.0;
    const double step = averaged[k] - mean;
    mean += step / n;
    squares += step * (averaged[k] - mean);
  }
  if (n < 2.0) return {};
  const double level = mean - std::max(least, rule.threshold * std::sqrt(squares / (n - 1.0)));
  std::optional<double> onset;
  for (std::size_t k = 0; k < sum.size() && time[k] <= end; ++k) {
    if (time[k] < to) continue;
    if (!(averaged[k] < level)) {
      onset.reset();
    } else if (!onset) {
      onset = time[k];
    }
  }
  return onset;
}

std::vector<double> slipping_share(const SensorRecord& sensor) {
  const std::size_t units = sensor.labels.units();
  std::vector<double> shares;
  for (std::size_t k = 0; k < sensor.time.size(); ++k) {
    double all = 0.0, slipping = 0.0;
    for (std::size_t u = 0; u < units; ++u) {
      const double force = sensor.labels.force[3 * (k * units + u) + 2];
      all += force;
      if (sensor.labels.unit_state[k * units + u] == static_cast<std::uint8_t>(UnitState::slip)) slipping += force;
    }
    shares.push_back(all > 0.0 ? slipping / all : 0.0);
  }
  return shares;
}

TrueSlip true_slip(const SensorRecord& left, const SensorRecord& right, double from) {
  const std::vector<double> a = slipping_share(left), b = slipping_share(right);
  const auto none = static_cast<std::uint8_t>(PadState::no_contact);
  TrueSlip slip;
  for (std::size_t k = 0; k < left.time.size(); ++k) {
    if (left.time[k] < from) continue;
    if (left.labels.state[k] == none || right.labels.state[k] == none) break;
    slip.end = left.time[k];
    if (std::min(a[k], b[k]) < 0.5) {
      slip.onset.reset();
    } else if (!slip.onset) {
      slip.onset = left.time[k];
    }
  }
  return slip;
}

ContactGate sum_end() {
  // Cut off above rest, a normal variable misses sd/sqrt(2 pi) in the mean, and has the standard deviation sqrt(1/2 - 1/(2 pi)) sd.
  constexpr double cut_mean = 0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2;
  const double cut_sd = std::sqrt(0.5 - cut_mean * cut_mean);
  constexpr double taxels = 256.0, images = 20.0;  // of an array; of its sum's mean of 20 ms at 1 kHz
  return {true, 0.02, taxels * taxel_noise_sd * (cut_mean + 5.0 * cut_sd / std::sqrt(taxels * images))};
}

double contact_end(const SensorRecord& left, const SensorRecord& right, const ContactGate& gate) {
  double end = 0.0;
  for (const SensorRecord* sensor : {&left, &right}) {
    const std::vector<double> missing =
        backward_mean(sensor->time, gate.of_sum ? sum_of_contacts(*sensor) : most_missing(*sensor), gate.window);
    for (std::size_t k = 0; k < missing.size(); ++k) {
      if (missing[k] > gate.counts) end = std::max(end, sensor->time[k]);
    }
  }
  return end;
}

const SensorRecord& bench_sensor(const TrialRecord& record, std::string_view name) {
  const auto found = std::ranges::find(record.sensors, name, &SensorRecord::name);
  if (found == record.sensors.end()) throw std::logic_error("scenes/myrmex/dataset.yaml has no sensor " + std::string(name));
  return *found;
}

std::string object_name(const BodyScene& body) {
  const Parameters& p = body.shape.parameters;
  if (p.values().contains("bore") && p.number("bore") > 0.0) return "glass";
  return body.shape.name == "box" ? "remote" : body.shape.name;
}

bool is_rotational(const BodyScene& body) {
  constexpr double from = 5e-3;  // m
  return std::abs(side_of_mass(body)) > from;
}

double side_of_mass(const BodyScene& body) {
  const Parameters& p = body.shape.parameters;
  const auto vector = [&](const char* name) { return Eigen::Vector3d::Map(p.vector(name).data()); };
  const Eigen::Vector3d angles = vector("rotation");
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
  const bool known = p.values().contains("centre_of_mass");
  const Eigen::Vector3d centre = known ? Eigen::Vector3d(turn * vector("centre_of_mass")) : Eigen::Vector3d(0.0, 0.0, 0.0);
  return vector("position").y() + centre.y();
}

}  // namespace slipbench::reproduce

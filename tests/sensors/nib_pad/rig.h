// A nib pad with default or changed parameters, and contacts for it.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sensors/nib_pad/nib_pad.h"
#include "sim/api/sensor.h"

namespace slipbench::nib_pad_test {

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

inline std::unique_ptr<Sensor> make(const Changes& changes = {}, std::uint64_t trial = 0) {
  Parameters parameters = defaults_of(nib_pad_sensor().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return nib_pad_sensor().create(parameters, {}, 7, trial, "pad");
}

// All values read at one instant without averaging, as in the closed forms.
inline Changes at_once() { return {{"scan", std::string("simultaneous")}, {"average", std::int64_t{1}}}; }
inline Changes at_once_and(const std::string& name, const Parameters::Value& value) {
  Changes changes = at_once();
  changes.emplace_back(name, value);
  return changes;
}

// Every nib pressed with `force` [N] and deflected by (qx, qy) [m].
inline ContactFrame contact(double force = 0.0, double qx = 0.0, double qy = 0.0) {
  ContactFrame frame;
  frame.force.setZero(3, 36);
  frame.force.row(2) = force;
  frame.displacement.setZero(3, 36);
  frame.displacement.row(0) = qx;
  frame.displacement.row(1) = qy;
  frame.slip_distance.setZero(36);
  frame.unit_state.assign(36, force > 0.0 ? UnitState::stick : UnitState::detached);
  return frame;
}

// Position of nib n [m].
inline double east(std::size_t n) { return (static_cast<double>(n % 6) - 2.5) * 3.8e-3; }
inline double north(std::size_t n) { return (2.5 - static_cast<double>(n / 6)) * 3.8e-3; }

// The frame after a complete image of si under a constant contact.
inline std::vector<float> image(Sensor& sensor, const ContactFrame& truth) {
  std::vector<float> values;
  for (std::size_t k = 0; k < 9 * sensor.scans(); ++k) {
    const SensorFrame& frame = sensor.measure(truth);
    values.assign(frame.values.begin(), frame.values.end());
  }
  return values;
}

// Counts at 13 bit of a value whose capacitance has risen by `change` [pF]: 85 % of 8191 without
// load.
inline double counts(double per_picofarad, double change) { return std::round(0.85 * 8191.0 + per_picofarad * change); }

// Increase of one nib's electrode capacitance [pF] over its unloaded value, for a gap narrowed by
// `closed` [mm].
inline double risen(double closed) { return 0.045 * (0.254 / (0.254 - closed) - 1.0); }

enum Side : std::size_t { west, north_side, east_side, south };
inline std::size_t si(std::size_t taxel, std::size_t side) { return 4 * taxel + side; }
inline constexpr std::size_t fl = 36, fr = 38;

}  // namespace slipbench::nib_pad_test

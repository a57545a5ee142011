// Arrays of foam cells and contacts for them.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sensors/myrmex/myrmex.h"
#include "sim/api/sensor.h"

namespace slipbench::myrmex_test {

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

inline Named part(const std::string& name) {
  for (const Entry& entry : myrmex_sensor().electronics) {
    if (entry.name == name) return {name, defaults_of(entry.parameters)};
  }
  return {};
}

inline std::unique_ptr<Sensor> array(const Changes& changes = {}, const std::vector<Named>& parts = {}, std::uint64_t trial = 0) {
  Parameters parameters = defaults_of(myrmex_sensor().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return myrmex_sensor().create(parameters, parts, 7, trial, "pad");
}

// All taxels under a total force [N], shared equally.
inline ContactFrame pressed(std::size_t taxels, double force) {
  ContactFrame truth;
  truth.force.setZero(3, static_cast<Eigen::Index>(taxels));
  truth.force.row(2) = force / static_cast<double>(taxels);
  truth.unit_state.assign(taxels, UnitState::stick);
  truth.state = PadState::non_slip;
  return truth;
}

}  // namespace slipbench::myrmex_test

#include "tools/program/verify/cone_law.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "sim/core/contact_frame.h"
#include "tools/program/catalogue/sensor_catalogue.h"

namespace slipbench::verify {
namespace {

// Labels are float32, so that both sides of the law are rounded at 6e-8 of the force.
constexpr double relative = 1e-6;
constexpr double least_force = 1e-9;  // N
constexpr double of_margin = 1e-5;

// Whether the elements of a pad look in several directions, as those of a fingertip do.
bool is_curved(const PadLayout& layout) {
  return std::ranges::any_of(layout.elements,
                             [&](const Element& element) { return element.axis != layout.elements.front().axis; });
}

bool has_sums(const PadLayout& layout) {
  return std::ranges::any_of(layout.units, [](const UnitRange& unit) { return unit.count > 1; });
}

}  // namespace

ConeLaw cone_law(const Scene& scene, std::size_t index) {
  ConeLaw law;
  const auto leave_out = [&law](const std::vector<bool ConeLaw::*>& parts, const std::string& why) {
    for (const auto part : parts) law.*part = false;
    law.left_out.push_back(why);
  };
  if (scene.fidelity != "field") {
    leave_out({&ConeLaw::margin, &ConeLaw::stick, &ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
              fmt::format("all: fidelity {} keeps the cone to the solver's tolerance", scene.fidelity));
    return law;
  }
  for (const Named& effect : scene.effects) {
    const std::string& name = effect.name;
    if (name == "ageing" || name == "anisotropic_friction" || name == "load_dependent_friction" || name == "patchy_friction") {
      leave_out({&ConeLaw::stick, &ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
                fmt::format("all but margin >= 0: {} changes the friction, mu_static and mu_kinetic are the scene's", name));
    } else if (name == "viscous_friction") {
      leave_out({&ConeLaw::slip_most, &ConeLaw::slip_least}, "slip: viscous_friction adds to mu_kinetic");
    } else if (name == "stribeck") {
      leave_out({&ConeLaw::slip_least}, "slip from below: stribeck takes from mu_kinetic");
    } else if (name == "inertia" || name == "asperities") {
      leave_out({&ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
                fmt::format("slip and margin's value: with {} a tip's force is also that of its mass", name));
    }
  }
  const std::unique_ptr<Sensor> sensor = make_sensor(scene.sensors.at(index), scene.seed, 0);
  if (has_sums(sensor->layout())) {
    if (is_curved(sensor->layout()) && (scene.dynamic() || scene.surface.name != "plane")) {
      leave_out({&ConeLaw::stick, &ConeLaw::margin_value, &ConeLaw::slip_most, &ConeLaw::slip_least},
                "all but margin >= 0: elements of one unit meet faces of several directions");
    } else {
      leave_out({&ConeLaw::slip_least}, "slip from below: a unit is the sum of elements whose directions differ");
    }
  }
  return law;
}

void check_cone(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  const LabelRecord& labels = sensor.labels;
  const std::size_t units = labels.units();
  for (const std::string& why : law.left_out) verification.leave_out(Check::cone, why);
  for (std::size_t i = 0; i < labels.unit_state.size(); ++i) {
    const std::size_t unit = i % units;
    const auto state = static_cast<UnitState>(labels.unit_state[i]);
    const float* force = labels.force.data() + 3 * i;
    const double tangential = std::hypot(static_cast<double>(force[0]), static_cast<double>(force[1]));
    const double normal = force[2];
    const double margin = labels.margin[i];
    const auto fail = [&](const char* array, const std::string& what) {
      verification.fail(Check::cone, {trial, fmt::format("labels/{}/{}", sensor.name, array), i / units},
                        fmt::format("unit {}: {}", unit, what));
    };
    if (state == UnitState::detached) {
      if (tangential != 0.0 || normal != 0.0)
        fail("force", fmt::format("is detached and bears {} N", std::hypot(tangential, normal)));
      continue;
    }
    verification.count(Check::cone, 1);
    const double slack = least_force + relative * std::abs(normal);
    const double most_stuck = labels.mu_static[unit] * normal, slipping = labels.mu_kinetic[unit] * normal;
    if (normal < -slack) fail("force", fmt::format("touches and is pulled with {} N", -normal));
    if (state == UnitState::slip) {
      if (law.slip_most && tangential > slipping + slack)
        fail("force", fmt::format("slips at f_t = {} N, more than mu_kinetic f_n = {} N", tangential, slipping));
      if (law.slip_least && tangential < slipping - slack)
        fail("force", fmt::format("slips at f_t = {} N, less than mu_kinetic f_n = {} N", tangential, slipping));
    } else {
      if (law.margin && margin < -of_margin) fail("margin", fmt::format("sticks with the margin {}, below 0", margin));
      if (law.stick && tangential > most_stuck + slack)
        fail("force", fmt::format("sticks at f_t = {} N, more than mu_static f_n = {} N", tangential, most_stuck));
    }
    if (law.margin_value && most_stuck > 0.0 &&
        std::abs(margin - (1.0 - tangential / most_stuck)) > of_margin * std::max(1.0, std::abs(margin))) {
      fail("margin", fmt::format("is {}, and 1 - f_t/(mu_static f_n) is {}", margin, 1.0 - tangential / most_stuck));
    }
  }
}

}  // namespace slipbench::verify

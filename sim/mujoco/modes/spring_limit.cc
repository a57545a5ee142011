#include "sim/mujoco/modes/spring_limit.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/math/decade.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

// Factor by which the step may exceed the longest accurate one once the run has started and bodies
// have moved to other poses: h omega = 1. At 1.2 the acceleration of a slide was wrong by 1 to
// 11 %, measured with boxes between two pads.
constexpr double limit_slack = 4.0 / 3.0;

}  // namespace

double rounded_down(double value) {
  if (!std::isfinite(value) || value <= 0.0) return value;
  const double unit = power_of_ten(decade_of(value) - 2);
  return rounded_to_digits(std::floor(value / unit) * unit, 3);
}

bool SpringLimit::due(const FieldContacts& contacts) {
  const std::size_t touching = contacts.touching();
  return touching > std::exchange(touching_before_, touching);
}

void SpringLimit::check(const DynamicWorld& world, const FieldContacts& contacts, double time) const {
  const PadTangents stuck = contacts.stuck(true);
  if (world.dt() <= limit_slack * longest_step_(vibration_bound(world.m(), world.d(), stuck.bodies, stuck.tangents))) return;
  const double longest = limit_slack * longest_step_(fastest_vibration(world.m(), world.d(), stuck.bodies, stuck.tangents));
  if (world.dt() > longest) {
    throw SceneValueError("time_step", fmt::format("{} is too long for the pads' springs from {:.6g} s on; allowed: up to {}",
                                                   format_quantity(world.dt(), Quantity::time), time,
                                                   format_quantity(rounded_down(longest), Quantity::time)));
  }
}

}  // namespace slipbench

#include "sim/stage/step_plan.h"

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace {

// Relative tolerance for times that should be whole multiples: they come from decimal text.
constexpr double rounding = 1e-9;

// Number of divisors of a sampling time tried before sensors' rates count as having no common step.
constexpr double most_divisors = 100.0;

// Returns n if `longer` is n times `shorter`, else 0.
std::size_t whole_ratio(double longer, double shorter) {
  const double ratio = longer / shorter;
  const double nearest = std::round(ratio);
  return nearest >= 1.0 && std::abs(ratio - nearest) <= rounding * nearest ? static_cast<std::size_t>(nearest) : 0;
}

// Returns the longest step that divides every sampling time. If none of most_divisors steps does,
// the check in plan_steps() reports the sensor that does not fit.
double automatic_step(std::span<const double> rates, double longest) {
  const double fastest = *std::max_element(rates.begin(), rates.end());
  const double first = std::max(1.0, std::ceil(1.0 / (fastest * longest)));
  const auto step_of = [&](double divisor) { return 1.0 / fastest / divisor; };
  const auto divides_all = [&](double divisor) {
    return std::all_of(rates.begin(), rates.end(), [&](double rate) { return whole_ratio(1.0 / rate, step_of(divisor)) != 0; });
  };
  double divisor = first;
  while (divisor < first + most_divisors && !divides_all(divisor)) divisor += 1.0;
  return step_of(divides_all(divisor) ? divisor : first);
}

// Blames the sensor whose rate alone needs too many steps, or the limit.
void refuse_too_many_steps(const Scene& scene, std::span<const double> rates, double dt, const StepLimit& limit,
                           std::size_t first) {
  if (!(scene.duration / dt > max_steps)) return;
  const std::string longest = bound_in_unit_of("1 s", max_steps * dt, Quantity::time, Bound::upper);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    if (!(scene.duration * rates[i] > max_steps)) continue;
    throw SceneValueError(
        "sensors." + scene.sensors[first + i].name + ".rate",
        fmt::format("a rate of {} needs more than 100,000,000 steps; allowed: up to {}, or a duration up to {}",
                    readable_quantity(rates[i], Quantity::frequency),
                    bound_in_unit_of("1 Hz", max_steps / scene.duration, Quantity::frequency, Bound::upper), longest));
  }
  throw SceneValueError("duration",
                        fmt::format("{} needs more than 100,000,000 steps of {}, which {}; allowed: up to {}",
                                    readable_quantity(scene.duration, Quantity::time), readable_quantity(dt, Quantity::time),
                                    dt < 1.0 / *std::ranges::max_element(rates) && !limit.cause.empty()
                                        ? "is the longest step for " + limit.cause
                                        : "divides the sampling times of the sensors",
                                    longest));
}

}  // namespace

StepPlan plan_steps(const Scene& scene, std::span<const double> output_rates, const StepLimit& limit, std::size_t first) {
  StepPlan plan;
  plan.dt = scene.time_step ? *scene.time_step : automatic_step(output_rates, limit.longest);
  if (plan.dt > limit.longest * (1.0 + rounding)) {
    throw SceneValueError(
        "time_step",
        fmt::format("{} is too long for {}; allowed: up to {}", readable_quantity(plan.dt, Quantity::time), limit.cause,
                    bound_in_unit_of(readable_quantity(plan.dt, Quantity::time), limit.longest, Quantity::time, Bound::upper)));
  }
  refuse_too_many_steps(scene, output_rates, plan.dt, limit, first);
  plan.ticks = whole_ratio(scene.duration, plan.dt);
  if (plan.ticks == 0) {
    throw SceneValueError(
        "duration",
        fmt::format(
            "{} is not a whole number of steps of {}{}", format_quantity(scene.duration, Quantity::time),
            readable_quantity(plan.dt, Quantity::time),
            output_rates.size() < scene.sensors.size() ? ", the steps of sensor '" + scene.sensors[first].name + "'" : ""));
  }
  for (std::size_t i = 0; i < output_rates.size(); ++i) {
    const std::string sampling_time = readable_quantity(1.0 / output_rates[i], Quantity::time);
    plan.strides.push_back(whole_ratio(1.0 / output_rates[i], plan.dt));
    if (plan.strides.back() == 0) {
      throw SceneValueError(
          "time_step",
          fmt::format("{} does not divide the sampling time {} of sensor '{}'; allowed: {} divided by a whole number",
                      readable_quantity(plan.dt, Quantity::time), sampling_time, scene.sensors[first + i].name, sampling_time));
    }
  }
  return plan;
}

}  // namespace slipbench

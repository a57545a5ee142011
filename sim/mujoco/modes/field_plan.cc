#include "sim/mujoco/modes/field_plan.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/mujoco/linear/average_acceleration.h"
#include "sim/mujoco/modes/spring_limit.h"
#include "sim/mujoco/pads/implicit.h"

namespace slipbench {
namespace {

// True if the springs of a grasp are implicit. With `automatic` they are implicit if that is
// cheaper: an implicit step costs up to half as much again as an explicit one, so the springs are
// explicit if a sensor or an effect needs steps nearly as short as explicit springs do. A step
// given by the scene is chosen for accuracy and therefore implicit: its error falls with the square
// of the step, while the error of an explicit step, whose dashpots use the velocity of half a step
// ago, falls linearly. `longest`: the longest step for the effects.
bool choose_implicit(const Scene& scene, FieldSolver requested, std::span<const double> rates, double longest,
                     const Vibration& fastest) {
  const auto steps = [&](double bearable) {
    const double sampling_time = 1.0 / *std::ranges::max_element(rates);
    return std::ceil(sampling_time / std::min({sampling_time, longest, bearable}));
  };
  if (requested != FieldSolver::automatic) return requested == FieldSolver::implicit_springs;
  const double explicit_step = rounded_down(longest_explicit_step(fastest));
  if (!scene.integrator.empty()) return false;
  if (scene.time_step) return true;
  return !rates.empty() && steps(explicit_step) >= 1.5 * steps(rounded_down(longest_averaged_step(fastest)));
}

// Throws SceneValueError if MuJoCo's solver cannot take the pads' springs.
void refuse_implicit(const DynamicWorld& world, const FieldContacts& contacts) {
  const std::vector<ImplicitPad> joined = contacts.implicit_pads();
  std::string why = implicit_refusal(world.m(), joined);
  if (why.empty()) why = implicit_self_test(world.m(), joined);
  if (!why.empty()) throw SceneValueError("field_solver", "implicit " + why);
}

}  // namespace

FieldPlan plan_fields(const DynamicWorld& world, const FieldContacts& contacts, const DynamicSetup& setup) {
  const Scene& scene = setup.scene;
  const DynamicSimulationOptions& options = setup.options;
  StepLimit limit = setup.limit_of_motion();
  FieldPlan plan;
  bool springs_known = true, skins = false;
  for (std::size_t i = 0; i < setup.layouts.size(); ++i) {
    if (scene.sensors[i].friction) continue;  // without effects
    const PadLayout* pad = setup.layouts[i];
    const FieldEffects effects = install_effects(scene.effects, *pad, Plane{}, scene.seed, setup.trial);
    if (setup.motion != nullptr) {
      const StepLimit of_pad = step_limit(*setup.motion, effects, reach_of(*pad));
      if (of_pad.longest < limit.longest) limit = of_pad;
    }
    plan.stored_energy_known = plan.stored_energy_known && effects.surface.empty() && effects.rheology.empty();
    springs_known = springs_known && effects.rheology.empty();
    skins = skins || effects.skin != nullptr;
  }
  if (!springs_known && options.hand_solver == FieldSolver::implicit_springs) {
    throw SceneValueError(
        "field_solver",
        "implicit springs of a grasp cannot be combined with effects that change their stiffness; allowed: auto, explicit");
  }
  if (scene.implicit_fields()) {
    refuse_implicit(world, contacts);
  } else if (options.refuse_long_steps) {
    const PadTangents stuck = contacts.stuck(false);
    const Vibration fastest = fastest_vibration(world.m(), world.d(), stuck.bodies, stuck.tangents);
    plan.averages = springs_known && choose_implicit(scene, options.hand_solver, setup.rates, limit.longest, fastest);
    if (const double right = plan.averages ? longest_averaged_step(fastest) : longest_explicit_step(fastest);
        right < limit.longest) {
      limit.longest = rounded_down(right);
      limit.cause =
          plan.averages
              ? fmt::format(
                    "implicit springs of the pads, which vibrate at up to {:.4g} rad/s on their bodies and are damped at {:.4g} /s",
                    fastest.omega, fastest.damping_rate)
              : fmt::format(
                    "explicit springs of the pads, which vibrate at up to {:.4g} rad/s on their bodies and are damped at {:.4g} /s{}",
                    fastest.omega, fastest.damping_rate,
                    skins                     ? ""
                    : options.hand != nullptr ? " (`field_solver: implicit` has a longer limit)"
                                              : " (`field_solver: implicit` has no such limit)");
    }
  }
  plan.steps = plan_steps(scene, setup.rates, limit);
  return plan;
}

}  // namespace slipbench

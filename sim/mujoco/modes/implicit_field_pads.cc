#include "sim/mujoco/modes/implicit_field_pads.h"

#include <algorithm>
#include <ranges>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/mujoco/modes/run_watch.h"
#include "sim/mujoco/pads/field_plugin.h"

namespace slipbench {

ImplicitFieldPads::ImplicitFieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known)
    : FieldPads(world, setup, stored_energy_known) {}

void ImplicitFieldPads::take_tick(std::size_t tick, RunWatch& watch) {
  const double time = world_.time_of(tick);
  world_.apply_controls(time);
  world_.d()->time = time;
  watch.begin_step();
  world_.step(time);
  watch.end_step();
  if (world_.d()->nefmcon == 0) refuse_missing_springs(time);
  world_.prescribe(world_.time_of(tick + 1));
  watch.check_step_from(time);
}

void ImplicitFieldPads::refuse_missing_springs(double time) const {
  const auto touches = [this](std::size_t pad) { return truth(pad, FramePart::states).state != PadState::no_contact; };
  if (std::ranges::none_of(std::views::iota(std::size_t{0}, contacts_.pads()), touches)) return;
  // a pad that separates within the step has neither springs nor a force at its end
  Eigen::VectorXd force(world_.m()->nv);
  find_force(force);
  if (!force.isZero(0.0)) {
    throw InputError(
        fmt::format("at {:.6g} s the pads' implicit springs are missing in MuJoCo's solver; use field_solver: explicit", time));
  }
}

// With impratio 1e4 together with implicit pads MuJoCo's solver leaves a residual that changes its
// sign from step to step.
WatchSettings ImplicitFieldPads::watch_settings(const WatchLimits& limits) const {
  return {.limits = limits, .judge_fields = stored_energy_known_, .constraints_predicted = true};
}

void ImplicitFieldPads::find_force(Eigen::VectorXd& force) const {
  force.setZero();
  pad_group_of(world_.m(), world_.d())->add_applied(world_.m(), world_.d(), force.data());
}

PadEnergy ImplicitFieldPads::read_energy() { return contacts_.spring_energy(); }

// The solver's.
Eigen::Vector3d ImplicitFieldPads::force_on(int /*body*/, int dof, const Eigen::VectorXd& force) const {
  return force.segment<3>(dof);
}

}  // namespace slipbench

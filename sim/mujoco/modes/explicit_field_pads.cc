#include "sim/mujoco/modes/explicit_field_pads.h"

#include "sim/mujoco/modes/run_watch.h"

namespace slipbench {

ExplicitFieldPads::ExplicitFieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known)
    : FieldPads(world, setup, stored_energy_known) {
  if (setup.options.refuse_long_steps) limit_.emplace(longest_explicit_step);
}

void ExplicitFieldPads::begin() {
  call_mujoco([this] { mj_forward(world_.m(), world_.d()); });
}

void ExplicitFieldPads::take_tick(std::size_t tick, RunWatch& watch) {
  const double time = world_.time_of(tick);
  world_.apply_controls(time);
  world_.d()->time = time;
  watch.begin_step();
  world_.step(time);
  watch.end_step();
  world_.prescribe(world_.time_of(tick + 1));
  // Before the first step, the owner of the data may still move bodies.
  if (tick == 0) {
    for (std::size_t pad = 0; pad < contacts_.pads(); ++pad) contacts_.pad(pad).keep_state();
  }
  if (limit_ && limit_->due(contacts_)) limit_->check(world_, contacts_, time);
  watch.check_step_from(time);
}

WatchSettings ExplicitFieldPads::watch_settings(const WatchLimits& limits) const {
  return {.limits = limits, .judge_fields = stored_energy_known_};
}

void ExplicitFieldPads::find_force(Eigen::VectorXd& force) const { contacts_.find_passive_force(force); }

PadEnergy ExplicitFieldPads::read_energy() {
  return contacts_.read([](const PadInstance& pad, std::size_t field) -> const Wrench& { return pad.applied(field); });
}

Eigen::Vector3d ExplicitFieldPads::force_on(int body, int /*dof*/, const Eigen::VectorXd& /*force*/) const {
  return contacts_.force_on(body);
}

}  // namespace slipbench

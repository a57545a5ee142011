#include "sim/mujoco/modes/explicit_field_pads.h"

#include "sim/mujoco/modes/run_watch.h"

namespace slipbench {

ExplicitFieldPads::ExplicitFieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known)
    : FieldPads(world, setup, stored_energy_known) {
  if (setup.options.refuse_long_steps) limit_.emplace(longest_explicit_step);
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
  if (tick == 0) keep_states();
  if (limit_ && limit_->due(contacts_)) limit_->check(world_, contacts_, time);
  watch.check_step_from(time);
}

WatchSettings ExplicitFieldPads::watch_settings(const WatchLimits& limits) const {
  return {.limits = limits, .judge_fields = stored_energy_known_};
}

}  // namespace slipbench

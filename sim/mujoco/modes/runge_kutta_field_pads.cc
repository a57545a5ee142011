#include "sim/mujoco/modes/runge_kutta_field_pads.h"

#include "sim/mujoco/modes/run_watch.h"

namespace slipbench {

RungeKuttaFieldPads::RungeKuttaFieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known)
    : FieldPads(world, setup, stored_energy_known) {
  if (setup.options.refuse_long_steps) limit_.emplace(longest_explicit_step);
}

void RungeKuttaFieldPads::begin() {
  FieldPads::begin();
  // RK4 commits only at the end of a step. Pads that touch at t = 0 must stick there, unstrained,
  // as with any other integrator. Otherwise no tip would hold in the first step, and tick 0 would
  // have no truth.
  for (std::size_t pad = 0; pad < contacts_.pads(); ++pad) contacts_.pad(pad).commit(world_.m(), world_.d());
}

void RungeKuttaFieldPads::take_tick(std::size_t tick, RunWatch& watch) {
  const double time = world_.time_of(tick);
  if (tick > 0) {
    const double start = world_.time_of(tick - 1);
    world_.apply_controls(start);
    // The fields were committed at the end of the last step, at the time that MuJoCo gave it, so
    // that d->time must not change.
    watch.begin_step();
    world_.step(start);
    watch.end_step();
    world_.prescribe(time);
  }
  if (limit_ && limit_->due(contacts_)) limit_->check(world_, contacts_, time);
  tick > 0 ? watch.check_step_to(time) : watch.check_start(time);
}

WatchSettings RungeKuttaFieldPads::watch_settings(const WatchLimits& limits) const {
  return {.limits = limits, .judge_fields = stored_energy_known_, .pads_predicted = true, .constraints_predicted = true};
}

PadEnergy RungeKuttaFieldPads::read_energy() {
  // RK4 has been through other stages since the tick.
  return contacts_.read([](const PadInstance& pad, std::size_t field) {
    return pad.fields()[field].damped_wrench_on_pad(pad.motion(field), pad.config().damping);
  });
}

}  // namespace slipbench

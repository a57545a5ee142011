#include "sim/mujoco/modes/grasp_field_pads.h"

#include <span>

#include "sim/core/error.h"
#include "sim/mujoco/models/gripper_model.h"
#include "sim/mujoco/modes/run_watch.h"
#include "sim/mujoco/pads/pad_kinematics.h"

namespace slipbench {
namespace {

// True if other springs act than in the previous step, or if the springs rotate with a slip.
bool springs_changed(const Field& field) {
  if (field.slipping() > 0) return true;
  const std::span now(field.columns().mode, field.size()), before(field.columns().before.mode, field.size());
  return !std::ranges::equal(now, before);
}

}  // namespace

GraspFieldPads::GraspFieldPads(DynamicWorld& world, const DynamicSetup& setup, const FieldPlan& plan,
                               const std::array<Vector6d, 2>& carriages)
    : FieldPads(world, setup, plan.stored_energy_known), free_bodies_(world.m()), carriages_(carriages) {
  if (plan.averages) {
    const std::span<const int> fingers = contacts_.finger_bodies();
    held_bodies_.emplace(world.m(), std::array{fingers[0], fingers[1]},
                         mj_name2id(world.m(), mjOBJ_BODY, setup.options.hand->box),
                         finger_spring(setup.options.hand->grip).tangent(Eigen::Matrix3d::Identity()), world.dt());
    added_.assign(contacts_.all().size(), Matrix6d::Zero());
  }
  if (setup.options.refuse_long_steps) limit_.emplace(plan.averages ? longest_averaged_step : longest_explicit_step);
}

void GraspFieldPads::take_tick(std::size_t tick, RunWatch& watch) {
  const double time = world_.time_of(tick);
  world_.d()->time = time;
  watch.begin_step();
  world_.step(time, [this, tick] { step_bodies(tick); });
  watch.end_step();
  world_.prescribe(world_.time_of(tick + 1));
  // Before the first step, the owner of the data may still move bodies.
  if (tick == 0) keep_states();
  if (limit_ && limit_->due(contacts_)) {
    static_cast<void>(world_.bodies());  // otherwise the code below would round centres of mass
    call_mujoco([this] { FreeBodies::factor(world_.m(), world_.d()); });
    limit_->check(world_, contacts_, time);
  }
  watch.check_step_from(time);
}

// Replaces mj_step: only the pads' forces and applied forces act.
void GraspFieldPads::step_bodies(std::size_t tick) {
  const mjModel* m = world_.m();
  mjData* d = world_.d();
  const double dt = world_.dt();
  // True if MuJoCo might reject one of the values.
  const auto suspect = [](const mjtNum* values, mjtSize count) {
    return !(Eigen::Map<const Eigen::VectorXd>(values, count).squaredNorm() <= mjMAXVAL * mjMAXVAL);
  };
  if (suspect(d->qpos, m->nq)) call_mujoco([m, d] { mj_checkPos(m, d); });
  if (suspect(d->qvel, m->nv)) call_mujoco([m, d] { mj_checkVel(m, d); });
  free_bodies_.place(m, d);
  const auto all = [m](mjtNum* values) { return Eigen::Map<Eigen::VectorXd>(values, m->nv); };
  all(d->qfrc_passive).setZero();
  for (std::size_t pad = 0; pad < contacts_.pads(); ++pad) contacts_.pad(pad).add_force(m, d);
  all(d->qfrc_smooth) = all(d->qfrc_passive) - all(d->qfrc_bias) + all(d->qfrc_applied);
  held_bodies_ ? average(tick) : free_bodies_.accelerate(d);
  if (suspect(d->qacc, m->nv)) call_mujoco([m, d] { mj_checkAcc(m, d); });
  all(d->qvel) += dt * all(d->qacc);
  mj_integratePos(m, d->qpos, d->qvel, dt);
  d->time += dt;
  for (std::size_t pad = 0; pad < contacts_.pads(); ++pad) contacts_.pad(pad).commit(m, d);
}

// Computes the accelerations by average_acceleration.h.
void GraspFieldPads::average(std::size_t tick) {
  const mjModel* m = world_.m();
  mjData* d = world_.d();
  std::array<Matrix6d, 2> between{Matrix6d::Zero(), Matrix6d::Zero()};
  Matrix6d ground = Matrix6d::Zero();
  const std::span<const FieldContacts::Contact> contacts = contacts_.all();
  const int held = held_bodies_->held();
  const auto in_held = [&](const FieldContacts::Contact& contact, const Field& field, const Matrix6d& inertia) {
    const Pose surface = contacts_.pad_pose(contact) * field.pad_in_surface().inverse();
    return seen_from(pose_at(d->xpos + 3 * held, d->xmat + 9 * held).inverse() * surface, inertia);
  };
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const FieldContacts::Contact& contact = contacts[i];
    const Field& field = contacts_.field(contact);
    const int pad_body = contacts_.pad_body(contact);
    const bool stands = pad_body == held;  // on a surface that does not move with the held body
    if (tick == 0 || springs_changed(field)) {
      added_[i] = added_inertia(field, contacts_.pad(contact.pad).config().damping, world_.dt());
      if (!stands) added_[i] = in_held(contact, field, added_[i]);
    }
    if (field.touching() == 0) continue;
    if (stands) {
      ground += in_held(contact, field, added_[i]);
    } else {
      between[pad_body == contacts_.finger_bodies()[0] ? 0 : 1] += added_[i];
    }
  }
  held_bodies_->solve(m, d, between, ground, carriages_);
}

WatchSettings GraspFieldPads::watch_settings(const WatchLimits& limits) const {
  return {.limits = held_bodies_ ? averaged(limits) : limits,
          .judge_fields = stored_energy_known_,
          .pads_predicted = held_bodies_.has_value()};
}

double GraspFieldPads::kinetic_energy(const DynamicWorld& world, const Eigen::VectorXd& v, Eigen::VectorXd& /*space*/) const {
  return free_bodies_.kinetic_energy(world.d(), v);
}

}  // namespace slipbench

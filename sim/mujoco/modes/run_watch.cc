#include "sim/mujoco/modes/run_watch.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/pads/pad_kinematics.h"

namespace slipbench {

RunWatch::RunWatch(const DynamicWorld& world, DynamicPads& pads, const WatchLimits& limits)
    : world_(world), pads_(pads), settings_(pads.watch_settings(limits)), energy_(settings_.limits, settings_.judge_fields) {
  const mjModel* m = world_.m();
  const mjData* d = world_.d();
  const int stage = world_.motion() != nullptr ? mj_name2id(m, mjOBJ_BODY, stage_name) : -1;
  for (int body = 1; body < m->nbody; ++body) {
    if (body == stage || m->body_weldid[body] == 0 || pads_.is_part(body)) continue;
    moving_.push_back(body);
    const bool is_free = m->body_jntnum[body] == 1 && m->jnt_type[m->body_jntadr[body]] == mjJNT_FREE;
    // With more bodies in the tree the six coordinates are not this body's alone.
    if (!is_free || m->body_subtreemass[body] != m->body_mass[body]) continue;
    weighed_.push_back({body, m->body_dofadr[body], WeightRule(settings_.limits)});
  }
  const Eigen::Index nv = m->nv;
  mean_ = space_ = pad_force_ = Eigen::VectorXd::Zero(nv);
  before_ = after_ = Eigen::Map<Eigen::VectorXd>(d->qvel, nv);
  note_centres();
}

void RunWatch::begin_step() { before_ = Eigen::Map<const Eigen::VectorXd>(world_.d()->qvel, world_.m()->nv); }
void RunWatch::end_step() { after_ = Eigen::Map<const Eigen::VectorXd>(world_.d()->qvel, world_.m()->nv); }

void RunWatch::note_centres() { centres_.assign(world_.d()->xipos, world_.d()->xipos + 3 * world_.m()->nbody); }

void RunWatch::check_step_from(double time) {
  pads_.find_force(pad_force_);
  check_energy(time, before_);
  weigh(time, before_);
  note_centres();
  note_works();
}

void RunWatch::check_step_to(double time) {
  pads_.find_force(pad_force_);
  note_works();
  check_energy(time, after_);
  weigh(time, after_);
  note_centres();
}

void RunWatch::check_start(double time) {
  end_step();
  pads_.find_force(pad_force_);
  check_energy(time, after_);
  note_centres();
}

// Returns the work of the weights since the last tick [J].
double RunWatch::weight_work() const {
  const mjModel* m = world_.m();
  const mjData* d = world_.d();
  const Eigen::Vector3d pull = world_.gravity();
  double work = 0.0;
  for (const int body : moving_) {
    const MjVector now(d->xipos + 3 * body);
    work += m->body_mass[body] * (1.0 - m->body_gravcomp[body]) *
            pull.dot(now - MjVector(&centres_[3 * static_cast<std::size_t>(body)]));
  }
  return work;
}

// Computes the works of the last step. The work of the pads on the stage waits for the force at
// the step's end: a prescribed motion does not respond to the force at its start, and the
// trapezoidal rule gives the energy that the springs take up.
void RunWatch::note_works() {
  const mjModel* m = world_.m();
  const mjData* d = world_.d();
  const auto force = [m](const mjtNum* values) { return Eigen::Map<const Eigen::VectorXd>(values, m->nv); };
  mean_ = 0.5 * (before_ + force(d->qvel));
  pending_ = {};
  pending_.field_work = world_.dt() * pad_force_.dot(mean_);
  if (world_.motion() != nullptr) {
    stage_force_ = pad_force_.segment<6>(world_.stage_dof());
    stage_way_ = world_.dt() * mean_.segment<6>(world_.stage_dof());
    pending_.field_work -= stage_force_.dot(stage_way_);
  }
  pending_.supply =
      world_.dt() * std::max(0.0, (force(d->qfrc_spring) + force(d->qfrc_actuator) + force(d->qfrc_applied)).dot(mean_));
  pending_.contact_supply = world_.dt() * std::max(0.0, force(d->qfrc_constraint).dot(mean_));
}

void RunWatch::weigh(double time, const Eigen::VectorXd& velocity) {
  const mjModel* m = world_.m();
  const mjData* d = world_.d();
  constexpr double standard_gravity = 9.81;  // m/s2, reference for bodies without weight
  const double dt = world_.dt();
  const Eigen::Vector3d gravity = world_.gravity();
  const double gravity_norm = gravity.isZero(0.0) ? standard_gravity : gravity.norm();
  for (WeighedBody& body : weighed_) {
    const auto linear = [&body](const mjtNum* values) { return MjVector(values + body.dof); };
    const double mass = m->body_mass[body.body];
    const Eigen::Vector3d pads_force = pads_.force_on(body.body, body.dof, pad_force_);
    // The coordinates are those of the body's frame; the acceleration is that of its centre of
    // mass.
    const MjMatrix rotation(d->xmat + 9 * body.body);
    const Eigen::Vector3d arm = MjVector(d->xipos + 3 * body.body) - MjVector(d->xpos + 3 * body.body);
    const auto local = [&body](const Eigen::VectorXd& values) { return values.segment<3>(body.dof + 3); };
    const Eigen::Vector3d spin = rotation * local(velocity), spin_rate = rotation * (local(after_) - local(before_)) / dt;
    const Eigen::Vector3d rate = (after_.segment<3>(body.dof) - before_.segment<3>(body.dof)) / dt;
    const Eigen::Vector3d centripetal = mass * spin.cross(spin.cross(arm));

    const Eigen::Vector3d joints =
        linear(d->qfrc_actuator) + linear(d->qfrc_spring) + linear(d->qfrc_damper) + linear(d->qfrc_fluid);
    const Eigen::Vector3d weight = mass * (1.0 - m->body_gravcomp[body.body]) * gravity;
    WatchedBody now;
    now.weight = mass * gravity_norm;
    now.force = pads_force + joints + linear(d->qfrc_constraint) + linear(d->qfrc_applied) + weight;
    now.predicted = joints - centripetal;
    if (settings_.pads_predicted) now.predicted += pads_force;
    if (settings_.constraints_predicted) now.predicted += linear(d->qfrc_constraint);
    now.mass_times_acceleration = mass * (rate + spin_rate.cross(arm)) + centripetal + linear(m->dof_armature).cwiseProduct(rate);
    if (const auto wrong = body.rule.check(now, dt)) {
      const char* name = mj_id2name(m, mjOBJ_BODY, body.body);
      throw FailedRun(
          fmt::format("the simulation has diverged at {:.6g} s: body '{}': {}", time, name == nullptr ? "" : name, *wrong));
    }
  }
}

// Checks the tick at `time`, when the bodies had the given velocity, after the step that yields its
// truth.
void RunWatch::check_energy(double time, const Eigen::VectorXd& velocity) {
  const mjModel* m = world_.m();
  const mjData* d = world_.d();
  WatchedEnergy now = pending_;
  now.supply += std::max(0.0, weight_work());
  if (world_.motion() != nullptr) {
    const double on_stage = 0.5 * (stage_force_ + pad_force_.segment<6>(world_.stage_dof())).dot(stage_way_);
    now.field_work += on_stage;
    now.supply += std::max(0.0, -on_stage);
  }
  const PadEnergy read = pads_.read_energy();
  now.elastic = read.elastic;
  // The fields' work uses the mean speed of a step, and so must the loss: otherwise a slide that
  // gains dv would seem to deliver mu f_n h dv/2.
  now.slip_loss = 0.5 * (read.slip_loss + std::exchange(last_slip_loss_, read.slip_loss));
  mean_ = velocity;
  if (world_.motion() != nullptr) mean_.segment<6>(world_.stage_dof()).setZero();
  now.kinetic = pads_.kinetic_energy(world_, mean_, space_);
  if (const auto wrong = energy_.check(now, world_.dt())) {
    throw FailedRun(fmt::format("the simulation has diverged at {:.6g} s: {}", time, *wrong));
  }
  for (const int body : moving_) {
    const MjVector centre(d->xipos + 3 * body);
    const double speed = (centre - MjVector(&centres_[3 * static_cast<std::size_t>(body)])).norm() / world_.dt();
    if (const auto wrong = energy_.check_body(0.5 * m->body_mass[body] * speed * speed)) {
      const char* name = mj_id2name(m, mjOBJ_BODY, body);
      throw FailedRun(
          fmt::format("the simulation has diverged at {:.6g} s: body '{}' {}", time, name == nullptr ? "" : name, *wrong));
    }
  }
}

}  // namespace slipbench

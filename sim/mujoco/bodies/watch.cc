#include "sim/mujoco/bodies/watch.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/mujoco/bodies/dynamic_state.h"
#include "sim/mujoco/models/model_builder.h"
#include "sim/mujoco/pads/field_plugin.h"

namespace slipbench {

std::optional<std::string> WeightRule::check(const WatchedBody& body, double dt) {
  // The change that leads to this tick belongs to the step before it or to the one after it: both
  // windows allow for it.
  const double change = (body.predicted - before_).norm();
  before_ = body.predicted;
  variation_ += change;
  std::optional<std::string> wrong;
  if (steps_ > 0 && time_ >= limits_.window) {
    const double missing = missing_.norm() / time_, share = limits_.weight_share * body.weight;
    if (missing > share + variation_ / static_cast<double>(steps_)) {
      wrong = fmt::format(
          "over {1:.3g} s the forces on it differ from its mass times its acceleration by {0:.3g} N; allowed: {2} of its weight of {3:.6g} N",
          missing, time_, limits_.weight_share, body.weight);
    }
    steps_ = 0;
  }
  if (steps_ == 0) {
    missing_.setZero();
    time_ = 0.0;
    variation_ = change;
  }
  missing_ += dt * (body.force - body.mass_times_acceleration);
  time_ += dt;
  ++steps_;
  return wrong;
}

std::optional<std::string> EnergyRule::check(const WatchedEnergy& tick, double dt) {
  if (!started_) {
    started_ = true;
    total_ = available_ = tick.kinetic + tick.elastic;
    elastic_ = tick.elastic;
    return std::nullopt;
  }
  total_ += tick.supply;
  available_ += tick.supply + tick.contact_supply;
  gain_ += tick.field_work + (tick.elastic - elastic_) + tick.slip_loss;
  elastic_ = tick.elastic;
  time_ += dt;
  if (judge_fields_ && gain_ > limits_.energy_share * available_ + limits_.energy_floor) {
    return fmt::format(
        "in the last {1:.3g} s the pads have delivered {0:.3g} J more than they took up; allowed: {3} of the {2:.3g} J that were available",
        gain_, time_, available_, limits_.energy_share);
  }
  if (time_ >= limits_.window) {
    available_ = tick.kinetic + tick.elastic;
    gain_ = time_ = 0.0;
  }
  return std::nullopt;
}

std::optional<std::string> EnergyRule::check_body(double kinetic) const {
  if (kinetic <= limits_.ejection_factor * total_ + limits_.energy_floor) return std::nullopt;
  return fmt::format(
      "has {:.3g} J of kinetic energy, more than the {:.3g} J from the start, weight, motors and stage together: the contact has thrown it out",
      kinetic, total_);
}

// DynamicSimulation's checks of the run (dynamic_simulation.h).

void DynamicSimulation::State::find_watched(const WatchLimits& limits) {
  energy.emplace(limits, judge_fields);
  const int stage = motion ? mj_name2id(m(), mjOBJ_BODY, stage_name) : -1;
  for (int body = 1; body < m()->nbody; ++body) {
    if (body == stage || m()->body_weldid[body] == 0 || is_tip(body)) continue;
    moving.push_back(body);
    const bool is_free = m()->body_jntnum[body] == 1 && m()->jnt_type[m()->body_jntadr[body]] == mjJNT_FREE;
    // With more bodies in the tree the six coordinates are not this body's alone.
    if (!is_free || m()->body_subtreemass[body] != m()->body_mass[body]) continue;
    weighed.push_back({body, m()->body_dofadr[body], WeightRule(limits)});
  }
  const Eigen::Index nv = m()->nv;
  mean = work_space = field_force = Eigen::VectorXd::Zero(nv);
  before = after = Eigen::Map<Eigen::VectorXd>(d()->qvel, nv);
  centres.assign(d()->xipos, d()->xipos + 3 * m()->nbody);
}

// Returns the work of the weights since the last tick [J].
double DynamicSimulation::State::weight_work() {
  const Eigen::Vector3d pull = gravity();
  double work = 0.0;
  for (const int body : moving) {
    const MjVector now(d()->xipos + 3 * body);
    work += m()->body_mass[body] * (1.0 - m()->body_gravcomp[body]) *
            pull.dot(now - MjVector(&centres[3 * static_cast<std::size_t>(body)]));
  }
  return work;
}

// Computes the generalized force of all fields in the last step. For articulated pads it is their
// force on the stage: all their other forces are MuJoCo's springs and contacts.
void DynamicSimulation::State::find_field_force() {
  if (articulated) {
    field_force.setZero();
    if (motion) field_force.segment<6>(stage_dof) = Eigen::Map<const Vector6d>(d()->qfrc_constraint + stage_dof);
    return;
  }
  const auto force = [this](const mjtNum* values) { return Eigen::Map<const Eigen::VectorXd>(values, m()->nv); };
  const auto others = force(d()->qfrc_spring) + force(d()->qfrc_damper) + force(d()->qfrc_gravcomp) + force(d()->qfrc_fluid);
  if (!implicit) {
    field_force = force(d()->qfrc_passive) - others;
    return;
  }
  field_force.setZero();
  pad_group_of(m(), d())->add_applied(m(), d(), field_force.data());
}

// Computes the works of the last step. The work of the fields on the stage waits for the force at
// the step's end: a prescribed motion does not respond to the force at its start, and the
// trapezoidal rule gives the energy that the springs take up.
void DynamicSimulation::State::note_works() {
  const auto force = [this](const mjtNum* values) { return Eigen::Map<const Eigen::VectorXd>(values, m()->nv); };
  mean = 0.5 * (before + force(d()->qvel));
  pending = {};
  pending.field_work = dt * field_force.dot(mean);
  if (motion) {
    stage_force = field_force.segment<6>(stage_dof);
    stage_way = dt * mean.segment<6>(stage_dof);
    pending.field_work -= stage_force.dot(stage_way);
  }
  pending.supply = dt * std::max(0.0, (force(d()->qfrc_spring) + force(d()->qfrc_actuator) + force(d()->qfrc_applied)).dot(mean));
  pending.contact_supply = dt * std::max(0.0, force(d()->qfrc_constraint).dot(mean));
}

void DynamicSimulation::State::weigh(double time, const Eigen::VectorXd& velocity) {
  if (leads && tick == 0) return;            // no step has led here
  constexpr double standard_gravity = 9.81;  // m/s2, reference for bodies without weight
  const bool pads_predicted = averages || leads;
  for (WeighedBody& body : weighed) {
    const auto linear = [&body](const mjtNum* values) { return MjVector(values + body.dof); };
    const double mass = m()->body_mass[body.body];
    Eigen::Vector3d pads_force = Eigen::Vector3d::Zero();
    for (const Contact& contact : contacts) {
      const Pad& pad = pads[contact.pad];
      if (pad.body == body.body) pads_force += contact.on_pad;
      if (contact.object_body == body.body) pads_force -= contact.on_pad;
    }
    if (implicit) pads_force = field_force.segment<3>(body.dof);
    // The coordinates are those of the body's frame; the acceleration is that of its centre of
    // mass.
    const MjMatrix rotation(d()->xmat + 9 * body.body);
    const Eigen::Vector3d arm = MjVector(d()->xipos + 3 * body.body) - MjVector(d()->xpos + 3 * body.body);
    const auto local = [&body](const Eigen::VectorXd& values) { return values.segment<3>(body.dof + 3); };
    const Eigen::Vector3d spin = rotation * local(velocity), spin_rate = rotation * (local(after) - local(before)) / dt;
    const Eigen::Vector3d rate = (after.segment<3>(body.dof) - before.segment<3>(body.dof)) / dt;
    const Eigen::Vector3d centripetal = mass * spin.cross(spin.cross(arm));

    const Eigen::Vector3d joints =
        linear(d()->qfrc_actuator) + linear(d()->qfrc_spring) + linear(d()->qfrc_damper) + linear(d()->qfrc_fluid);
    const Eigen::Vector3d weight = mass * (1.0 - m()->body_gravcomp[body.body]) * gravity();
    WatchedBody now;
    now.weight = mass * (gravity().isZero(0.0) ? standard_gravity : gravity().norm());
    now.force = pads_force + joints + linear(d()->qfrc_constraint) + linear(d()->qfrc_applied) + weight;
    now.predicted = joints - centripetal;
    if (pads_predicted) now.predicted += pads_force;
    // With impratio 1e4 together with implicit pads MuJoCo's solver leaves a residual that changes
    // its sign from step to step.
    if (leads || implicit) now.predicted += linear(d()->qfrc_constraint);
    now.mass_times_acceleration =
        mass * (rate + spin_rate.cross(arm)) + centripetal + linear(m()->dof_armature).cwiseProduct(rate);
    if (const auto wrong = body.rule.check(now, dt)) {
      const char* name = mj_id2name(m(), mjOBJ_BODY, body.body);
      throw FailedRun(
          fmt::format("the simulation has diverged at {:.6g} s: body '{}': {}", time, name == nullptr ? "" : name, *wrong));
    }
  }
}

// Checks the tick at `time`, when the bodies had the given velocity, after the step that yields its
// truth.
void DynamicSimulation::State::watch(double time, const Eigen::VectorXd& velocity) {
  WatchedEnergy now = pending;
  now.supply += std::max(0.0, weight_work());
  if (motion) {
    const double on_stage = 0.5 * (stage_force + field_force.segment<6>(stage_dof)).dot(stage_way);
    now.field_work += on_stage;
    now.supply += std::max(0.0, -on_stage);
  }
  double slip_loss = 0.0;  // with the speed at the end of the step
  for (Contact& contact : contacts) {
    const Pad& pad = pads[contact.pad];
    const Field& field = pad.instance->fields()[contact.field];
    const kernel::SpringSums sums = field.spring_sums();
    if (!implicit) {  // otherwise its force is the solver's
      const double damping = pad.instance->config().damping;
      // RK4 has been through other stages since the tick.
      const Wrench damped =
          leads ? field.damped_wrench_on_pad(pad.instance->motion(contact.field), damping) : pad.instance->applied(contact.field);
      contact.on_pad = pad_pose(pad).rotation * (field.pad_in_surface().rotation.transpose() * damped.force);
    }
    now.elastic += sums.elastic;
    slip_loss += sums.slip_loss;
  }
  // The fields' work uses the mean speed of a step, and so must the loss: otherwise a slide that
  // gains dv would seem to deliver mu f_n h dv/2.
  now.slip_loss = 0.5 * (slip_loss + std::exchange(last_slip_loss, slip_loss));
  mean = velocity;
  if (motion) mean.segment<6>(stage_dof).setZero();
  if (free_bodies) {
    now.kinetic = free_bodies->kinetic_energy(d(), mean);
  } else {
    mj_mulM(m(), d(), work_space.data(), mean.data());
    now.kinetic = 0.5 * mean.dot(work_space);
  }
  if (const auto wrong = energy->check(now, dt)) {
    throw FailedRun(fmt::format("the simulation has diverged at {:.6g} s: {}", time, *wrong));
  }
  for (const int body : moving) {
    const MjVector centre(d()->xipos + 3 * body);
    const double speed = (centre - MjVector(&centres[3 * static_cast<std::size_t>(body)])).norm() / dt;
    if (const auto wrong = energy->check_body(0.5 * m()->body_mass[body] * speed * speed)) {
      const char* name = mj_id2name(m(), mjOBJ_BODY, body);
      throw FailedRun(
          fmt::format("the simulation has diverged at {:.6g} s: body '{}' {}", time, name == nullptr ? "" : name, *wrong));
    }
  }
  weigh(time, velocity);
  centres.assign(d()->xipos, d()->xipos + 3 * m()->nbody);
}

void DynamicSimulation::State::watch_step(double time, const Eigen::VectorXd& velocity) {
  find_field_force();
  if (leads && tick > 0) note_works();
  watch(time, velocity);
  if (!leads) note_works();
}

}  // namespace slipbench

#include "sim/mujoco/modes/free_bodies.h"

#include <stdexcept>

#include <mujoco/mujoco.h>
#include <Eigen/Geometry>

namespace slipbench {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

auto matrix_at(mjtNum* at) { return Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(at); }
auto vector_at(mjtNum* at) { return Eigen::Map<Vector3d>(at); }
auto vector_at(const mjtNum* at) { return Eigen::Map<const Vector3d>(at); }

Pose pose_of(const mjtNum* position, const mjtNum* quat) {
  mjtNum turn[9];
  mju_quat2Mat(turn, quat);
  return {matrix_at(turn), vector_at(position)};
}

void put(const Pose& pose, mjtNum* position, mjtNum* rotation) {
  vector_at(position) = pose.position;
  matrix_at(rotation) = pose.rotation;
}

}  // namespace

FreeBodies::FreeBodies(const mjModel* m) {
  const auto none = [m](const mjtNum* of_dofs) { return mju_norm(of_dofs, static_cast<int>(m->nv)) == 0.0; };
  if (m->nu + m->ntendon + m->nflex + m->nsensor > 0 || (m->opt.disableflags & mjDSBL_CONSTRAINT) == 0 ||
      !none(m->dof_armature) || !none(m->dof_damping)) {
    throw std::logic_error("FreeBodies: more than passive forces");
  }
  for (int body = 1; body < m->nbody; ++body) {
    if (m->body_weldid[body] == 0) continue;
    const int joint = m->body_jntadr[body];
    if (m->body_jntnum[body] != 1 || m->jnt_type[joint] != mjJNT_FREE || m->body_subtreemass[body] != m->body_mass[body]) {
      throw std::logic_error("FreeBodies: a body that is not free and alone");
    }
    Body& added = bodies_.emplace_back();
    added.body = body;
    added.joint = joint;
    added.qpos = m->jnt_qposadr[joint];
    added.dof = m->body_dofadr[body];
    added.mass = m->body_mass[body];
    added.centre = pose_of(m->body_ipos + 3 * body, m->body_iquat + 4 * body);
    const Vector3d principal = vector_at(m->body_inertia + 3 * body);
    added.inertia = added.centre.rotation * principal.asDiagonal() * added.centre.rotation.transpose();
    added.yielding = added.inertia.inverse();
    for (int k = 0; k < m->body_geomnum[body]; ++k) {
      const int geom = m->body_geomadr[body] + k;
      added.geoms.push_back({geom, pose_of(m->geom_pos + 3 * geom, m->geom_quat + 4 * geom)});
    }
    for (int site = 0; site < m->nsite; ++site) {
      if (m->site_bodyid[site] == body) added.sites.push_back({site, pose_of(m->site_pos + 3 * site, m->site_quat + 4 * site)});
    }
  }
}

// Flattened: otherwise the rest of the unity build decides whether the compiler inlines the
// products of poses, 1.8 % of a lift's instructions.
[[gnu::flatten]] void FreeBodies::place(const mjModel* m, mjData* d) const {
  const bool weightless = (m->opt.disableflags & mjDSBL_GRAVITY) != 0;
  const Vector3d gravity = weightless ? Vector3d::Zero() : Vector3d(m->opt.gravity[0], m->opt.gravity[1], m->opt.gravity[2]);
  for (const Body& body : bodies_) {
    mjtNum* quat = d->xquat + 4 * body.body;
    mju_copy4(quat, d->qpos + body.qpos + 3);
    mju_normalize4(quat);
    const Pose frame = pose_of(d->qpos + body.qpos, quat);
    put(frame, d->xpos + 3 * body.body, d->xmat + 9 * body.body);
    vector_at(d->xanchor + 3 * body.joint) = frame.position;
    const Pose centre = frame * body.centre;
    put(centre, d->xipos + 3 * body.body, d->ximat + 9 * body.body);
    vector_at(d->subtree_com + 3 * body.body) = centre.position;
    for (const Fixed& geom : body.geoms) put(frame * geom.pose, d->geom_xpos + 3 * geom.id, d->geom_xmat + 9 * geom.id);
    for (const Fixed& site : body.sites) put(frame * site.pose, d->site_xpos + 3 * site.id, d->site_xmat + 9 * site.id);

    // A free joint's translations are in the world, its rotations in the body's own frame; all
    // refer to the centre of mass.
    const Vector3d arm = centre.position - frame.position;
    mjtNum* axes = d->cdof + 6 * body.dof;
    mju_zero(axes, 18);
    for (int k = 0; k < 3; ++k) {
      axes[6 * k + 3 + k] = 1.0;
      const Vector3d axis = frame.rotation.col(k);
      vector_at(axes + 6 * (3 + k)) = axis;
      vector_at(axes + 6 * (3 + k) + 3) = axis.cross(arm);
    }
    const Vector3d turning = vector_at(d->qvel + body.dof + 3), spin = frame.rotation * turning;
    vector_at(d->cvel + 6 * body.body) = spin;
    vector_at(d->cvel + 6 * body.body + 3) = vector_at(d->qvel + body.dof) + spin.cross(arm);

    // The force [N] and torque [N m] that keep the joint's velocities constant: m (w x (w x r) - g)
    // at the centre of mass, which is at r from the frame's origin, and w x I w about it.
    const Vector3d force = body.mass * (spin.cross(spin.cross(arm)) - gravity);
    vector_at(d->qfrc_bias + body.dof) = force;
    vector_at(d->qfrc_bias + body.dof + 3) =
        frame.rotation.transpose() * arm.cross(force) + turning.cross(body.inertia * turning);
  }
}

// With f at the frame's origin and the torque t about it, in the body's axes: about the centre of
// mass, at the lever r, the torque is t - r x f.
void FreeBodies::accelerate(mjData* d) const {
  for (const Body& body : bodies_) {
    const Eigen::Matrix3d rotation = matrix_at(d->xmat + 9 * body.body);
    const Vector3d force = vector_at(d->qfrc_smooth + body.dof), own_force = rotation.transpose() * force;
    const Vector3d torque = vector_at(d->qfrc_smooth + body.dof + 3) - body.centre.position.cross(own_force);
    const Vector3d turning = body.yielding * torque;
    vector_at(d->qacc + body.dof) = force / body.mass - rotation * turning.cross(body.centre.position);
    vector_at(d->qacc + body.dof + 3) = turning;
  }
}

void FreeBodies::factor(const mjModel* m, mjData* d) {
  mj_comPos(m, d);
  mj_makeM(m, d);
  mj_factorM(m, d);
}

double FreeBodies::kinetic_energy(const mjData* d, const Eigen::VectorXd& v) const {
  double twice = 0.0;
  for (const Body& body : bodies_) {
    const Vector3d arm = vector_at(d->xipos + 3 * body.body) - vector_at(d->xpos + 3 * body.body);
    const Vector3d turning = v.segment<3>(body.dof + 3), spin = matrix_at(d->xmat + 9 * body.body) * turning;
    const Vector3d moving = v.segment<3>(body.dof) + spin.cross(arm);
    twice += body.mass * moving.squaredNorm() + turning.dot(body.inertia * turning);
  }
  return 0.5 * twice;
}

}  // namespace slipbench

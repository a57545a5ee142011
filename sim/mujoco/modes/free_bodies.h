// mj_step for bodies that are free and without children, omitting results that are not used:
// MuJoCo's own takes four times as long for three of them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/core/pose.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

// All moving bodies of a model.
class FreeBodies {
 public:
  // Throws std::logic_error if one of them is not free and without children, or if other forces
  // than passive ones and d->qfrc_applied may act on it. Ignores d->xfrc_applied.
  explicit FreeBodies(const mjModel_* m);

  // Computes the results of mj_kinematics, mj_comPos, mj_comVel and mj_rne from d->qpos and d->qvel
  // by Newton's and Euler's equations of a rigid body: frames of bodies, inertia, geoms and
  // sites; of the quaternions only xquat; subtree_com except the world's; cdof, cvel, qfrc_bias.
  // All else stays unchanged, the mass matrix included.
  void place(const mjModel_* m, mjData_* d) const;

  // After place(): computes d->qacc from d->qfrc_smooth.
  void accelerate(mjData_* d) const;

  // After place(): computes MuJoCo's mass matrix and its factor, for mj_solveM and the like.
  static void factor(const mjModel_* m, mjData_* d);

  // Returns the kinetic energy [J] at the poses of place(), with the generalized velocities `v`
  // [nv].
  [[nodiscard]] double kinetic_energy(const mjData_* d, const Eigen::VectorXd& v) const;

 private:
  // A geom's or a site's frame in its body.
  struct Fixed {
    int id;
    Pose pose;
  };
  struct Body {
    int body, joint, qpos, dof;
    double mass;               // kg
    Pose centre;               // frame of the inertia, in the body's own
    Eigen::Matrix3d inertia;   // kg m2, about the centre of mass, along the body's axes
    Eigen::Matrix3d yielding;  // 1/(kg m2), its inverse
    std::vector<Fixed> geoms, sites;
  };

  std::vector<Body> bodies_;
};

}  // namespace slipbench

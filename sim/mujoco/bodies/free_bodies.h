// What mj_step does for bodies that are free and alone, without what nobody reads of it: MuJoCo's own takes four times as long for three of them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/core/pose.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

// All bodies of a model that move.
class FreeBodies {
 public:
  // Throws std::logic_error where one of them is not free and alone, or where more than passive forces and d->qfrc_applied may act on it.
  // d->xfrc_applied is not looked at.
  explicit FreeBodies(const mjModel_* m);

  // What mj_kinematics, mj_comPos, mj_comVel and mj_rne make of d->qpos and d->qvel, by Newton's and Euler's equations of a rigid body: frames of
  // bodies, inertia, geoms and sites; of quaternions xquat alone; subtree_com, but the world's; cdof, cvel, qfrc_bias. All else stays as
  // it is, the mass matrix too.
  void place(const mjModel_* m, mjData_* d) const;

  // After place(): from d->qfrc_smooth to d->qacc.
  void accelerate(mjData_* d) const;

  // After place(): MuJoCo's mass matrix and its factor, for mj_solveM and the like.
  static void factor(const mjModel_* m, mjData_* d);

  // J, at the poses of place(), with the generalized velocities `v` [nv].
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
    Pose centre;               // the frame of the inertia, in the body's own
    Eigen::Matrix3d inertia;   // kg m2, about the centre of mass, along the body's axes
    Eigen::Matrix3d yielding;  // 1/(kg m2), its inverse
    std::vector<Fixed> geoms, sites;
  };

  std::vector<Body> bodies_;
};

}  // namespace slipbench

#include "sim/mujoco/models/gripper_model.h"

#include <algorithm>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Geometry>

#include "sim/core/math/rotation.h"

namespace slipbench {
namespace {

// For display only: without contact and mass.
void add_plate(mjsBody* finger, const std::vector<double>& pad_size, double pivot) {
  constexpr double thickness = 8e-3;  // m, of the 2F-85's pad (mujoco_menagerie)
  mjsGeom* plate = mjs_addGeom(finger, nullptr);
  plate->type = mjGEOM_BOX;
  plate->contype = plate->conaffinity = 0;
  plate->pos[0] = -0.5 * thickness;
  plate->pos[2] = -pivot;
  plate->size[0] = 0.5 * thickness;
  plate->size[1] = 0.5 * pad_size[0];
  plate->size[2] = 0.5 * pad_size[1];
}

void copy_turn(const Eigen::Quaterniond& turn, double* quat) {
  quat[0] = turn.w();
  for (int k = 0; k < 3; ++k) quat[1 + k] = turn.vec()[k];
}

}  // namespace

Pose carriage_in_arm(const Hand& hand, std::size_t finger, double opening) {
  Eigen::Matrix3d rotation = rotation_by_axes({0.0, hand.pitch, hand.yaw});
  if (finger == 1) rotation.leftCols<2>() *= -1.0;  // half a turn about the hand's Z
  return {rotation, rotation * Eigen::Vector3d(-0.5 * opening, 0.0, hand.grip.number("pivot"))};
}

void add_fingers(mjsBody* world, const Hand& hand) {
  const Parameters& grip = hand.grip;
  for (std::size_t k = 0; k < finger_names.size(); ++k) {
    const Pose place = carriage_in_arm(hand, k, hand.opening);
    mjsBody* finger = mjs_addBody(world, nullptr);
    mjs_setName(finger->element, finger_names[k].body);
    mjs_addFreeJoint(finger);
    mju_copy3(finger->pos, place.position.data());
    copy_turn(Eigen::Quaterniond(place.rotation), finger->quat);
    finger->explicitinertial = 1;
    finger->mass = grip.number("finger_mass");
    mju_zero3(finger->ipos);  // MuJoCo's own default is not zero
    std::fill_n(finger->inertia, 3, grip.number("finger_inertia"));
    add_plate(finger, grip.vector("pad_size"), grip.number("pivot"));

    Eigen::Matrix3d pad;
    pad << 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0;  // columns: X, Y, Z of the pad frame
    mjsSite* site = mjs_addSite(finger, nullptr);
    mjs_setName(site->element, finger_names[k].site);
    site->pos[2] = -grip.number("pivot");
    copy_turn(Eigen::Quaterniond(pad), site->quat);
  }
}

}  // namespace slipbench

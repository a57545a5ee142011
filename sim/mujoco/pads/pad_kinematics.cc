#include "sim/mujoco/pads/pad_kinematics.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "sim/contact/surface/thickness.h"
#include "sim/core/error.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_field.h"
#include "sim/mujoco/pads/plugin_state.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

constexpr double far_enough = 1e-5;  // m, more than the rounding of positions

bool same(const Pose& a, const Pose& b) { return a.position == b.position && a.rotation == b.rotation; }
bool same(const Twist& a, const Twist& b) { return a.linear == b.linear && a.angular == b.angular; }

// Returns the velocity in the world of a frame of body `body` at `point`, like mj_objectVelocity.
// cvel, rotation first, is that of the reference point of the body's tree.
Twist velocity_of(ModelView model, DataView data, int body, const double* point) {
  const MjVector angular(data.cvel() + 6 * body), linear(data.cvel() + 6 * body + 3);
  const Eigen::Vector3d arm = MjVector(point) - MjVector(data.subtree_com() + 3 * model.body_rootid()[body]);
  return {linear - arm.cross(angular), angular};
}

// Adds a force and a torque at `point` of a body to qfrc_passive, like mj_applyFT, but only along
// the body's own degrees of freedom; a body fixed to the world has none.
void push(ModelView model, DataView data, const Eigen::Vector3d& force, const Eigen::Vector3d& torque, const double* point,
          int body) {
  const int moving = model.body_weldid()[body];
  if (moving == 0) return;
  const Eigen::Vector3d arm = MjVector(point) - MjVector(data.subtree_com() + 3 * model.body_rootid()[body]);
  Eigen::Matrix<double, 6, 1> wrench;  // rotation first, about cdof's reference point
  wrench << torque + arm.cross(force), force;
  for (int dof = model.body_dofadr()[moving] + model.body_dofnum()[moving] - 1; dof >= 0; dof = model.dof_parentid()[dof]) {
    data.qfrc_passive()[dof] += Eigen::Map<const Eigen::Matrix<double, 6, 1>>(data.cdof() + 6 * dof).dot(wrench);
  }
}

// Velocity that the relative acceleration in the solver's memory of contact k adds in a second:
// translation before rotation.
const double* gained(std::span<const double> memory, std::size_t k) {
  return memory.data() + ImplicitFields::memory_per_contact * k;
}

double* store_pose(const double* position, const double* rotation, double* to) {
  return std::copy_n(rotation, 9, std::copy_n(position, 3, to));
}

}  // namespace

PadKinematics::PadKinematics(ModelView model, const PadConfig& config, const PadLayout& layout)
    : site_(config.site), watch_(layout) {
  for (const int geom : config.geoms) touched_.push_back(touched_geom(model, geom));
  constexpr std::size_t values_of_a_frame = 21;
  located_.resize(values_of_a_frame * (1 + touched_.size()));
  present_.resize(located_.size());
  for (const TouchedGeom& touched : touched_) {
    if (model.body_weldid()[touched.body] == model.body_weldid()[pad_body(model)]) {
      throw InputError(fmt::format("plugin '{}': the touched geom '{}' moves with the pad; name a geom of another body",
                                   config.name, name_of_geom(model, touched.geom)));
    }
  }
}

TouchedGeom PadKinematics::touched_geom(ModelView model, int geom) const {
  const GeomSurface surface = surface_of_geom(model, geom);
  const double ball = ball_around(surface.shape);
  return {geom,
          model.geom_bodyid()[geom],
          shape_values(model, geom),
          surface.in_geom,
          surface.shape,
          watch_,
          std::isfinite(ball) ? ball + watch_.radius() + far_enough : 0.0};
}

bool PadKinematics::update_shapes(ModelView model) {
  bool changed = false;
  for (TouchedGeom& touched : touched_) {
    if (touched.values == shape_values(model, touched.geom)) continue;
    touched = touched_geom(model, touched.geom);
    changed = true;
  }
  if (!changed) return false;
  std::ranges::fill(located_, std::numeric_limits<double>::quiet_NaN());  // of no pose: the next locate() computes all
  clear_.reset();
  return true;
}

// True if poses and velocities are those of the last call. Cheaper than recomputing the same
// results.
bool PadKinematics::is_unmoved(ModelView model, DataView data) {
  double* out = present_.data();
  const auto copy_frame = [&](const double* position, const double* rotation, int body) {
    out = std::copy_n(position, 3, out);
    out = std::copy_n(rotation, 9, out);
    out = std::copy_n(data.cvel() + 6 * body, 6, out);
    // cvel's reference point
    out = std::copy_n(data.subtree_com() + 3 * model.body_rootid()[body], 3, out);
  };
  copy_frame(data.site_xpos() + 3 * site_, data.site_xmat() + 9 * site_, pad_body(model));
  for (const TouchedGeom& touched : touched_) {
    copy_frame(data.geom_xpos() + 3 * touched.geom, data.geom_xmat() + 9 * touched.geom, touched.body);
  }
  if (std::memcmp(present_.data(), located_.data(), present_.size() * sizeof(double)) == 0) return true;
  located_.swap(present_);
  return false;
}

bool PadKinematics::locate(ModelView model, DataView data, bool always) {
  if (!always && is_unmoved(model, data)) return true;
  clear_.reset();
  bool unmoved = true;
  const Pose pad = pad_pose(data);
  const Twist pad_motion = velocity_of(model, data, pad_body(model), data.site_xpos() + 3 * site_);
  for (TouchedGeom& touched : touched_) {
    const Pose geom = pose_at(data.geom_xpos() + 3 * touched.geom, data.geom_xmat() + 9 * touched.geom);
    const Pose world_in_surface = (geom * touched.surface_in_geom).inverse();
    const Pose pad_in_surface = world_in_surface * pad;
    const Twist geom_motion = velocity_of(model, data, touched.body, data.geom_xpos() + 3 * touched.geom);
    const Eigen::Vector3d spin = pad_motion.angular - geom_motion.angular;
    const Eigen::Vector3d carried = geom_motion.linear + geom_motion.angular.cross(pad.position - geom.position);
    const Twist motion{world_in_surface.rotation * (pad_motion.linear - carried), world_in_surface.rotation * spin};
    unmoved = unmoved && same(pad_in_surface, touched.pad_in_surface) && same(motion, touched.motion);
    touched.pad_in_surface = pad_in_surface;
    touched.motion = motion;
  }
  return unmoved;
}

bool PadKinematics::is_far(DataView data) const {
  const MjVector pad(data.site_xpos() + 3 * site_);
  return std::ranges::all_of(touched_, [&](const TouchedGeom& touched) {
    return touched.reach > 0.0 &&
           (pad - MjVector(data.geom_xpos() + 3 * touched.geom)).squaredNorm() > touched.reach * touched.reach;
  });
}

bool PadKinematics::is_clear() {
  if (!clear_) {
    clear_ = std::ranges::all_of(touched_, [](const TouchedGeom& touched) {
      return touched.watch.clearance(touched.shape, touched.pad_in_surface) > 0.0;
    });
  }
  return *clear_;
}

bool PadKinematics::stays_far(ModelView model, DataView data, std::span<const double> memory, double step) const {
  const MjVector pad(data.site_xpos() + 3 * site_);
  const Eigen::Vector3d motion = velocity_of(model, data, pad_body(model), pad.data()).linear;
  for (std::size_t k = 0; k < touched_.size(); ++k) {
    const Eigen::Vector3d speed = motion - velocity_of(model, data, touched_[k].body, pad.data()).linear;
    const double way = step * (speed.norm() + step * MjVector(gained(memory, k)).norm()), apart = touched_[k].reach + way;
    if (!(touched_[k].reach > 0.0)) return false;
    if (!((pad - MjVector(data.geom_xpos() + 3 * touched_[k].geom)).squaredNorm() > apart * apart)) return false;
  }
  return true;
}

bool PadKinematics::stays_clear(std::span<const double> memory, double step) const {
  for (std::size_t k = 0; k < touched_.size(); ++k) {
    const TouchedGeom& touched = touched_[k];
    const double radius = touched.watch.radius();
    const double speed = touched.motion.linear.norm() + touched.motion.angular.norm() * radius +
                         step * (MjVector(gained(memory, k)).norm() + MjVector(gained(memory, k) + 3).norm() * radius);
    if (!(touched.watch.clearance(touched.shape, touched.pad_in_surface) > step * speed)) return false;
  }
  return true;
}

std::string PadKinematics::site_mistake(ModelView model, std::span<const Field> fields, bool placed) {
  std::size_t touching = 0;  // on any geom: one may lie beside another
  for (const Field& field : fields) touching += field.touching();
  std::string first;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    TouchedGeom& touched = touched_[k];
    const auto mistake = [&](const std::string& where, const std::string& what) {
      if (!first.empty()) return;
      first = fmt::format("tips of the pad at site '{}' are {} the touched geom '{}'{}", model.name_of(mj::site, site_), where,
                          name_of_geom(model, touched.geom), what);
    };
    if (touched.watch.points_outwards(touched.shape, touched.pad_in_surface, touching)) {
      mistake(
          "inside",
          " and point out of it: the site points the wrong way or lies inside; its +Z must point from the touched object into the pad");
    }
    if (placed || fields[k].touching() == 0) continue;
    double deepest = 0.0;
    for (std::size_t i = 0; i < fields[k].size(); ++i) deepest = std::max(deepest, fields[k].penetration(i));
    if (deepest > touched.watch.deepest_start()) {
      mistake(fmt::format("{:.3g} mm inside", 1e3 * deepest),
              fmt::format(" at the start; allowed: up to {:.3g} mm", 1e3 * touched.watch.deepest_start()));
    }
  }
  return first;
}

void PadKinematics::apply(ModelView model, DataView data, std::size_t k, const Wrench& wrench) const {
  const TouchedGeom& touched = touched_[k];
  const double* origin = data.site_xpos() + 3 * site_;
  const Eigen::Matrix3d surface = MjMatrix(data.geom_xmat() + 9 * touched.geom) * touched.surface_in_geom.rotation;
  const Eigen::Vector3d force = surface * wrench.force, torque = surface * wrench.torque;
  const Eigen::Vector3d back_force = -force, back_torque = -torque;
  push(model, data, force, torque, origin, pad_body(model));
  push(model, data, back_force, back_torque, origin, touched.body);
}

void PadKinematics::store_poses(DataView data, std::span<double> poses) const {
  double* to = store_pose(data.site_xpos() + 3 * site_, data.site_xmat() + 9 * site_, poses.data());
  for (const TouchedGeom& touched : touched_)
    to = store_pose(data.geom_xpos() + 3 * touched.geom, data.geom_xmat() + 9 * touched.geom, to);
}

Pose PadKinematics::stored_pad_in_surface(std::span<const double> poses, std::size_t k) const {
  const double* pad = poses.data();
  const double* geom = pad + PluginStateLayout::pose_size * (1 + k);
  return (pose_at(geom, geom + 3) * touched_[k].surface_in_geom).inverse() * pose_at(pad, pad + 3);
}

Pose PadKinematics::pad_pose(DataView data) const { return pose_at(data.site_xpos() + 3 * site_, data.site_xmat() + 9 * site_); }

Pose PadKinematics::surface_pose(DataView data, std::size_t k) const {
  const TouchedGeom& touched = touched_[k];
  return pose_at(data.geom_xpos() + 3 * touched.geom, data.geom_xmat() + 9 * touched.geom) * touched.surface_in_geom;
}

}  // namespace slipbench

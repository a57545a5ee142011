#include "sim/mujoco/modes/field_contacts.h"

#include <algorithm>
#include <variant>

#include "sim/mujoco/models/gripper_model.h"
#include "sim/mujoco/pads/field_plugin.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/mujoco/pads/pad_kinematics.h"

namespace slipbench {
namespace {

// Returns the springs of a pad for stability: those of the sensor, or those of an elastic skin as a
// whole.
const PadLayout& springs_of(const Field& field, const PadLayout& sensor) { return field.has_skin() ? field.layout() : sensor; }

}  // namespace

FieldContacts::FieldContacts(const DynamicWorld& world, const DynamicSetup& setup)
    : world_(world), layouts_(setup.layouts.begin(), setup.layouts.end()) {
  const mjModel* m = world.m();
  if (setup.options.hand != nullptr) {
    spring_ = finger_spring(setup.options.hand->grip);
    for (const FingerNames& finger : finger_names) fingers_.push_back(mj_name2id(m, mjOBJ_BODY, finger.body));
  }
  // the simulation checks the step itself, before the first one
  pad_group_of(m, world.d())->allow_long_steps();
  for (std::size_t i = 0; i < setup.scene.sensors.size(); ++i) {
    const int instance = mj_name2id(m, mjOBJ_PLUGIN, setup.scene.sensors[i].name.c_str());
    PadInstance* pad = pad_of(m, world.d(), instance);
    const int site = pad->config().site;
    if (i < setup.read) pad->watch();
    pads_.push_back({pad, site, m->site_bodyid[site]});
    for (std::size_t k = 0; k < pad->config().geoms.size(); ++k) {
      contacts_.push_back({i, k, m->geom_bodyid[pad->config().geoms[k]]});
    }
  }
}

std::vector<int> FieldContacts::sites() const {
  std::vector<int> result;
  for (const Pad& pad : pads_) result.push_back(pad.site);
  return result;
}

std::size_t FieldContacts::touching() const {
  std::size_t result = 0;
  for (const Contact& contact : contacts_) result += field(contact).touching();
  return result;
}

double FieldContacts::normal_force(std::size_t pad) const {
  double force = 0.0;
  for (const Field& field : pads_[pad].instance->fields()) {
    for (const double f_normal : std::span(field.columns().f_normal, field.size())) force += std::max(0.0, f_normal);
  }
  return force;
}

PadTangents FieldContacts::stuck(bool touching_only) const {
  const mjModel* m = world_.m();
  const mjData* d = world_.d();
  PadTangents stuck;
  for (const Contact& contact : contacts_) {
    const Pad& pad = pads_[contact.pad];
    const Field& field = pad.instance->fields()[contact.field];
    Pose pose = pad_pose(contact);
    PadLayout layout;
    const PadLayout& springs = springs_of(field, *layouts_[contact.pad]);
    if (!touching_only) {
      layout = springs;
      const int geom = pad.instance->config().geoms[contact.field];
      const GeomSurface surface = surface_of_geom(m, geom);
      const Pose placed = pose_at(d->geom_xpos + 3 * geom, d->geom_xmat + 9 * geom) * surface.in_geom;
      const Eigen::Vector3d origin = placed.inverse() * pose.position,
                            axis = -(placed.rotation.transpose() * pose.rotation.col(2));
      const SurfacePoint met = std::visit(
          [&](const auto& shape) { return shape.at(origin.x(), origin.y(), origin.z(), axis.x(), axis.y(), axis.z()); },
          surface.shape);
      if (met.gap > 0.0) pose.position -= met.gap * (placed.rotation * Eigen::Vector3d(met.nx, met.ny, met.nz));
    } else {
      for (std::size_t i = 0; i < field.size(); ++i) {
        if (field.bears(i)) layout.elements.push_back(springs.elements[i]);
      }
    }
    stuck.bodies.push_back({pad.body, contact.object_body, pose.position});
    stuck.tangents.push_back(stuck_tangent(layout, pose, pose.position, pad.instance->config().damping));
  }
  if (spring_) {
    for (const int body : fingers_) {
      stuck.bodies.push_back({body, 0, MjVector(d->xpos + 3 * body)});
      stuck.tangents.push_back(spring_->tangent(MjMatrix(d->xmat + 9 * body)));
    }
  }
  return stuck;
}

std::vector<ImplicitPad> FieldContacts::implicit_pads() const {
  std::vector<ImplicitPad> result;
  for (const Contact& contact : contacts_) {
    const int body = pads_[contact.pad].body;
    const Pose placed = pose_at(world_.d()->xpos + 3 * body, world_.d()->xmat + 9 * body);
    result.push_back({body, contact.object_body, placed.inverse() * pad_pose(contact), layouts_[contact.pad]});
  }
  return result;
}

PadEnergy FieldContacts::spring_energy() const {
  PadEnergy energy;
  for (const Contact& contact : contacts_) {
    const kernel::SpringSums sums = field(contact).spring_sums();
    energy.elastic += sums.elastic;
    energy.slip_loss += sums.slip_loss;
  }
  return energy;
}

Eigen::Vector3d FieldContacts::force_on(int body) const {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const Contact& contact : contacts_) {
    if (pads_[contact.pad].body == body) force += contact.on_pad;
    if (contact.object_body == body) force -= contact.on_pad;
  }
  return force;
}

void FieldContacts::find_passive_force(Eigen::VectorXd& force) const {
  const mjData* d = world_.d();
  const auto all = [this](const mjtNum* values) { return Eigen::Map<const Eigen::VectorXd>(values, world_.m()->nv); };
  const auto others = all(d->qfrc_spring) + all(d->qfrc_damper) + all(d->qfrc_gravcomp) + all(d->qfrc_fluid);
  force = all(d->qfrc_passive) - others;
}

}  // namespace slipbench

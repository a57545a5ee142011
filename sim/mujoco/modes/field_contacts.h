// Pads that are fields, and the geoms that they touch.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/core/pose.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/modes/dynamic_pads.h"
#include "sim/mujoco/modes/dynamic_setup.h"
#include "sim/mujoco/modes/dynamic_world.h"
#include "sim/mujoco/modes/finger_spring.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_instance.h"
#include "sim/mujoco/pads/pad_kinematics.h"

namespace slipbench {

class FieldContacts {
 public:
  // A field and the geom that it touches.
  struct Contact {
    std::size_t pad;
    std::size_t field;  // of the pad
    int object_body;
    // N, of the elements' springs and dashpots, in the world, at the tick last read
    Eigen::Vector3d on_pad = Eigen::Vector3d::Zero();
  };

  // The model's pads in the scene's order. The world's data, which must not be made anew, and the
  // layouts must outlive the object.
  FieldContacts(const DynamicWorld& world, const DynamicSetup& setup);

  [[nodiscard]] std::size_t pads() const { return pads_.size(); }
  [[nodiscard]] PadInstance& pad(std::size_t pad) const { return *pads_[pad].instance; }
  [[nodiscard]] int pad_body(const Contact& contact) const { return pads_[contact.pad].body; }
  [[nodiscard]] Pose pad_pose(const Contact& contact) const {
    const int site = pads_[contact.pad].site;
    return pose_at(world_.d()->site_xpos + 3 * site, world_.d()->site_xmat + 9 * site);
  }
  [[nodiscard]] std::span<const Contact> all() const { return contacts_; }
  [[nodiscard]] const Field& field(const Contact& contact) const { return pad(contact.pad).fields()[contact.field]; }
  [[nodiscard]] std::vector<int> sites() const;
  // The bodies of the fingers; empty without a grasp.
  [[nodiscard]] std::span<const int> finger_bodies() const { return fingers_; }

  // Returns the number of touching elements.
  [[nodiscard]] std::size_t touching() const;
  [[nodiscard]] double normal_force(std::size_t pad) const;  // N
  // Returns the tangents of all pads with every element stuck, which is their greatest stiffness.
  // Each tangent is taken at the point where a separated pad would touch the object: at the present
  // distance of the pad its lever would be larger than any that occurs. Or returns the tangents of
  // the touching elements only, where they are. Those of the fingers' springs follow.
  [[nodiscard]] PadTangents stuck(bool touching_only) const;
  [[nodiscard]] std::vector<ImplicitPad> implicit_pads() const;

  // Returns the energy of all springs.
  [[nodiscard]] PadEnergy spring_energy() const;
  // The same, and notes for force_on() the force on each pad: `wrench(pad, field)` returns that of
  // the elements in the frame of the surface.
  template <class PadWrench>
  PadEnergy read(PadWrench&& wrench) {
    PadEnergy energy;
    for (Contact& contact : contacts_) {
      const PadInstance& pad = *pads_[contact.pad].instance;
      const Field& field = pad.fields()[contact.field];
      const kernel::SpringSums sums = field.spring_sums();
      const Wrench& on_pad = wrench(pad, contact.field);
      contact.on_pad = pad_pose(contact).rotation * (field.pad_in_surface().rotation.transpose() * on_pad.force);
      energy.elastic += sums.elastic;
      energy.slip_loss += sums.slip_loss;
    }
    return energy;
  }
  [[nodiscard]] Eigen::Vector3d force_on(int body) const;  // N, by all pads
  // Computes the generalized force of fields whose forces are passive ones of MuJoCo.
  void find_passive_force(Eigen::VectorXd& force) const;

 private:
  struct Pad {
    PadInstance* instance;
    int site;
    int body;
  };

  const DynamicWorld& world_;
  std::vector<const PadLayout*> layouts_;
  std::vector<Pad> pads_;
  std::vector<Contact> contacts_;
  std::vector<int> fingers_;            // bodies
  std::optional<FingerSpring> spring_;  // of every finger
};

}  // namespace slipbench

// Base of the modes whose pads are fields.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "sim/mujoco/modes/dynamic_pads.h"
#include "sim/mujoco/modes/field_contacts.h"

namespace slipbench {

class FieldPads : public DynamicPads {
 public:
  void begin() override;
  [[nodiscard]] const ContactFrame& truth(std::size_t pad, FramePart part) const final { return contacts_.pad(pad).truth(part); }
  [[nodiscard]] double normal_force(std::size_t pad) const final { return contacts_.normal_force(pad); }
  void disable_slip_angle() final {
    for (std::size_t pad = 0; pad < contacts_.pads(); ++pad) contacts_.pad(pad).disable_slip_angle();
  }
  [[nodiscard]] std::vector<int> sites() const final { return contacts_.sites(); }
  // By the forces that the fields apply to the bodies.
  void find_force(Eigen::VectorXd& force) const override;
  PadEnergy read_energy() override;
  [[nodiscard]] Eigen::Vector3d force_on(int body, int dof, const Eigen::VectorXd& force) const override;

 protected:
  FieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known)
      : world_(world), contacts_(world, setup), stored_energy_known_(stored_energy_known) {}

  // Keeps the state of all pads as that of the start of the run.
  void keep_states();

  DynamicWorld& world_;
  FieldContacts contacts_;
  bool stored_energy_known_;
};

}  // namespace slipbench

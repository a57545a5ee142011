// Base of the modes whose pads are fields.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/mujoco/modes/dynamic_pads.h"
#include "sim/mujoco/modes/field_contacts.h"

namespace slipbench {

class FieldPads : public DynamicPads {
 public:
  [[nodiscard]] const ContactFrame& truth(std::size_t pad, FramePart part) const final { return contacts_.pad(pad).truth(part); }
  [[nodiscard]] double normal_force(std::size_t pad) const final { return contacts_.normal_force(pad); }
  void disable_slip_angle() final {
    for (std::size_t pad = 0; pad < contacts_.pads(); ++pad) contacts_.pad(pad).disable_slip_angle();
  }
  [[nodiscard]] std::vector<int> sites() const final { return contacts_.sites(); }

 protected:
  FieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known)
      : world_(world), contacts_(world, setup), stored_energy_known_(stored_energy_known) {}

  DynamicWorld& world_;
  FieldContacts contacts_;
  bool stored_energy_known_;
};

}  // namespace slipbench

#include "sim/mujoco/modes/field_pads.h"

namespace slipbench {

void FieldPads::begin() {
  call_mujoco([this] { mj_forward(world_.m(), world_.d()); });
}

void FieldPads::find_force(Eigen::VectorXd& force) const { contacts_.find_passive_force(force); }

PadEnergy FieldPads::read_energy() {
  return contacts_.read([](const PadInstance& pad, std::size_t field) -> const Wrench& { return pad.applied(field); });
}

Eigen::Vector3d FieldPads::force_on(int body, int /*dof*/, const Eigen::VectorXd& /*force*/) const {
  return contacts_.force_on(body);
}

void FieldPads::keep_states() {
  for (std::size_t pad = 0; pad < contacts_.pads(); ++pad) contacts_.pad(pad).keep_state();
}

}  // namespace slipbench

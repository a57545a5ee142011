// A library that throws although it must not: in the update, or with MAKES when it makes a
// controller.
#include <stdexcept>

#include "controllers/plugin_abi.h"

namespace {

void update(void* /*self*/, const slipbench_control_input* input, slipbench_grip_command* /*command*/) {
  if (input->position == 0) throw 42;
  if (input->position == 1) return;  // without a command
  throw std::runtime_error("out of ideas");
}

}  // namespace

const slipbench_abi slipbench_controller_abi = SLIPBENCH_CONTROLLER_BUILD;

void slipbench_make_controller(const slipbench_source* /*source*/, slipbench_controller* controller) {
#ifdef MAKES
  throw std::runtime_error("no controller today");
#endif
  controller->update = update;
}

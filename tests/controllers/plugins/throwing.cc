// A library that breaks the rule not to throw: in the update, or with MAKES already when it is asked for a controller.
#include <stdexcept>

#include "controllers/plugin_abi.h"

namespace {

slipbench_grip_command update(void* /*self*/, const slipbench_control_input* input) {
  if (input->position == 0) throw 42;
  throw std::runtime_error("out of ideas");
}

}  // namespace

const unsigned slipbench_controller_abi = SLIPBENCH_CONTROLLER_ABI;

slipbench_controller slipbench_make_controller(const slipbench_channel* /*channels*/, size_t /*count*/) {
#ifdef MAKES
  throw std::runtime_error("no controller today");
#endif
  return {nullptr, update, nullptr};
}

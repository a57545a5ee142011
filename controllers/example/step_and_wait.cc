// A controller of one's own: one count further on slip, and then no other until the gripper has shown that count (60 ms).
#include "controllers/plugin_abi.h"

namespace {

struct StepAndWait {
  int position = -1;  // commanded last; before the first update: none
};

slipbench_grip_command update(void* self, const slipbench_control_input* input) {
  int& position = static_cast<StepAndWait*>(self)->position;
  if (position < 0) position = input->position;
  const bool slips = input->slip_state >= 2;
  if (slips && input->position == position && position < 255) ++position;
  return {position, 0, 0};
}

void destroy(void* self) { delete static_cast<StepAndWait*>(self); }

}  // namespace

const unsigned slipbench_controller_abi = SLIPBENCH_CONTROLLER_ABI;

slipbench_controller slipbench_make_controller(const slipbench_channel* /*channels*/, size_t /*count*/) {
  return {new StepAndWait, update, destroy};
}

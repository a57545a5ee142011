// A controller of one's own: one count further on slip or below the preset force, and then no other until the gripper has shown that count
// (60 ms).
#include <cstring>

#include "controllers/plugin_abi.h"

namespace {

struct StepAndWait {
  size_t pillars = 0;
  int position = -1;  // commanded last; before the first update: none
};

// Sum of the normal forces [N]: z of each force.
double grip(const StepAndWait& self, const float* forces) {
  double sum = 0.0;
  for (size_t i = 0; i < self.pillars; ++i) sum += forces[3 * i + 2];
  return sum;
}

slipbench_grip_command update(void* self, const slipbench_control_input* input) {
  auto& controller = *static_cast<StepAndWait*>(self);
  int& position = controller.position;
  if (position < 0) position = input->position;
  const bool slips = input->slip_state >= 2;
  if ((slips || grip(controller, input->values) < input->preset) && input->position == position && position < 255) ++position;
  return {position, 0, 0};
}

void destroy(void* self) { delete static_cast<StepAndWait*>(self); }

}  // namespace

const unsigned slipbench_controller_abi = SLIPBENCH_CONTROLLER_ABI;

// Works where the first channel is the force of each pillar, as a PapillArray's is.
slipbench_controller slipbench_make_controller(const slipbench_channel* channels, size_t count) {
  const bool known = count > 0 && std::strcmp(channels[0].name, "force") == 0 && channels[0].dimensions == 2;
  if (!known) return {};
  return {new StepAndWait{channels[0].shape[0], -1}, update, destroy};
}

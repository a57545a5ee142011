// Example of a custom controller: closes by one count on slip or below the preset force, then waits
// until the gripper has responded (60 ms).
#include <cstring>

#include "controllers/plugin_abi.h"

namespace {

struct StepAndWait {
  size_t first = 0;  // place of the forces {pillars, 3} in a sample of the sensing finger
  size_t pillars = 0;
  int counts = 1;     // per step
  int position = -1;  // last command; -1: none yet
};

// Sum of the normal forces [N]: z of each force.
double grip(const StepAndWait& self, const float* values) {
  double sum = 0.0;
  for (size_t i = 0; i < self.pillars; ++i) sum += static_cast<double>(values[self.first + 3 * i + 2]);
  return sum;
}

void update(void* self, const slipbench_control_input* input, slipbench_grip_command* command) {
  auto& controller = *static_cast<StepAndWait*>(self);
  int& position = controller.position;
  if (position < 0) position = input->position;
  const bool slips = input->slip_state >= 2;
  const bool loose = grip(controller, input->sensors[0].latest) < input->preset;
  if ((slips || loose) && input->position == position && position + controller.counts <= 255) position += controller.counts;
  command->position = position;
}

void destroy(void* self) { delete static_cast<StepAndWait*>(self); }

}  // namespace

const slipbench_parameter slipbench_controller_parameters[] = {
    SLIPBENCH_A_NUMBER("counts", 1.0, ""),  // per step
    SLIPBENCH_NO_MORE,
};

const slipbench_abi slipbench_controller_abi = SLIPBENCH_CONTROLLER_BUILD;

void slipbench_make_controller(const slipbench_source* source, slipbench_controller* controller) {
  const slipbench_sensor& sensor = source->sensors[0];
  for (size_t i = 0; i < sensor.channel_count; ++i) {
    const slipbench_channel& channel = sensor.channels[i];
    if (std::strcmp(channel.name, "force") != 0 || channel.dimensions != 2) continue;
    controller->self = new StepAndWait{channel.first, channel.shape[0], static_cast<int>(source->parameters[0].number)};
    controller->update = update;
    controller->destroy = destroy;
    return;
  }
  std::strcpy(controller->refusal, "it reads a channel force {N, 3}, as a papillarray has it");
}

// Answers with what it was handed, digit by digit, so that a test sees each field arrive.
#include <cmath>
#include <cstring>

#include "controllers/plugin_abi.h"

namespace {

int tenths(double value) { return static_cast<int>(std::lround(10.0 * value)); }

slipbench_grip_command update(void* /*self*/, const slipbench_control_input* in) {
  const int times =
      tenths(in->slip_time) + 10 * tenths(in->slip_latency) + 100 * tenths(in->frame_time) + 1000 * tenths(in->status_time);
  const int flags = in->slip_state + 10 * in->moving + 100 * in->stopped + 1000 * tenths(in->stuck_fraction);
  return {in->position + 1000 * static_cast<int>(in->values[in->value_count - 1]) + 10000 * tenths(in->preset), times, flags};
}

}  // namespace

const unsigned slipbench_controller_abi = SLIPBENCH_CONTROLLER_ABI;

// Works with two channels, the second of them displacements {9, 3} in m.
slipbench_controller slipbench_make_controller(const slipbench_channel* channels, size_t count) {
  const bool known = count == 2 && std::strcmp(channels[1].name, "displacement") == 0 &&
                     std::strcmp(channels[1].unit, "m") == 0 && channels[1].dimensions == 2 && channels[1].shape[0] == 9 &&
                     channels[1].shape[1] == 3;
  return {nullptr, known ? update : nullptr, nullptr};
}

// A copy of the controller step_on_slip as a shared library with a planted fault: FAULT names one
// of Fault.
#include <cstddef>
#include <cstring>
#include <deque>

#include "controllers/plugin_abi.h"

namespace {

enum class Fault {
  none,
  never_tightens,  // on slip
  late,            // acts 200 ms later on slip
  stuck_sensor,    // keeps the sample from when the preset force was reached
  wrong_sign,      // opens on slip
  overshoots,      // 20 counts on slip: beyond the force limit
  latches,         // slip that was reported once counts for ever
};
constexpr Fault fault = Fault::FAULT;

constexpr std::size_t late_by = 10;  // periods of 20 ms

class Controller {
 public:
  // `first`, `units`: place of the forces {units, 3} in the frame.
  Controller(std::size_t first, std::size_t units) : first_(first), units_(units) {}

  slipbench_grip_command update(const slipbench_control_input& input) {
    const float* const values = input.sensors[0].latest;
    double grip = 0.0;
    for (std::size_t unit = 0; unit < units_; ++unit) grip += static_cast<double>(values[first_ + 3 * unit + 2]);
    if (fault == Fault::stuck_sensor && held_ >= input.preset) grip = held_;
    held_ = grip;
    const bool tightens = slips(input.slip_state >= 2) || grip < input.preset;
    return {tightens ? input.position + step(grip >= input.preset) : input.position, 0, 0};
  }

 private:
  bool slips(bool slip) {
    if (fault == Fault::never_tightens || fault == Fault::stuck_sensor) return false;
    if (fault == Fault::latches) return latched_ = latched_ || slip;
    if (fault != Fault::late) return slip;
    line_.push_back(slip);
    if (line_.size() <= late_by) return false;
    const bool then = line_.front();
    line_.pop_front();
    return then;
  }

  static int step(bool on_slip) {
    if (fault == Fault::wrong_sign && on_slip) return -1;
    return fault == Fault::overshoots && on_slip ? 20 : 1;
  }

  std::size_t first_, units_;
  double held_ = 0.0;  // N, last value
  bool latched_ = false;
  std::deque<bool> line_;
};

void update(void* self, const slipbench_control_input* input, slipbench_grip_command* command) {
  *command = static_cast<Controller*>(self)->update(*input);
}

void destroy(void* self) { delete static_cast<Controller*>(self); }

}  // namespace

const slipbench_abi slipbench_controller_abi = SLIPBENCH_CONTROLLER_BUILD;

void slipbench_make_controller(const slipbench_source* source, slipbench_controller* controller) {
  const slipbench_sensor& sensor = source->sensors[0];
  for (size_t i = 0; i < sensor.channel_count; ++i) {
    const slipbench_channel& channel = sensor.channels[i];
    if (std::strcmp(channel.name, "force") != 0) continue;
    controller->self = new Controller(channel.first, channel.shape[0]);
    controller->update = update;
    controller->destroy = destroy;
    return;
  }
}

// Returns its input, so that a test sees each field arrive. position: number of 13 values that are
// as the test set them; speed and force: number of new samples of the second sensor, and ten times
// its newest value.
#include <cmath>
#include <cstring>

#include "controllers/plugin_abi.h"

namespace {

struct Echo {
  double gain;
};

int near(double value, double expected) { return std::abs(value - expected) < 1e-6 ? 1 : 0; }

void update(void* self, const slipbench_control_input* in, slipbench_grip_command* command) {
  const slipbench_samples& own = in->sensors[0];
  const slipbench_samples& other = in->sensors[1];
  command->position = near(in->slip_time, 0.1) + near(in->slip_latency, 0.2) + near(in->slip_state, 3) +
                      near(in->stuck_fraction, 0.5) + near(own.latest_time, 0.3) + near(own.latest[53], 7.0) +
                      near(static_cast<double>(own.count), 1.0) + near(in->status_time, 0.4) + near(in->position, 42) +
                      near(in->moving, 0) + near(in->stopped, 1) + near(in->preset, 4.0) +
                      near(static_cast<const Echo*>(self)->gain, 2.5e-3);
  command->speed = static_cast<int>(other.count);
  command->force = other.latest == nullptr ? 255 : static_cast<int>(std::lround(10.0F * other.latest[0]));
}

void destroy(void* self) { delete static_cast<Echo*>(self); }

}  // namespace

const slipbench_parameter slipbench_controller_parameters[] = {SLIPBENCH_A_TEXT("word", "none"), SLIPBENCH_A_BOOLEAN("flag", 0.0),
                                                               SLIPBENCH_A_NUMBER("gain", 1.0, "m"), SLIPBENCH_NO_MORE};

const slipbench_abi slipbench_controller_abi = SLIPBENCH_CONTROLLER_BUILD;

// Requires two channels, the second one displacements {9, 3} in m, and a sensor `skin` with one
// value.
void slipbench_make_controller(const slipbench_source* source, slipbench_controller* controller) {
  const slipbench_sensor& pad = source->sensors[source->sensor];
  if (pad.channel_count != 2) return;
  const slipbench_channel& channel = pad.channels[1];
  const bool known = std::strcmp(pad.name, "pad") == 0 && std::strcmp(pad.type, "papillarray") == 0 && pad.rate == 1000.0 &&
                     pad.value_count == 54 && std::strcmp(channel.name, "displacement") == 0 &&
                     std::strcmp(channel.unit, "m") == 0 && channel.dimensions == 2 && channel.shape[0] == 9 &&
                     channel.shape[1] == 3 && channel.first == 27 && channel.size == 27;
  const slipbench_parameter* const p = source->parameters;
  const bool given = source->parameter_count == 3 && std::strcmp(p[0].name, "word") == 0 && std::strcmp(p[0].text, "4 mm") == 0 &&
                     p[1].number == 1.0 && std::strcmp(p[2].unit, "m") == 0;
  if (!known || !given || source->sensor_count != 2 || std::strcmp(source->sensors[1].name, "skin") != 0) return;
  controller->self = new Echo{p[2].number};
  controller->update = update;
  controller->destroy = destroy;
}

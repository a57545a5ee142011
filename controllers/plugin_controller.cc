#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "controllers/controller_kinds.h"
#include "controllers/plugin_abi.h"
#include "sim/core/error.h"
#include "sim/plugins/plugin_library.h"

namespace slipbench::controllers {
namespace {

class PluginController final : public Controller, private SampleListener {
 public:
  PluginController(const Parameters& parameters, const GripSource& source)
      : made_("controller", parameters, SLIPBENCH_CONTROLLER_BUILD), preset_(source.preset), samples_(source.sensors) {
    made_.make<decltype(slipbench_make_controller)>(parameters, source.sensors, 0, &slipbench_controller::update);
  }

  GripCommand update(const ControlInput& input) override {
    const std::span<const slipbench_samples> sensors = samples_.handed();
    const slipbench_control_input handed{
        .slip_time = input.slip.time,
        .slip_latency = input.slip.latency,
        .slip_state = static_cast<int>(input.slip.state),
        .stuck_fraction = input.slip.stuck_fraction,
        .sensors = sensors.data(),
        .sensor_count = sensors.size(),
        .status_time = input.gripper.time,
        .position = input.gripper.position,
        .moving = input.gripper.moving ? 1 : 0,
        .stopped = input.gripper.stopped ? 1 : 0,
        .preset = preset_,
    };
    slipbench_grip_command command{.position = -1, .speed = 0, .force = 0};
    made_.library.call("update", [&] { made_.object.update(made_.object.self, &handed, &command); });
    samples_.forget();
    for (const auto& [name, value] :
         {std::pair{"position", command.position}, {"speed", command.speed}, {"force", command.force}}) {
      if (value >= 0 && value <= max_register) continue;
      made_.library.refuse("commands in update " + std::string(name) + " " + std::to_string(value) + "; allowed: 0 to " +
                           std::to_string(max_register));
    }
    return {.position = command.position, .speed = command.speed, .force = command.force};
  }

  [[nodiscard]] SampleListener* listener() override { return this; }

  void finish() override { made_.finish(); }

 private:
  void hear(std::size_t sensor, const SensorFrame& sample) override { samples_.add(sensor, sample); }

  PluginObject<slipbench_controller> made_;
  double preset_;  // N
  PluginSamples samples_;
};

}  // namespace

ControllerKind plugin() {
  return {
      {"plugin", "A custom controller from a shared library.",
       "The library computes the command from the estimate and the samples of all sensors. It exports slipbench_controller_abi and slipbench_make_controller (controllers/plugin_abi.h; example: controllers/example).",
       "the library's author", plugin_specs()},
      created<PluginController>,
      Answers::by_own_rule,
      true};
}

}  // namespace slipbench::controllers

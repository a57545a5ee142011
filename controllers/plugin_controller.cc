#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "controllers/controller_kinds.h"
#include "controllers/plugin_abi.h"
#include "sim/core/error.h"
#include "sim/core/process/plugin_library.h"

namespace slipbench::controllers {
namespace {

class PluginController final : public Controller, private SampleListener {
 public:
  PluginController(const Parameters& parameters, const GripSource& source)
      : library_("controller", parameters.path("library"), SLIPBENCH_CONTROLLER_BUILD),
        preset_(source.preset),
        samples_(source.sensors) {
    const PluginLibrary::Values values = library_.parameters(parameters.map("parameters"));
    const PluginSensors sensors(source.sensors);
    const slipbench_source about{.sensors = sensors.handed().data(),
                                 .sensor_count = sensors.handed().size(),
                                 .sensor = 0,
                                 .parameters = values.handed().data(),
                                 .parameter_count = values.handed().size()};
    const auto make = library_.maker<decltype(slipbench_make_controller)>();
    library_.guarded("slipbench_make_controller", [&] { make(&about, &controller_); });
    if (controller_.update != nullptr) return;
    finish();
    library_.refuse_scene(controller_.refusal);
  }

  PluginController(const PluginController&) = delete;  // owns what the library made
  PluginController& operator=(const PluginController&) = delete;
  ~PluginController() override {
    try {
      finish();
    } catch (const SceneValueError&) {
      // Another error is under way: a trial that ends well calls finish() itself.
    }
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
    slipbench_grip_command said{.position = -1, .speed = 0, .force = 0};
    library_.guarded("update", [&] { controller_.update(controller_.self, &handed, &said); });
    samples_.forget();
    for (const auto& [name, value] : {std::pair{"position", said.position}, {"speed", said.speed}, {"force", said.force}}) {
      if (value >= 0 && value <= max_register) continue;
      library_.refuse("commands in update " + std::string(name) + " " + std::to_string(value) + "; allowed: 0 to " +
                      std::to_string(max_register));
    }
    return {.position = said.position, .speed = said.speed, .force = said.force};
  }

  [[nodiscard]] SampleListener* listener() override { return this; }

  void finish() override {
    const auto destroy = std::exchange(controller_.destroy, nullptr);
    if (destroy != nullptr && !library_.has_crashed()) library_.guarded("destroy", [&] { destroy(controller_.self); });
    library_.close();
  }

 private:
  void hear(std::size_t sensor, const SensorFrame& sample) override { samples_.add(sensor, sample); }

  PluginLibrary library_;  // outlives what it made
  double preset_;          // N
  PluginSamples samples_;
  slipbench_controller controller_{};
};

}  // namespace

ControllerKind plugin() {
  return {
      {"plugin", "Your own controller, from a shared library.",
       "The library computes the command from the estimate and the samples of all sensors. It exports slipbench_controller_abi and slipbench_make_controller (controllers/plugin_abi.h; example: controllers/example).",
       "the library's author", plugin_specs()},
      created<PluginController>};
}

}  // namespace slipbench::controllers

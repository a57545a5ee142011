#include "sim/mujoco/pads/plugin_state.h"

#include <memory>

#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_field.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

std::size_t channel_values(const Sensor& sensor) {
  std::size_t size = 0;
  for (const Channel& channel : sensor.channels()) size += channel.size();
  return size;
}

std::size_t memory_values(Sensor& sensor) {
  std::size_t size = 0;
  for (const std::span<double> memory : sensor.memory()) size += memory.size();
  return size;
}

}  // namespace

PluginStateLayout::PluginStateLayout(const PadConfig& config, Sensor& sensor, std::size_t field_values)
    : fields(field_values),
      geoms(config.geoms.size()),
      implicit(config.implicit ? config.geoms.size() * ImplicitFields::memory_per_contact : 0),
      memory(memory_values(sensor)),
      held(channel_values(sensor)),
      truth(config.truth ? 8 * sensor.layout().units.size() + 3 : 0) {}

std::size_t pad_state_size(ModelView model, const PadConfig& config, const PadCatalogue& catalogue) {
  const std::unique_ptr<Sensor> sensor = config.make_sensor(catalogue);
  const PadLayout layout = without_dashpots(sensor->layout());
  std::size_t fields = 0;
  for (const int geom : config.geoms) {
    fields += make_pad_field(model, config, layout, geom, kind_of_surface(model.geom_type()[geom])).state_size();
  }
  return PluginStateLayout(config, *sensor, fields).total();
}

std::size_t pad_sensor_size(const PadConfig& config, const PadCatalogue& catalogue) {
  const std::unique_ptr<Sensor> sensor = config.make_sensor(catalogue);
  const PluginStateLayout layout(config, *sensor, 0);
  return layout.held + layout.truth;
}

}  // namespace slipbench

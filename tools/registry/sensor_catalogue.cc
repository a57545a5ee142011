#include "tools/registry/sensor_catalogue.h"

#include <cmath>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/stage/stage_setup.h"
#include "tools/registry/registry.h"
#include "tools/registry/sensor_list.h"

namespace slipbench {

namespace {

struct RegisteredSensor {
  SensorKind kind;
  SensorMaker make;
};

Registry<RegisteredSensor>& registered_sensors() {
  static Registry<RegisteredSensor> registry;
  return registry;
}

}  // namespace

void register_sensor(SensorKind kind, SensorMaker make) {
  std::vector<Entry> own;
  for (const SensorKind& known : sensor_catalogue()) own.push_back(known.about);
  const Entry about = kind.about;
  kind.users_code = true;
  registered_sensors().put("sensor", about, {std::move(kind), std::move(make)}, own);
}

std::vector<Entry> registered_sensor_entries() { return registered_sensors().entries(); }

Catalogues pad_catalogues() {
  Catalogues catalogues;
  add_sim_catalogues(catalogues);
  for (const SensorKind& kind : sensor_catalogue()) {
    catalogues.sensors.push_back(kind.about);
    catalogues.electronics[kind.about.name] = kind.electronics;
  }
  for (Entry& entry : registered_sensor_entries()) catalogues.sensors.push_back(std::move(entry));
  return catalogues;
}

namespace {

std::unique_ptr<Sensor> created(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) {
  if (const std::optional<RegisteredSensor> found = registered_sensors().find(scene.type)) return found->make(scene, seed, trial);
  for (const SensorKind& kind : sensor_catalogue()) {
    if (kind.about.name == scene.type) return kind.create(scene.parameters, scene.electronics, seed, trial, scene.name);
  }
  throw InputError("sensor " + scene.name + ": unknown type " + quote(scene.type));
}

// Refuses elements without a spring or a place, which sums of a sensor's extreme values may give.
void check_elements(const SensorScene& scene, const PadLayout& layout) {
  const auto refuse = [&](const std::string& what) { throw SceneValueError("sensors." + scene.name, what); };
  const auto check_stiffness = [&](const char* direction, double stiffness) {
    if (stiffness > 0.0 && std::isfinite(stiffness)) return;
    refuse(std::string("an element has a ") + direction + " stiffness of " + format_number(stiffness) +
           " N/m; allowed: positive and finite");
  };
  for (const Element& element : layout.elements) {
    check_stiffness("normal", element.k_normal);
    check_stiffness("tangential", element.k_tangential);
    if (!element.tip.allFinite()) refuse("the position of an element is not finite; use a smaller pad");
  }
}

}  // namespace

std::unique_ptr<Sensor> make_sensor(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) {
  std::unique_ptr<Sensor> sensor = created(scene, seed, trial);
  check_elements(scene, sensor->layout());
  return sensor;
}

SensorKind sensor_kind(const std::string& type) {
  for (const SensorKind& kind : sensor_catalogue()) {
    if (kind.about.name == type) return kind;
  }
  const std::optional<RegisteredSensor> found = registered_sensors().find(type);
  return found ? found->kind : SensorKind{};
}

std::string usual_unit(const std::string& type, const std::string& channel) {
  return sensor_kind(type).view.channel_view(channel).unit;
}

}  // namespace slipbench

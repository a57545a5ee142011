#include "tools/program/catalogue/sensor_catalogue.h"

#include "sim/simulation/stage_setup.h"
#include "tools/program/catalogue/registry.h"

// All sensors in the order of `slipbench list`, a line each: the name of its folder in sensors/ (plugin: own), where SensorKind NAME_sensor() is
// defined.
#define SLIPBENCH_SENSORS(SENSOR) \
  SENSOR(papillarray)             \
  SENSOR(nib_pad)                 \
  SENSOR(piezo_skin)              \
  SENSOR(biotac_sp)               \
  SENSOR(myrmex)                  \
  SENSOR(taxels)                  \
  SENSOR(gel_markers)             \
  SENSOR(magnetic_skin)           \
  SENSOR(plugin)

namespace slipbench {

#define SLIPBENCH_DECLARED(name) SensorKind name##_sensor();
SLIPBENCH_SENSORS(SLIPBENCH_DECLARED)

namespace {

const std::vector<SensorKind>& sensor_catalogue() {
#define SLIPBENCH_LISTED(name) name##_sensor(),
  static const std::vector<SensorKind> kinds{SLIPBENCH_SENSORS(SLIPBENCH_LISTED)};
  return kinds;
}

Registry<SensorMaker>& registered_sensors() {
  static Registry<SensorMaker> registry;
  return registry;
}

}  // namespace

void register_sensor(const Entry& about, SensorMaker make) {
  std::vector<Entry> own;
  for (const SensorKind& kind : sensor_catalogue()) own.push_back(kind.about);
  registered_sensors().put("sensor", about, std::move(make), own);
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

std::unique_ptr<Sensor> make_sensor(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) {
  if (const std::optional<SensorMaker> make = registered_sensors().find(scene.type)) return (*make)(scene, seed, trial);
  for (const SensorKind& kind : sensor_catalogue()) {
    if (kind.about.name == scene.type) return kind.create(scene.parameters, scene.electronics, seed, trial, scene.name);
  }
  throw InputError("sensor " + scene.name + ": unknown type " + quote(scene.type));
}

SensorView sensor_view(const std::string& type) {
  for (const SensorKind& kind : sensor_catalogue()) {
    if (kind.about.name == type) return kind.view;
  }
  return {};
}

}  // namespace slipbench

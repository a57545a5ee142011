#include "tools/program/catalogue/sensor_catalogue.h"

#include <string>
#include <vector>

#include "sensors/biotac_sp/biotac_sp.h"
#include "sensors/myrmex/myrmex.h"
#include "sensors/nib_pad/nib_pad.h"
#include "sensors/papillarray/papillarray.h"
#include "sensors/piezo_skin/piezo_skin.h"
#include "sim/core/error.h"
#include "sim/simulation/stage_simulation.h"

namespace slipbench {
namespace {

std::vector<ElectronicsPart> parts_of(const SensorScene& scene) {
  std::vector<ElectronicsPart> parts;
  for (const Named& part : scene.electronics) parts.push_back({part.name, part.parameters});
  return parts;
}

// A sensor that a scene may name.
struct SensorKind {
  Entry about;
  std::vector<Entry> electronics;  // the parts that it has
  std::unique_ptr<Sensor> (*create)(const Parameters& parameters, const std::vector<ElectronicsPart>& electronics,
                                    std::uint64_t seed, std::uint64_t trial, const std::string& sensor_name);
};

// All sensors, one line each.
const std::vector<SensorKind>& sensor_catalogue() {
  static const std::vector<SensorKind> kinds{
      {papillarray_entry(), papillarray_electronics(), make_papillarray},
      {nib_pad_entry(), nib_pad_electronics(), make_nib_pad},
      {piezo_skin_entry(), piezo_skin_electronics(), make_piezo_skin},
      {biotac_sp_entry(), biotac_sp_electronics(), make_biotac_sp},
      {myrmex_entry(), myrmex_electronics(), make_myrmex},
  };
  return kinds;
}

}  // namespace

Catalogues pad_catalogues() {
  Catalogues catalogues;
  add_sim_catalogues(catalogues);
  for (const SensorKind& kind : sensor_catalogue()) {
    catalogues.sensors.push_back(kind.about);
    catalogues.electronics[kind.about.name] = kind.electronics;
  }
  return catalogues;
}

std::unique_ptr<Sensor> make_sensor(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) {
  for (const SensorKind& kind : sensor_catalogue()) {
    if (kind.about.name == scene.type) return kind.create(scene.parameters, parts_of(scene), seed, trial, scene.name);
  }
  throw InputError("sensor " + scene.name + ": unknown type " + quote(scene.type));
}

}  // namespace slipbench

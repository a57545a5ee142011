// Where the program's sensors are composed: the one place that names them all.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim/core/sensor.h"
#include "sim/core/sensor_kind.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

using SensorMaker = std::function<std::unique_ptr<Sensor>(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial)>;

// From now on a scene of this process may name a sensor of whoever has embedded the program; one registered under that name before is replaced.
// Thread-safe. Throws InputError for a name that is no identifier, or that the program itself uses.
void register_sensor(const Entry& about, SensorMaker make);
// Those that were registered, in the order of their names.
std::vector<Entry> registered_sensor_entries();

// What a scene may name of pads and of what they touch: everything but what reads the sensors.
Catalogues pad_catalogues();

// The sensor that `scene` describes. (`seed`, `trial`) key the random streams of its electronics. Throws InputError for a type
// that the catalogue does not have, and what the sensor itself refuses.
std::unique_ptr<Sensor> make_sensor(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial);

// How a sensor of this type is shown; SensorView's default for a type that the catalogue does not have, as a dataset may name.
SensorView sensor_view(const std::string& type);

}  // namespace slipbench

// Makes the sensors of the program and of an embedding application.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/api/sensor.h"
#include "sim/api/sensor_kind.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

using SensorMaker = std::function<std::unique_ptr<Sensor>(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial)>;

// Registers a sensor of the embedding application, which `make` creates instead of `kind.create`.
// Scenes of this process may then name it; it replaces a sensor registered under that name before.
// Thread-safe. Throws InputError if the name is not an identifier or belongs to the program.
void register_sensor(SensorKind kind, SensorMaker make);
// Registered sensors, sorted by name.
std::vector<Entry> registered_sensor_entries();

// Catalogues of pads and of the objects that they touch: everything except readers of the sensors.
Catalogues pad_catalogues();

// Creates the sensor that `scene` describes. (`seed`, `trial`) key the random streams of its
// electronics. Throws InputError for an unknown type and as the sensor's constructor does, and
// SceneValueError for `sensors.NAME` if the stiffness of an element is not positive or its position
// is not finite.
std::unique_ptr<Sensor> make_sensor(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial);

// The sensor of this type, registered ones included; the defaults for an unknown type, which a
// dataset may name.
SensorKind sensor_kind(const std::string& type);

// The channel's unit in simulated sensors of this type; empty: unknown or set by parameters.
std::string usual_unit(const std::string& type, const std::string& channel);

}  // namespace slipbench

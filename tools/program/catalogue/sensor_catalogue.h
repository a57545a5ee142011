// Where the program's sensors are composed: the one place that names them all.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/core/sensor.h"
#include "sim/core/sensor_view.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

// What a scene may name of pads and of what they touch: everything but what reads the sensors.
Catalogues pad_catalogues();

// The sensor that `scene` describes. (`seed`, `trial`) key the random streams of its electronics. Throws InputError for a type
// that the catalogue does not have, and what the sensor itself refuses.
std::unique_ptr<Sensor> make_sensor(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial);

// How a sensor of this type is shown; SensorView's default for a type that the catalogue does not have, as a dataset may name.
SensorView sensor_view(const std::string& type);

}  // namespace slipbench

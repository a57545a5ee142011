// Sensors written against sensors/plugin_abi.h and built into the program.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensors/plugin_abi.h"
#include "sim/api/sensor.h"
#include "sim/core/parameters.h"

namespace slipbench {

// A sensor written against sensors/plugin_abi.h alone and built into the program, with its exported
// symbols.
struct BundledSensor {
  const char* type;  // name in a scene
  const slipbench_parameter* parameters;
  const slipbench_about* about;
  void (*make)(const slipbench_source* source, slipbench_readout* readout);
};

// The declared parameters, with their notes, as specifications for the scene's parser.
std::vector<ParameterSpec> specs_of(const BundledSensor& bundled);

// Makes the sensor `name` of a scene, like SensorKind::create. Its errors and values are checked as
// those of a library; SceneValueError is raised at sensors.`name`.type.
std::unique_ptr<Sensor> make_bundled(const BundledSensor& bundled, const Parameters& parameters, std::uint64_t seed,
                                     std::uint64_t trial, const std::string& name);

}  // namespace slipbench

// A sensor that the program is built with and that was written as a library's: against sensors/plugin_abi.h alone.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensors/plugin_abi.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor.h"

namespace slipbench {

// What such a source exports.
struct BundledSensor {
  const char* type;  // the scene's name for it
  const slipbench_parameter* parameters;
  const slipbench_about* about;
  void (*make)(const slipbench_source* source, slipbench_readout* readout);
};

// The declared parameters as the scene's parser takes them, each with its note.
std::vector<ParameterSpec> specs_of(const BundledSensor& bundled);

// The sensor `name` of a scene, as SensorKind::create has it. Calls are guarded and what it says is checked as of a library; SceneValueError is then
// at sensors.`name`.type.
std::unique_ptr<Sensor> make_bundled(const BundledSensor& bundled, const Parameters& parameters, std::uint64_t seed,
                                     std::uint64_t trial, const std::string& name);

}  // namespace slipbench

// A detector of one's own, from a shared library: detectors/plugin_abi.h.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The catalogue's entry.
Entry plugin_detector_entry();

// `parameters`: those of plugin_detector_entry(), all present; `source.sensors` must hold all sensors of the scene. Throws
// SceneValueError at detector.library for a library that is not one (PluginLibrary), that makes no detector for this scene, or
// whose rate is not that of the sensor over a whole number, and at detector.parameters.<name> for a value that the library does
// not take. update() and finish() throw SceneValueError where the library crashes, throws or says what no estimate is.
std::unique_ptr<Detector> make_plugin_detector(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench

// Which detector a command line means.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "detectors/network/engine.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene.h"

namespace slipbench::eval {

// `text`: a detector's name from the catalogue; else FILE.onnx, a network; else a folder of memories that `slipbench train` wrote, or cl_gst_hd,
// for gst_hd. `parameters`: its parameters by name, as a scene writes them; paths are from the working folder. The same reader and messages as
// a scene's (sim/scene): unknown names with the nearest known one. Throws InputError.
DetectorScene chosen_detector(const std::string& text, const std::vector<Override>& parameters);

// The network that such a detector is, for what it says of itself; nullptr: it is none. Throws InputError: no file is named, or what
// network::load_engine() refuses.
std::unique_ptr<network::Engine> network_of(const DetectorScene& detector);

}  // namespace slipbench::eval

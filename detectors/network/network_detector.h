// Slip told by a neural network from an ONNX file.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// What the parameter `model` says where no network is named.
inline constexpr const char* no_network = "none";

// The catalogue's entry.
Entry network_entry();

// `parameters`: those of network_entry(), all present. An estimate a sample; it changes when a frame is complete, and says no_contact before the
// network has been fed for the first time. Feature "slip_probability". Throws SceneValueError at detector.model for a file that is no such
// network (network::load_engine) and one that reads another sensor. update() throws InputError where the network says no number.
std::unique_ptr<Detector> make_network(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench

// What the library with libtorch and libonnx exports.
#pragma once

#include "tools/program/train/network/network.h"

namespace slipbench::train {

// Both throw as make_network() and onnx_model(); who calls make() owns the network.
struct TorchLibrary {
  Network* (*make)(const NetworkShape& shape, std::uint64_t seed);
  // `metadata`: the text of the description.
  std::string (*onnx)(const NetworkShape& shape, std::span<const std::vector<std::vector<float>>> members,
                      const std::string& metadata);
  const char* versions;  // network_libraries()
};

// Of a function that returns the address of a TorchLibrary.
inline constexpr const char* torch_symbol = "slipbench_torch_library";

// The `onnx` of the above.
std::string write_onnx(const NetworkShape& shape, std::span<const std::vector<std::vector<float>>> members,
                       const std::string& metadata);

}  // namespace slipbench::train

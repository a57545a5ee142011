// What of an ONNX file is looked at before an engine sees it: engines trust what they read.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "detectors/network/description.h"

namespace slipbench::network {

// An input or an output of the graph, float32.
struct Port {
  std::string name;
  std::vector<std::int64_t> shape;  // 1 where the file leaves an extent open, as it does for the batch
  bool open = false;                // the file leaves open another than the first, the batch's

  [[nodiscard]] std::size_t size() const;
};

struct CheckedNetwork {
  Description description;
  Port input;                // the frames
  std::string output;        // the classes
  std::vector<Port> states;  // the inputs of description.states, in their order
};

// Bytes that a file of a network may have.
inline constexpr std::size_t most_network_bytes = 256u << 20u;
// Elements that a tensor of it may have: 256 MB of float32.
inline constexpr std::size_t most_elements = 1u << 26u;
// Multiply-adds that a step of it may take: some half a second of one core.
inline constexpr double most_multiply_adds = 1e10;

// Looks into the bytes of an ONNX file, which `subject` names in errors. Throws InputError where they are no ONNX, have no metadata (with what to
// add and how), use operators that are not ONNX' own, random ones, loops or functions, have data outside of the file or not as long as its shape says, in any graph
// of the file, and where inputs and outputs are not those of the description.
CheckedNetwork check_network(std::string_view bytes, const std::string& subject);

}  // namespace slipbench::network

// Checks an ONNX file before an engine reads it, because engines trust their input.
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
  std::vector<std::int64_t> shape;  // 1 where the file leaves an extent open, such as the batch's
  bool open = false;                // the file leaves an extent open other than the first, the batch's

  [[nodiscard]] std::size_t size() const;
};

struct CheckedNetwork {
  Description description;
  Port input;                // the frames
  std::string output;        // the classes
  std::vector<Port> states;  // the inputs of description.states, in their order
};

// Largest size of a network's file, in bytes.
inline constexpr std::size_t most_network_bytes = 256u << 20u;
// Largest number of elements of a tensor: 256 MB of float32.
inline constexpr std::size_t most_elements = 1u << 26u;
// Largest number of multiply-adds per step: about half a second of one core.
inline constexpr double most_multiply_adds = 1e10;

// Checks the bytes of an ONNX file; `subject` names it in errors. Throws InputError if they are not
// ONNX, have no metadata (the message says what to add and how), use operators outside ONNX, random
// ones, loops or functions, or if in any graph data is outside the file or has a length other than
// its shape's, or if inputs and outputs differ from the description.
CheckedNetwork check_network(std::string_view bytes, const std::string& subject);

}  // namespace slipbench::network

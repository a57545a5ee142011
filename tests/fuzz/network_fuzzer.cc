// Arbitrary bytes are a usable network file or description, or give an InputError; anything else is
// a crash.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "detectors/network/description.h"
#include "detectors/network/onnx_check.h"
#include "sim/core/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slipbench;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    if (bytes.starts_with('{')) {
      const std::string text = network::description_text(network::parse_description(bytes, "fuzz.onnx"));
      // Accepted text is written again and must be equal.
      if (network::description_text(network::parse_description(text, "fuzz.onnx")) != text) throw std::logic_error(text);
    } else {
      static_cast<void>(network::check_network(bytes, "fuzz.onnx"));
    }
  } catch (const InputError&) {
    // The expected answer to bad input.
  }
  return 0;
}

// Runs networks by OpenVINO, in a separate library that is loaded with the first network.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "detectors/network/description.h"

namespace slipbench::network {

// One network with its recurrent state, used by one thread at a time. It computes in f32 on one
// thread: bit-identical on one machine, while another processor may round differently.
class Engine {
 public:
  virtual ~Engine() = default;

  [[nodiscard]] virtual const Description& description() const = 0;
  // Number of input values: history times a frame's.
  [[nodiscard]] virtual std::size_t inputs() const = 0;
  // Sets the recurrent state to zero.
  virtual void reset() = 0;
  // Runs one step. Returns the raw output, one value per class, for the input [inputs()]. Valid
  // until the next call. Throws InputError if an input or output is not finite, or if probabilities
  // are invalid.
  virtual std::span<const float> run(std::span<const float> input) = 0;
};

// Loads the network in an ONNX file. Each thread keeps the compiled network while the file stays
// unchanged. Throws InputError, naming the file, if it is not a regular file, is too large or not
// ONNX, has custom operators, external data, shapes that do not fit, or wrong or missing metadata
// (the message says what to add and how).
std::unique_ptr<Engine> load_engine(const std::string& path);
// The same without the check that the file does not crash OpenVINO (check_readable.h), for
// processes that may crash.
std::unique_ptr<Engine> load_engine_unchecked(const std::string& path);
// True if load_engine() has its library.
bool engine_available();

// Returns the probability of slip, 0 to 1: the sum over the classes that slip.
double slip_probability(const Description& description, std::span<const float> output);
// Returns the reported class: the most probable one that slips if `slip`, otherwise the most
// probable of the others.
PadState state_of(const Description& description, std::span<const float> output, bool slip);

// Symbol exported by the library with OpenVINO.

inline constexpr const char* load_symbol = "slipbench_load_engine";

// load_engine(); the caller owns the engine.
using LoadEngine = Engine*(const std::string& path);

}  // namespace slipbench::network

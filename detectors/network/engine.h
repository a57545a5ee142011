// What runs a network: OpenVINO, in a library of its own that is loaded when a first network is.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "detectors/network/description.h"

namespace slipbench::network {

// One network with its recurrent state, used by one thread at a time. f32, one thread: the same bits on the same machine; another processor
// may round otherwise.
class Engine {
 public:
  virtual ~Engine() = default;

  [[nodiscard]] virtual const Description& description() const = 0;
  // Values of its input: history times a frame's.
  [[nodiscard]] virtual std::size_t inputs() const = 0;
  // Recurrent state to zero.
  virtual void reset() = 0;
  // One step: the input [inputs()] to the raw output, one value a class. Valid until the next call. Throws InputError where the network is fed
  // or says something that is not finite, or says probabilities that are none.
  virtual std::span<const float> run(std::span<const float> input) = 0;
};

// The network in an ONNX file. The compiled one is kept by each thread for as long as the file stays the same. Throws InputError, naming the
// file: no regular file, too large, no ONNX, custom operators, external data, shapes that do not fit, metadata that is missing (with what to add
// and how) or wrong.
std::unique_ptr<Engine> load_engine(const std::string& path);
// The same without the check that OpenVINO does not crash on the file (check_readable.h): for a process that a crash may end.
std::unique_ptr<Engine> load_engine_unchecked(const std::string& path);
// Whether load_engine() has its library.
bool engine_available();

// The probability of slip: of `output`, by what the description says of it, the sum over the classes that slip. 0 to 1.
double slip_probability(const Description& description, std::span<const float> output);
// The class that the detector says: the most probable of those that slip where `slip` is said, else the most probable of the others.
PadState state_of(const Description& description, std::span<const float> output, bool slip);

// What the library with OpenVINO exports.

inline constexpr const char* load_symbol = "slipbench_load_engine";

// load_engine(); the caller owns the engine.
using LoadEngine = Engine*(const std::string& path);

}  // namespace slipbench::network

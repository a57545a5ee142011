// The register-level core, pin by pin and clock by clock, translated by Verilator. RtlEngine wraps
// it; tests drive it directly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "detectors/hd/engine.h"

namespace slipbench::hd {

// Degree of parallelism: the built variants of the table in rtl/hd/README.md.
enum class Unrolling : std::uint8_t {
  fastest,   // the whole vector and all pillars: a decision after 10 cycles, a sample every cycle
  middle,    // 250 bits, three pillars: 15 cycles, a sample every 4
  smallest,  // 50 bits, one pillar: 37 cycles, a sample every 20
};

// Size of the built cores; hd_core.sv documents each pin.
inline constexpr std::size_t core_dimension = 1000;
inline constexpr std::size_t core_window = 15;

// Cycles from an accepted sample to its decision, without waiting.
unsigned core_latency(Unrolling unrolling);
// Cycles between accepted samples, without waiting.
unsigned core_interval(Unrolling unrolling);

struct CoreInputs {
  bool reset = false;
  bool sample_valid = false;  // `sample` is valid; `sample_first`: it starts a window
  bool sample_first = false;
  FixedFrame sample{};
  bool frame_valid = false;  // the same for a frame that is already quantised
  bool frame_first = false;
  Frame frame{};
  bool ready = true;  // the decision is taken
};

struct CoreOutputs {
  bool sample_ready = false;
  bool frame_ready = false;
  bool valid = false;
  Decision decision;  // while valid
};

class Core {
 public:
  virtual ~Core() = default;

  // Sets the pins to `inputs` and returns the core's outputs before the next clock edge.
  virtual CoreOutputs settle(const CoreInputs& inputs) = 0;

  // Applies the rising edge, then the falling one.
  virtual void clock() = 0;

  // Number of rising edges so far.
  [[nodiscard]] virtual std::uint64_t cycle() const = 0;

  // Starts a waveform of the core in `file` (FST, 10 ns per cycle); stop_trace() ends it. Throws
  // InputError if it cannot be written.
  virtual void start_trace(const std::string& file) = 0;
  virtual void stop_trace() = 0;
};

// Makes a core after its reset, with the memories and the tie rule of a model. Throws InputError
// unless the model is the paper's gstHDC with D = core_dimension, N = core_window, and the memories
// fit it. Without context-driven training all contexts are +1.
std::unique_ptr<Core> make_core(Unrolling unrolling, const Model& model, const Memories& memories);

// Symbol exported by the library of the translated cores. The library is loaded when a core is
// made, because Verilator's models take a sixth of the program's build time and most scenes do not
// need them.

inline constexpr const char* make_core_symbol = "slipbench_make_verilated_core";

// Makes a core after its reset. make_core() has checked `model` and `memories` and filled in the
// contexts. The caller owns the core.
using MakeVerilatedCore = Core*(Unrolling unrolling, const Model& model, const Memories& memories);

}  // namespace slipbench::hd

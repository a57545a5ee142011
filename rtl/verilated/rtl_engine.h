// The register-level core as an engine among the others.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "detectors/hd/engine.h"

namespace slipbench::hd {

// The register-level core, pin by pin and clock by clock, as Verilator translates it. RtlEngine wraps it; tests drive it directly.

// How much of a frame is worked on at once: the points of rtl/hd/README.md's table that are built.
enum class Unrolling : std::uint8_t {
  fastest,   // the whole vector and all pillars: a decision after 10 cycles, a sample every cycle
  middle,    // 250 bits, three pillars: 15 cycles, a sample every 4
  smallest,  // 50 bits, one pillar: 37 cycles, a sample every 20
};

// What hd_core is built for; hd_core.sv says what each pin does.
inline constexpr std::size_t core_dimension = 1000;
inline constexpr std::size_t core_window = 15;

// Cycles from an accepted sample to its decision when nothing waits.
unsigned core_latency(Unrolling unrolling);
// Cycles between accepted samples when nothing waits.
unsigned core_interval(Unrolling unrolling);

struct CoreInputs {
  bool reset = false;
  bool sample_valid = false;  // `sample` is there; `sample_first`: a window starts with it
  bool sample_first = false;
  FixedFrame sample{};
  bool frame_valid = false;  // the same for a frame that is quantised already
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

  // Puts `inputs` on the pins and gives what the core answers before the next clock edge.
  virtual CoreOutputs settle(const CoreInputs& inputs) = 0;

  // The rising edge, and the falling one.
  virtual void clock() = 0;

  // Rising edges so far.
  [[nodiscard]] virtual std::uint64_t cycle() const = 0;

  // Writes a waveform of the core from here on to `file` in FST, 10 ns a cycle; ends it. Throws InputError when it cannot be written.
  virtual void start_trace(const std::string& file) = 0;
  virtual void stop_trace() = 0;
};

// A core after its reset, with the memories and the tie rule of a model. Throws InputError unless the model is gstHDC of the paper with
// D = core_dimension, N = core_window, and the memories fit it. Without context-driven training all contexts are +1.
std::unique_ptr<Core> make_core(Unrolling unrolling, const Model& model, const Memories& memories);

// What the library of the translated cores exports. It is loaded when a core is made: Verilator's models take a sixth of the time to build the
// program, and most scenes need none.

inline constexpr const char* make_core_symbol = "slipbench_make_verilated_core";

// A core after its reset. `model` and `memories` as make_core has checked them, contexts given. The caller owns it.
using MakeVerilatedCore = Core*(Unrolling unrolling, const Model& model, const Memories& memories);

struct RtlOptions {
  Unrolling unrolling = Unrolling::fastest;
  std::shared_ptr<Engine> golden{};  // runs in lockstep: every decision of the core is compared with its own; none: no cost
  std::string trace{};               // FST file; empty: no waveform, and no cost
  std::uint64_t trace_first = 0;     // of the updates since construction, those that the waveform shows
  std::uint64_t trace_count = 0;     // 0: all from the first on
};

class RtlEngine : public Engine {
 public:
  // Through the encoder only, for frames that are quantised already. Throws as Engine::update() does, and as below.
  Decision update(const Frame& frame) override = 0;

  // Through the whole core. Both throw std::logic_error at the first difference between core and golden model and say cycle, expected
  // and actual decision. Later ones are not reported.
  virtual Decision update(const FixedFrame& displacement) = 0;

  // Of the last decision: clock cycles from the accepted sample or frame.
  [[nodiscard]] virtual unsigned cycles() const = 0;
};

// Throws InputError where make_core() does, and when the waveform cannot be written.
std::unique_ptr<RtlEngine> make_rtl_engine(const Model& model, const Memories& memories, const RtlOptions& options = {});

}  // namespace slipbench::hd

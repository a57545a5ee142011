// The register-level core as an engine.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "detectors/hd/engine.h"
#include "rtl/verilated/core.h"

namespace slipbench::hd {

struct RtlOptions {
  Unrolling unrolling = Unrolling::fastest;
  std::shared_ptr<Engine> golden{};  // runs in lockstep, and every decision is compared; null: no comparison, no cost
  std::string trace{};               // FST file; empty: no waveform, no cost
  std::uint64_t trace_first = 0;     // first update since construction that the waveform shows
  std::uint64_t trace_count = 0;     // number of updates shown; 0: all from the first on
};

class RtlEngine : public Engine {
 public:
  // Uses the encoder only, for frames that are already quantised. Throws as Engine::update() does,
  // and as below.
  Decision update(const Frame& frame) override = 0;

  // Uses the whole core. Both throw std::logic_error at the first difference between core and
  // golden model, with cycle, expected and actual decision; later differences are not reported.
  virtual Decision update(const FixedFrame& displacement) = 0;

  // Clock cycles of the last decision, from the accepted sample or frame.
  [[nodiscard]] virtual unsigned cycles() const = 0;
};

// Throws InputError where make_core() does, and if the waveform cannot be written.
std::unique_ptr<RtlEngine> make_rtl_engine(const Model& model, const Memories& memories, const RtlOptions& options = {});

}  // namespace slipbench::hd

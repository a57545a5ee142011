// The register-level core as an engine among the others.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "detectors/hd/engine.h"
#include "rtl/verilated/core.h"

namespace slipbench::hd {

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

#include "rtl/verilated/rtl_engine.h"

#include <stdexcept>

namespace slipbench::hd {
namespace {

std::string text_of(const Decision& decision) {
  std::string text = "class " + std::to_string(static_cast<int>(decision.state)) + ", distances";
  for (const std::uint16_t distance : decision.distance) text += " " + std::to_string(distance);
  return text;
}

class VerilatedEngine : public RtlEngine {
 public:
  VerilatedEngine(const Model& model, const Memories& memories, const RtlOptions& options)
      : options_(options), core_(make_core(options.unrolling, model, memories)) {}

  Decision update(const Frame& frame) override {
    check(frame);
    return decide({.frame_valid = true, .frame_first = restart_, .frame = frame}, frame);
  }

  Decision update(const FixedFrame& displacement) override {
    return decide({.sample_valid = true, .sample_first = restart_, .sample = displacement}, quantise(displacement));
  }

  void reset() override {
    restart_ = true;
    if (options_.golden) options_.golden->reset();
  }

  [[nodiscard]] unsigned cycles() const override { return cycles_; }

 private:
  // Requires an idle core: it accepts at once, and its next decision is this one.
  Decision decide(const CoreInputs& inputs, const Frame& frame) {
    trace();
    core_->settle(inputs);
    accepted_ = core_->cycle();
    core_->clock();
    CoreOutputs outputs = core_->settle({});
    while (!outputs.valid) {
      core_->clock();
      outputs = core_->settle({});
    }
    cycles_ = static_cast<unsigned>(core_->cycle() - accepted_);
    core_->clock();  // takes the decision
    ++updates_;
    restart_ = false;
    compare(frame, outputs.decision);
    return outputs.decision;
  }

  void trace() {
    if (options_.trace.empty()) return;
    if (updates_ == options_.trace_first) core_->start_trace(options_.trace);
    if (options_.trace_count != 0 && updates_ == options_.trace_first + options_.trace_count) core_->stop_trace();
  }

  void compare(const Frame& frame, const Decision& actual) {
    if (!options_.golden) return;
    const Decision expected = options_.golden->update(frame);
    if (actual == expected) return;
    options_.golden.reset();
    throw std::logic_error("rtl core: cycle " + std::to_string(accepted_ + cycles_) + ", update " + std::to_string(updates_ - 1) +
                           ": expected " + text_of(expected) + "; actual " + text_of(actual));
  }

  RtlOptions options_;
  std::unique_ptr<Core> core_;
  std::uint64_t updates_ = 0;
  std::uint64_t accepted_ = 0;  // cycle of the last input
  unsigned cycles_ = 0;
  bool restart_ = false;
};

}  // namespace

std::unique_ptr<RtlEngine> make_rtl_engine(const Model& model, const Memories& memories, const RtlOptions& options) {
  return std::make_unique<VerilatedEngine>(model, memories, options);
}

}  // namespace slipbench::hd

#include <VFastest.h>
#include <VMiddle.h>
#include <VSmallest.h>
#include <verilated.h>
#include <verilated_fst_c.h>

#include <array>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "rtl/verilated/core.h"
#include "sim/core/error.h"

namespace slipbench::hd {
namespace {

// Memories in the order of hd_sim.sv.
enum class MemoryPort : std::uint8_t { item, level, context, associative };

template <class Model>
class VerilatedCore : public Core {
 public:
  VerilatedCore(const hd::Model& model, const Memories& memories) {
    context_.traceEverOn(true);
    top_ = std::make_unique<Model>(&context_);
    top_->clk_i = 0;
    top_->rst_ni = 1;
    top_->tie_one_i = model.ties == Ties::one;
    load(MemoryPort::item, memories.item);
    load(MemoryPort::level, memories.level);
    load(MemoryPort::context, memories.context);
    load(MemoryPort::associative, memories.associative);
    top_->load_i = 0;
    settle({.reset = true});
    clock();
    settle({});
    cycle_ = 0;
  }

  ~VerilatedCore() override {
    stop_trace();
    top_->final();
  }
  VerilatedCore(const VerilatedCore&) = delete;
  VerilatedCore& operator=(const VerilatedCore&) = delete;

  CoreOutputs settle(const CoreInputs& inputs) override {
    top_->rst_ni = !inputs.reset;
    top_->sample_valid_i = inputs.sample_valid;
    top_->sample_first_i = inputs.sample_first;
    if (inputs.sample_valid) set_sample(inputs.sample);
    top_->frame_valid_i = inputs.frame_valid;
    top_->frame_first_i = inputs.frame_first;
    top_->frame_ctx_i = inputs.frame.context;
    top_->frame_level_i = 0;
    for (std::size_t p = 0; p < pillar_count; ++p) top_->frame_level_i |= std::uint64_t{inputs.frame.level[p]} << (5 * p);
    top_->ready_i = inputs.ready;
    evaluate();
    CoreOutputs outputs{.sample_ready = top_->sample_ready_o != 0,
                        .frame_ready = top_->frame_ready_o != 0,
                        .valid = top_->valid_o != 0,
                        .decision = {}};
    if (outputs.valid) {
      outputs.decision.state = static_cast<PadState>(top_->class_o);
      for (std::size_t k = 0; k < class_count; ++k) {
        outputs.decision.distance[k] = static_cast<std::uint16_t>(top_->distance_o >> (10 * k) & 1023U);
      }
    }
    return outputs;
  }

  void clock() override {
    context_.timeInc(5);
    top_->clk_i = 1;
    evaluate();
    context_.timeInc(5);
    top_->clk_i = 0;
    ++cycle_;
  }

  [[nodiscard]] std::uint64_t cycle() const override { return cycle_; }

  void start_trace(const std::string& file) override {
    // Verilator does not report a file that it cannot open.
    if (!std::ofstream(file)) throw InputError(file + ": cannot be written");
    trace_.emplace();
    top_->trace(&*trace_, 99);
    trace_->open(file.c_str());
  }

  void stop_trace() override {
    if (trace_) trace_->close();
    trace_.reset();
  }

 private:
  void evaluate() {
    top_->eval();
    if (trace_) trace_->dump(context_.time());
  }

  void load(MemoryPort port, const std::vector<Hypervector>& rows) {
    top_->load_i = 1;
    top_->load_memory_i = static_cast<std::uint8_t>(port);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      top_->load_row_i = static_cast<std::uint8_t>(row);
      for (std::size_t word = 0; word < (core_dimension + 31) / 32; ++word) {
        top_->load_vector_i[word] = static_cast<std::uint32_t>(rows[row].words()[word / 2] >> (32 * (word % 2)));
      }
      evaluate();
      clock();
    }
  }

  // Layout of hd_pkg's disp_t: x lowest, pillar 0 lowest, 48 bits per pillar, three halves of a
  // 32-bit word.
  void set_sample(const FixedFrame& sample) {
    std::array<std::uint16_t, 3 * pillar_count + 1> halves{};
    for (std::size_t p = 0; p < pillar_count; ++p) {
      for (std::size_t axis = 0; axis < 3; ++axis) halves[3 * p + axis] = static_cast<std::uint16_t>(sample[p][axis]);
    }
    for (std::size_t word = 0; word < halves.size() / 2; ++word) {
      top_->sample_disp_i[word] = halves[2 * word] | std::uint32_t{halves[2 * word + 1]} << 16;
    }
  }

  VerilatedContext context_;
  std::unique_ptr<Model> top_;
  std::optional<VerilatedFstC> trace_;
  std::uint64_t cycle_ = 0;
};

}  // namespace
}  // namespace slipbench::hd

extern "C" __attribute__((visibility("default"))) slipbench::hd::Core* slipbench_make_verilated_core(
    slipbench::hd::Unrolling unrolling, const slipbench::hd::Model& model, const slipbench::hd::Memories& memories) {
  using namespace slipbench::hd;
  switch (unrolling) {
    case Unrolling::fastest: return new VerilatedCore<VFastest>(model, memories);
    case Unrolling::middle: return new VerilatedCore<VMiddle>(model, memories);
    case Unrolling::smallest: return new VerilatedCore<VSmallest>(model, memories);
  }
  throw std::logic_error("rtl core: no such unrolling");
}

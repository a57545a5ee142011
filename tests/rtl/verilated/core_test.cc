// The core pin by pin: a stream with back-pressure, gaps and resets against the golden model, and
// its timing.
#include "rtl/verilated/rtl_engine.h"

#include <deque>
#include <optional>

#include "sim/core/random.h"
#include "tests/detectors/hd/random_frames.h"
#include "tests/expect.h"

namespace slipbench::hd {
namespace {

constexpr std::uint64_t seed = 1;
#ifdef SLIPBENCH_SANITIZED
constexpr std::uint64_t ticks = 125'000;  // sanitizers slow the harness and the golden model down
#else
constexpr std::uint64_t ticks = 1'000'000;
#endif
constexpr std::array unrollings{Unrolling::fastest, Unrolling::middle, Unrolling::smallest};

Frame random_frame(RandomStream& random) {
  Frame frame;
  for (std::uint8_t& level : frame.level) level = static_cast<std::uint8_t>(random.integer(level_count));
  frame.context = static_cast<std::uint8_t>(random.integer(context_count));
  return frame;
}

// Samples over the whole range, around zero where contexts change and ratios are coarse, and at the
// ends of the range.
FixedFrame random_sample(RandomStream& random) {
  FixedFrame sample;
  for (FixedVector& displacement : sample) {
    const std::uint64_t kind = random.integer(8);
    for (std::int16_t& value : displacement) {
      if (kind == 0) {
        value = static_cast<std::int16_t>(random.integer(2) == 0 ? -32768 : 32767);
      } else {
        const std::uint64_t span = std::uint64_t{1} << (2 * kind + 2);
        value = static_cast<std::int16_t>(static_cast<std::int64_t>(random.integer(span)) - static_cast<std::int64_t>(span / 2));
      }
    }
  }
  return sample;
}

// Drives a core for `ticks` accepted inputs and compares its outputs, in order, with the golden
// model's.
class Stream {
 public:
  Stream(Unrolling unrolling, const Model& model)
      : core_(make_core(unrolling, model, random_memories(model, seed))),
        golden_(make_kernel(model, random_memories(model, seed))) {}

  void run(std::uint64_t ticks) {
    for (std::uint64_t accepted = 0; accepted < ticks && !::testing::Test::HasFailure();) accepted += cycle();
  }

 private:
  // Returns true if an input was accepted. One in 4,096 cycles resets the core; each stretch of 64
  // cycles has its own pace at either side.
  bool cycle() {
    if (core_->cycle() % 64 == 0) {
      source_pace_ = random_.integer(4);
      sink_pace_ = random_.integer(4);
    }
    if (random_.integer(4096) == 0) {
      core_->settle({.reset = true});
      core_->clock();
      expected_.clear();
      held_.reset();
      offered_ = {};
      golden_->reset();
      return false;
    }
    // An offered input stays until it is accepted: valid does not wait for ready.
    const bool offers = offered_.sample_valid || offered_.frame_valid;
    if (!offers && may_offer() && random_.integer(source_pace_ + 1) == 0) offer();
    CoreInputs inputs = offered_;
    inputs.ready = random_.integer(sink_pace_ + 1) == 0;
    const CoreOutputs outputs = core_->settle(inputs);
    receive(outputs, inputs.ready);
    const bool accepted = (inputs.sample_valid && outputs.sample_ready) || (inputs.frame_valid && outputs.frame_ready);
    if (accepted) accept();
    core_->clock();
    return accepted;
  }

  // Samples and frames come in runs of one kind, with the core drained in between, because a frame
  // would overtake the samples before it.
  bool may_offer() {
    if (random_.integer(512) == 0) draining_ = true;
    if (draining_ && expected_.empty()) {
      draining_ = false;
      samples_ = !samples_;
    }
    return !draining_;
  }

  void offer() {
    const bool first = random_.integer(200) == 0;
    if (samples_) {
      offered_ = {.sample_valid = true, .sample_first = first, .sample = random_sample(random_)};
    } else {
      offered_ = {.frame_valid = true, .frame_first = first, .frame = random_frame(random_)};
    }
  }

  void accept() {
    if (offered_.sample_first || offered_.frame_first) golden_->reset();
    expected_.push_back(golden_->update(samples_ ? quantise(offered_.sample) : offered_.frame));
    offered_ = {};
  }

  void receive(const CoreOutputs& outputs, bool ready) {
    if (held_) {
      ASSERT_TRUE(outputs.valid) << "cycle " << core_->cycle() << ": a decision left before it was taken";
      ASSERT_EQ(outputs.decision, *held_) << "cycle " << core_->cycle() << ": a decision changed before it was taken";
    }
    held_.reset();
    if (!outputs.valid) return;
    ASSERT_FALSE(expected_.empty()) << "cycle " << core_->cycle() << ": a decision of nothing";
    ASSERT_EQ(outputs.decision, expected_.front()) << "cycle " << core_->cycle();
    if (ready) {
      expected_.pop_front();
    } else {
      held_ = outputs.decision;
    }
  }

  std::unique_ptr<Core> core_;
  std::unique_ptr<Engine> golden_;
  RandomStream random_{seed, 0, "rtl stream"};
  CoreInputs offered_;
  std::deque<Decision> expected_;
  std::optional<Decision> held_;
  std::uint64_t source_pace_ = 0;
  std::uint64_t sink_pace_ = 0;
  bool samples_ = true;
  bool draining_ = false;
};

class Unrolled : public testing::TestWithParam<Unrolling> {};
const char* name_of(const testing::TestParamInfo<Unrolling>& test) {
  return test.param == Unrolling::fastest ? "Fastest" : test.param == Unrolling::middle ? "Middle" : "Smallest";
}
INSTANTIATE_TEST_SUITE_P(Core, Unrolled, testing::ValuesIn(unrollings), name_of);

// `ticks` inputs in total, over all unrollings and both rules for ties.
TEST_P(Unrolled, StreamsAsTheGoldenModelDoes) {
  Model model;
  for (const Ties ties : {Ties::one, Ties::zero}) {
    model.ties = ties;
    Stream(GetParam(), model).run(ticks / 6 + 1);
  }
}

// A core that is offered a sample at exactly its interval never delays one, and no decision is
// late.
TEST_P(Unrolled, TakesASampleEveryIntervalAndDecidesAfterItsLatency) {
  const auto core = make_core(GetParam(), Model{}, random_memories(Model{}, seed));
  RandomStream random(seed, 0, "rtl timing");
  std::deque<std::uint64_t> accepted;
  for (int decisions = 0; decisions < 40;) {
    const bool offers = core->cycle() % core_interval(GetParam()) == 0;
    const CoreOutputs outputs = core->settle({.sample_valid = offers, .sample = random_sample(random)});
    if (offers) {
      ASSERT_TRUE(outputs.sample_ready) << "cycle " << core->cycle();
      accepted.push_back(core->cycle());
    }
    if (outputs.valid) {
      ASSERT_EQ(core->cycle() - accepted.front(), core_latency(GetParam()));
      accepted.pop_front();
      ++decisions;
    }
    core->clock();
  }
}

// The published core takes 42 cycles; the limit for the fastest one is 10, at a sample per cycle.
TEST(Core, KeepsItsBarsOfLatency) {
  EXPECT_LE(core_latency(Unrolling::fastest), 10U);
  EXPECT_EQ(core_interval(Unrolling::fastest), 1U);
  EXPECT_LE(core_latency(Unrolling::smallest), 42U);
}

// A sample in every stage, then a reset: none of them produces an output, and the next window
// starts with its own first sample.
TEST_P(Unrolled, ForgetsAllAtAReset) {
  const auto core = make_core(GetParam(), Model{}, random_memories(Model{}, seed));
  const auto golden = make_reference(Model{}, random_memories(Model{}, seed));
  RandomStream random(seed, 0, "rtl reset");
  for (unsigned cycle = 0; cycle < 30 * core_latency(GetParam()); ++cycle) {
    core->settle({.sample_valid = true, .sample = random_sample(random)});
    core->clock();
  }
  ASSERT_FALSE(core->settle({.reset = true}).valid);
  core->clock();
  for (unsigned cycle = 0; cycle < 2 * core_latency(GetParam()); ++cycle) {
    ASSERT_FALSE(core->settle({}).valid);
    core->clock();
  }
  for (std::size_t sample = 0; sample <= core_window; ++sample) {
    const FixedFrame displacement = random_sample(random);
    core->settle({.sample_valid = true, .sample = displacement});
    core->clock();
    CoreOutputs outputs = core->settle({});
    while (!outputs.valid) {
      core->clock();
      outputs = core->settle({});
    }
    core->clock();
    ASSERT_EQ(outputs.decision, golden->update(quantise(displacement)));
    ASSERT_EQ(outputs.decision.state == PadState::no_contact, sample + 1 < core_window);
  }
}

TEST(Core, RefusesModelsThatItIsNotBuiltFor) {
  const auto message = [](const Model& model) {
    return refusal_of([&] { make_core(Unrolling::fastest, model, random_memories(model, seed)); });
  };
  EXPECT_THAT(message({.dimension = 512}), refused_at("rtl core", {"512", "15", "1000"}));
  EXPECT_THAT(message({.window = 7}), refused_at("rtl core", {"7", "15", "1000"}));
  EXPECT_THAT(message({.encoding = Encoding::spatial}), refused_at("rtl core", {"graph_spatial_temporal", "paper"}));
  EXPECT_THAT(message({.compat = Compat::published_core}), refused_at("rtl core", {"graph_spatial_temporal", "paper"}));
  EXPECT_EQ(message({}), "accepted");
}

}  // namespace
}  // namespace slipbench::hd

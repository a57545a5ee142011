#include "tools/program/run/trial_run.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

// Answers frame k with the k-th of the given latencies, the last for all that follow; states go round non_slip, incipient, gross.
class Scripted : public Detector {
 public:
  explicit Scripted(std::vector<double> latencies) : latencies_(std::move(latencies)) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_ = {frame.time, latencies_[std::min(frames_, latencies_.size() - 1)], static_cast<PadState>(1 + frames_ % 3)};
    ++frames_;
    return estimate_;
  }

 private:
  std::vector<double> latencies_;
  std::size_t frames_ = 0;
  SlipEstimate estimate_;
};

DelayedDetector detector_with(std::vector<double> latencies) {
  return DelayedDetector(std::make_unique<Scripted>(std::move(latencies)));
}

// The first tick that sees the frame of tick k is k + ceil(latency / step). One frame a tick.
TEST(DelayedDetector, SeesAnEstimateAtTheFirstTickAfterItsLatency) {
  struct Case {
    double latency;  // in steps
    std::size_t late;
  };
  for (const double step : {1e-3, 1e-4, 1.0 / 3000.0, 0.7e-3}) {
    // The third is a microsecond at steps of a millisecond.
    for (const Case c : {Case{0.0, 0}, {1e-3, 1}, {0.999, 1}, {1.0, 1}, {1.001, 2}, {2.0, 2}, {2.5, 3}, {15.0, 15}}) {
      DelayedDetector detector = detector_with({c.latency * step});
      for (std::size_t tick = 0; tick < 20'000; ++tick) {
        const double time = static_cast<double>(tick) * step;
        detector.update({time, {}});
        const SlipEstimate& seen = detector.seen_at(time);
        if (tick < c.late) {
          ASSERT_EQ(seen.state, PadState::no_contact);
          continue;
        }
        const std::size_t from = tick - c.late;
        ASSERT_EQ(seen.time, static_cast<double>(from) * step) << c.latency << " steps of " << step << " s, tick " << tick;
        ASSERT_EQ(seen.state, static_cast<PadState>(1 + from % 3));
      }
    }
  }
}

// Hands on the number of its frame, of which it keeps one copy: an estimate under way must hold its own.
class Numbering final : public Detector {
 public:
  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    estimate_.latency = 2.5e-3;
    estimate_.features = {static_cast<double>(frames_++)};
    return estimate_;
  }
  [[nodiscard]] const std::vector<Feature>& features() const override { return features_; }

 private:
  std::vector<Feature> features_{{"number", "frames"}};
  SlipEstimate estimate_;
  std::size_t frames_ = 0;
};

// 2.5 ms late, frames and ticks a millisecond apart: at tick k the number k - 3.
TEST(DelayedDetector, FeaturesAreThoseOfTheEstimateThatIsSeen) {
  DelayedDetector detector(std::make_unique<Numbering>());
  ASSERT_EQ(detector.features().size(), 1U);
  EXPECT_EQ(detector.features().front().name, "number");
  for (std::size_t tick = 0; tick < 20; ++tick) {
    const double time = 1e-3 * static_cast<double>(tick);
    detector.update({time, {}});
    const std::vector<double>& seen = detector.seen_at(time).features;
    if (tick < 3) {
      EXPECT_TRUE(seen.empty());
    } else {
      EXPECT_EQ(seen, std::vector<double>{static_cast<double>(tick - 3)});
    }
  }
}

// The sensor samples every fourth tick: the same estimate is seen until the next one is there.
TEST(DelayedDetector, KeepsTheLatestEstimateBetweenSamples) {
  DelayedDetector detector = detector_with({2.5e-3});
  for (std::size_t tick = 0; tick < 40; ++tick) {
    const double time = 1e-3 * static_cast<double>(tick);
    if (tick % 4 == 0) detector.update({time, {}});
    const SlipEstimate& seen = detector.seen_at(time);
    if (tick < 3) {
      EXPECT_EQ(seen.state, PadState::no_contact);
    } else {
      EXPECT_EQ(seen.time, 1e-3 * static_cast<double>((tick - 3) / 4 * 4)) << tick;
    }
  }
}

// The frame of tick 0 takes 5 ticks, that of tick 1 one: from tick 2 on the later one is seen, and the earlier never again.
TEST(DelayedDetector, NeverGoesBackToAnOlderFrame) {
  DelayedDetector detector = detector_with({5e-3, 1e-3, 100.0});
  std::vector<double> seen;
  for (std::size_t tick = 0; tick < 10; ++tick) {
    const double time = 1e-3 * static_cast<double>(tick);
    if (tick < 2) detector.update({time, {}});
    const SlipEstimate& estimate = detector.seen_at(time);
    seen.push_back(estimate.state == PadState::no_contact ? -1.0 : estimate.time);
  }
  EXPECT_EQ(seen, (std::vector{-1.0, -1.0, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3}));
}

TEST(DelayedDetector, ALatencyThatCannotBeIsABug) {
  for (const double latency : {-1e-9, std::numeric_limits<double>::quiet_NaN()}) {
    DelayedDetector detector = detector_with({latency});
    EXPECT_THROW(detector.update({0.0, {}}), std::logic_error);
  }
  DelayedDetector never = detector_with({std::numeric_limits<double>::infinity()});
  never.update({0.0, {}});
  EXPECT_EQ(never.seen_at(1e9).state, PadState::no_contact);
}

TEST(DelayedDetector, AnOlderEstimateIsABug) {
  DelayedDetector detector = detector_with({0.0});
  detector.update({2e-3, {}});
  EXPECT_THROW(detector.update({1e-3, {}}), std::logic_error);
}

}  // namespace
}  // namespace slipbench

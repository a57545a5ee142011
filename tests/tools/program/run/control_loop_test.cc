// The loop's delays, tick by tick, with the real gripper and a controller that writes down what it is handed.
#include "tools/program/run/control_loop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "sim/core/error.h"
#include "sim/grasp/grasp.h"
#include "sim/motion/guided.h"

namespace slipbench {
namespace {

constexpr double step = 2e-4;  // s

Parameters grip_defaults() { return defaults_of(std::ranges::find(grasp_catalogue(), "grip", &Entry::name)->parameters); }

class BareGripper : public HeldBox {
 public:
  explicit BareGripper(double phase) : gripper_(grip_defaults(), 0.08, phase) {}
  Gripper& gripper() override { return gripper_; }
  [[nodiscard]] const GraspTruth& truth() const override { return truth_; }
  [[nodiscard]] double ideal_force() const override { return 1.0; }
  [[nodiscard]] double lift_start() const override { return 1.0; }

 private:
  Gripper gripper_;
  GraspTruth truth_;
};

struct Handed {
  double frame_time, slip_time, read_time;
  int position;
};

// One count further each time, or the position `wrong` if that is no byte.
class Notes final : public Controller {
 public:
  explicit Notes(std::vector<Handed>& handed, int wrong = 0) : handed_(handed), wrong_(wrong) {}
  GripCommand update(const ControlInput& input) override {
    handed_.push_back({input.frame.time, input.slip.time, input.gripper.time, input.gripper.position});
    return {.position = wrong_ != 0 ? wrong_ : input.gripper.position + 1};
  }

 private:
  std::vector<Handed>& handed_;
  int wrong_;
};

// Says of a frame `latency` after it that it slips.
class Late final : public Detector {
 public:
  explicit Late(double latency) : latency_(latency) {}
  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_ = {.time = frame.time, .latency = latency_, .state = PadState::gross};
    return estimate_;
  }

 private:
  double latency_;  // s
  SlipEstimate estimate_;
};

// Runs ticks 0 to `ticks` - 1 with a frame every 10 ms; returns the first time at which the fingers move.
double run(ControlLoop& loop, HeldBox& box, std::size_t ticks) {
  double moved = std::nan("");
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const double time = static_cast<double>(tick) * step;
    const SensorFrame frame{time, {}};
    const Tick now{0, time, tick % 50 == 0 ? &frame : nullptr};
    loop.update({&now, 1});
    box.gripper().update(time, 0.0);
    if (std::isnan(moved) && box.gripper().opening_speed(time) < 0.0) moved = time;
    loop.act({&now, 1});
  }
  return moved;
}

// Phase 3.1 ms, period 20 ms, write 10 ms after the read, latency 20 ms: reads at 3.1, 23.1 and 43.1 ms; what follows from the first is
// written at 13.1 and acts from 33.1 ms on. No instant falls on a tick: the next one (0.2 ms) does it, and the drive moves from the instant.
TEST(ControlLoop, DelaysAreThoseOfTheScene) {
  BareGripper box(3.1e-3);
  const int start = box.gripper().position(0.0);
  std::vector<Handed> handed;
  ControlLoop loop(DelayedDetector(std::make_unique<Late>(0.015)), 0, std::make_unique<Notes>(handed), &box);
  const double moved = run(loop, box, 240);  // to 47.8 ms
  ASSERT_EQ(handed.size(), 3U);
  const double reads[] = {3.1e-3, 23.1e-3, 43.1e-3};
  const double frames[] = {0.0, 20e-3, 40e-3};  // the latest
  const double seen[] = {0.0, 0.0, 20e-3};      // estimates are 15 ms late: at 23.2 ms that of 0 ms, at 43.2 ms that of 20 ms
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(handed[k].read_time, reads[k], 1e-12);
    EXPECT_NEAR(handed[k].frame_time, frames[k], 1e-12);
    EXPECT_NEAR(handed[k].slip_time, seen[k], 1e-12);
  }
  EXPECT_EQ(loop.seen(), PadState::gross);
  // Seen at the first tick after 33.1 ms at which it has a speed.
  EXPECT_GT(moved, 33.1e-3);
  EXPECT_LE(moved, 33.1e-3 + step);
  EXPECT_EQ(loop.written().position, start + 1);
  EXPECT_EQ(loop.measured_position(), handed.back().position);
  // The second read still measures the start, so that its command is the first one's again and tightens nothing.
  EXPECT_NEAR(loop.tightening().read_time, 3.1e-3, 1e-12);
  EXPECT_NEAR(loop.tightening().start_time, 33.1e-3, 1e-12);
}

TEST(ControlLoop, ADetectorIsFedByItsOwnPadAlone) {
  ControlLoop loop(DelayedDetector(std::make_unique<Late>(0.0)), 1);
  const SensorFrame frame{0.0, {}};
  for (const std::size_t pad : {0U, 1U}) {
    const Tick tick{pad, 0.0, &frame};
    loop.update({&tick, 1});
    loop.act({&tick, 1});
    EXPECT_EQ(loop.seen(), pad == 1 ? PadState::gross : PadState::no_contact);
  }
}

TEST(ControlLoop, WithoutAControllerNothingMoves) {
  BareGripper box(3e-3);
  const int start = box.gripper().position(0.0);
  ControlLoop loop({}, 0, nullptr, &box);
  EXPECT_FALSE(loop.has_detector());
  EXPECT_TRUE(std::isnan(run(loop, box, 500)));
  EXPECT_EQ(loop.written().position, start);
  EXPECT_EQ(loop.measured_position(), start);
  EXPECT_EQ(loop.seen(), PadState::no_contact);
}

// The same gripper on an arm of 8 ms latency and 0.2 m/s2.
class GuidedGripper final : public BareGripper {
 public:
  using BareGripper::BareGripper;
  Guided* arm() override { return &arm_; }

 private:
  Guided arm_{defaults_of(guided_motion().about.parameters)};
};

// Says 10 mm/s upwards at its second update, and nothing of the arm else.
class Raising final : public Controller {
 public:
  GripCommand update(const ControlInput& input) override {
    GripCommand command{.position = input.gripper.position};
    if (++updates_ == 2) command.arm = {.sideways = 0.0, .up = 10e-3};
    return command;
  }

 private:
  int updates_ = 0;
};

// Read at 23.1 ms, written at 33.1 ms, obeyed from 41.1 ms on: the third command, which says nothing of the arm, leaves it as it is.
TEST(ControlLoop, TheArmIsToldWithTheWrite) {
  GuidedGripper box(3.1e-3);
  ControlLoop loop({}, 0, std::make_unique<Raising>(), &box);
  run(loop, box, 400);
  EXPECT_EQ(loop.arm_command().up, 10e-3);
  EXPECT_EQ(loop.arm_command().sideways, 0.0);
  EXPECT_NEAR(box.arm()->lift_start(), 41.1e-3, 1e-12);
  EXPECT_NEAR(box.arm()->pad_at(1.0911).pose.position.z(), 10.25e-3, 1e-12);  // 50 ms and 0.25 mm of it on the ramp
}

TEST(ControlLoop, NoControllerCommandsAnArmThatIsPrescribed) {
  BareGripper box(0.0);
  ControlLoop loop({}, 0, std::make_unique<Raising>(), &box);
  EXPECT_THROW(run(loop, box, 400), std::logic_error);
}

TEST(ControlLoop, CommandThatIsNoByteEndsTheRun) {
  BareGripper box(0.0);
  std::vector<Handed> handed;
  ControlLoop loop({}, 0, std::make_unique<Notes>(handed, 256), &box);
  EXPECT_THROW(run(loop, box, 100), InputError);
}

}  // namespace
}  // namespace slipbench

// The arm that a controller commands: trapezoids from the instants of the commands.
#include "sim/motion/guided.h"

#include <cmath>

#include "tests/expect.h"

namespace slipbench::guided_test {
namespace {

// 8 ms late, 0.2 m/s2, at most 0.1 m/s.
Guided arm() { return Guided(defaults_of(guided_motion().about.parameters)); }

TEST(Guided, RestsUntilTold) {
  const Guided resting = arm();
  EXPECT_EQ(resting.pad_at(1e3).pose.position, Eigen::Vector3d::Zero());
  EXPECT_EQ(resting.pad_at(1e3).velocity, Eigen::Vector3d::Zero());
  EXPECT_TRUE(std::isinf(resting.lift_start()));
  EXPECT_FALSE(resting.turns());
}

// 10 mm/s up from a write at 1 s on: 50 ms of 0.2 m/s2 after the latency, 0.25 mm, then 10 mm/s.
TEST(Guided, EachCommandIsARampAfterTheLatency) {
  Guided moving = arm();
  moving.write(1.0, {.sideways = 0.0, .up = 10e-3});
  EXPECT_DOUBLE_EQ(moving.lift_start(), 1.008);
  EXPECT_EQ(moving.pad_at(1.008).velocity.z(), 0.0);
  EXPECT_NEAR(moving.pad_at(1.033).velocity.z(), 5e-3, 1e-15);
  EXPECT_NEAR(moving.pad_at(1.058).pose.position.z(), 0.25e-3, 1e-15);
  EXPECT_NEAR(moving.pad_at(2.058).pose.position.z(), 10.25e-3, 1e-14);
  // The same again changes nothing, and sideways is an axis of its own: -20 mm/s takes 100 ms and 1 mm.
  moving.write(2.0, {.sideways = 0.0, .up = 10e-3});
  moving.write(2.05, {.sideways = -20e-3, .up = 10e-3});
  EXPECT_NEAR(moving.pad_at(3.158).pose.position.y(), -21e-3, 1e-14);
  EXPECT_NEAR(moving.pad_at(3.158).pose.position.z(), 21.25e-3, 1e-14);
  EXPECT_EQ(moving.pad_at(3.158).pose.position.x(), 0.0);
  EXPECT_DOUBLE_EQ(moving.lift_start(), 1.008);
}

// Told to stop at half of the ramp, 25 ms and 0.0625 mm in, it brakes for as long and as far again.
TEST(Guided, ACommandCutsTheRampOfTheLastOneShort) {
  Guided stopped = arm();
  stopped.write(0.0, {.sideways = 0.0, .up = 10e-3});
  stopped.write(0.025, {});
  EXPECT_NEAR(stopped.pad_at(0.033).velocity.z(), 5e-3, 1e-15);
  EXPECT_NEAR(stopped.pad_at(10.0).pose.position.z(), 0.125e-3, 1e-15);
  EXPECT_EQ(stopped.pad_at(10.0).velocity.z(), 0.0);
}

TEST(Guided, RefusesWhatIsTooFast) {
  Guided slow = arm();
  EXPECT_NO_THROW(slow.write(0.0, {.sideways = -0.1, .up = 0.1}));
  for (const double speed : {0.101, -0.101, std::nan("")}) {
    EXPECT_THROW(slow.write(0.0, {.sideways = 0.0, .up = speed}), SceneValueError);
    EXPECT_THROW(slow.write(0.0, {.sideways = speed, .up = 0.0}), SceneValueError);
  }
  EXPECT_EQ(scene_refusal_of([&] { slow.write(0.5, {.sideways = 0.0, .up = 0.2}); }),
            "motion.top_speed | "
            "motion.top_speed: the arm was told to move at 0.2 m/s at 0.5 s; allowed: up to 0.1 m/s");
}

}  // namespace
}  // namespace slipbench::guided_test

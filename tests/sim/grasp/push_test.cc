// The force of a scene on a grasp's box over time.
#include <gtest/gtest.h>

#include "sim/grasp/push.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

// Rises to 4 N from 1 s to 1.2 s, stays until 1.5 s and ends at once.
Push trapezoid() { return Push({"", {{1.0, 0.0, 0.0, 0.0}, {1.2, 4.0, 0.0, -8.0}, {1.5, 4.0, 0.0, -8.0}}}); }

TEST(Push, MeanIsTheImpulseOverTheTime) {
  const Push push = trapezoid();
  // The whole push: 4 N (0.2/2 + 0.3) s = 1.6 N s.
  EXPECT_LT((push.mean(0.0, 2.0) - Eigen::Vector3d(0.8, 0.0, -1.6)).norm(), 1e-12);
  // On the ramp the mean is the force at the middle: 4 N 0.05/0.2.
  EXPECT_LT((push.mean(1.04, 1.06) - Eigen::Vector3d(1.0, 0.0, -2.0)).norm(), 1e-12);
  // Across the corner at 1.2 s: 3.9 N before it in the mean, 4 N after it.
  EXPECT_NEAR(push.mean(1.19, 1.21).x(), 3.95, 1e-12);
  EXPECT_EQ(push.mean(0.5, 1.0).norm(), 0.0);
  EXPECT_EQ(push.mean(1.5, 2.0).norm(), 0.0);
}

// A knock of 2 ms within a step of 10 ms keeps its impulse: 100 N 1 ms = 0.1 N s.
TEST(Push, KnockShorterThanTheStepKeepsItsImpulse) {
  const Push knock({"", {{1.003, 0.0, 0.0, 0.0}, {1.004, 100.0, 0.0, 0.0}, {1.005, 0.0, 0.0, 0.0}}});
  EXPECT_NEAR(knock.mean(1.0, 1.01).x() * 0.01, 0.1, 1e-12);
}

TEST(Push, RefusesWhatIsNoTimetable) {
  EXPECT_TRUE(Push({}).empty());
  EXPECT_THAT(refusal_of([] { (void)Push({"", {{1.0, 0.0, 0.0, 0.0}}}); }), refused_at("box.push", {"single time", "two"}));
  EXPECT_THAT(refusal_of([] {
                (void)Push({"", {{2.0, 0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}});
              }),
              refused_at("box.push", {"row 2", "1 s", "2 s"}));
}

}  // namespace
}  // namespace slipbench

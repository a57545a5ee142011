// The gripper's drive against closed forms: times of reads and writes, durations of motions, stops.
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/grasp/grasp.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

constexpr double count = 0.374e-3;  // m

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

Parameters grip(const Changes& changes = {}) {
  for (const Entry& entry : grasp_catalogue()) {
    if (entry.name != "grip") continue;
    Parameters result = defaults_of(entry.parameters);
    for (const auto& [name, value] : changes) result.set(name, value);
    return result;
  }
  throw std::logic_error("no entry");
}

// At 20 mm/s and 0.5 m/s^2 the ramps are 40 ms and 0.4 mm each.
constexpr double speed = 0.02, acceleration = 0.5;

// A gripper at whole counts: position 100 is an opening of 130 counts.
Gripper at_100(const Changes& changes = {}, double phase = 0.0) { return {grip(changes), 130.0 * count, phase}; }

double counts(const Gripper& gripper, double t) { return 230.0 - gripper.opening(t) / count; }

std::string refusal(Gripper& gripper, const GripCommand& command) {
  return refusal_of([&] { gripper.write(command); });
}

TEST(Gripper, BeginsAtAWholeCountThatIsWideEnough) {
  EXPECT_NEAR(at_100().opening(0.0), 130.0 * count, 1e-15);
  const Gripper wider(grip(), 130.2 * count, 0.0);
  EXPECT_NEAR(wider.opening(0.0), 131.0 * count, 1e-15);
  EXPECT_EQ(wider.opening_speed(0.0), 0.0);
  EXPECT_NEAR(Gripper(grip(), 1.0, 0.0).opening(0.0), 227.0 * count, 1e-15) << "the open stop is at 3";
}

TEST(Gripper, ReadsAndWritesFallOnTheirInstants) {
  Gripper gripper = at_100({}, 3e-3);
  EXPECT_FALSE(gripper.read_due(2.9e-3));
  EXPECT_TRUE(gripper.read_due(3e-3));
  EXPECT_EQ(gripper.read().time, 3e-3);
  EXPECT_FALSE(gripper.read_due(22e-3));
  EXPECT_FALSE(gripper.write_due(12.9e-3));
  EXPECT_TRUE(gripper.write_due(13e-3));
  gripper.write({100, 0, 0});
  EXPECT_NEAR(gripper.next_write(), 33e-3, 1e-15);
  EXPECT_NEAR(gripper.next_read(), 23e-3, 1e-15);
  // A million periods later times are still exact to a millionth of a tick.
  Gripper late = at_100();
  for (int n = 0; n < 1000000; ++n) late.read();
  EXPECT_NEAR(late.next_read(), 2e4, 1e-10);
}

TEST(Gripper, OneCountIsATriangle) {
  // Written at 10 ms, the command takes effect at 30 ms. 0.374 mm is less than the 0.8 mm of both
  // ramps: 2 sqrt(d/a) = 54.7 ms.
  Gripper gripper = at_100();
  gripper.write({101, 0, 0});
  const double half = std::sqrt(count / acceleration);
  gripper.update(0.03, 0.0);
  EXPECT_NEAR(counts(gripper, 0.03), 100.0, 1e-12);
  EXPECT_NEAR(counts(gripper, 0.03 + half), 100.5, 1e-12);
  EXPECT_NEAR(gripper.opening_speed(0.03 + half), -std::sqrt(count * acceleration), 1e-15);
  EXPECT_LT(counts(gripper, 0.03 + 1.99 * half), 101.0);
  EXPECT_NEAR(counts(gripper, 0.03 + 2.0 * half), 101.0, 1e-12);
  EXPECT_NEAR(counts(gripper, 10.0), 101.0, 1e-12);
}

TEST(Gripper, FullStrokeTakesItsTimeAtTheSlowestAndAtTheFastest) {
  // d/v + v/a, from the open stop at 3 to the closed one at 230, where 255 ends, too.
  for (const auto& [reg, v] : {std::pair{0, 0.02}, std::pair{255, 0.15}, std::pair{51, 0.046}}) {
    Gripper gripper(grip(), 1.0, 0.0);
    gripper.write({255, reg, 255});
    const double time = 227.0 * count / v + v / acceleration;
    gripper.update(0.03, 0.0);
    EXPECT_NEAR(gripper.opening(0.03 + 0.5 * time), 113.5 * count, 1e-15);
    EXPECT_GT(gripper.opening(0.03 + time - 1e-3), 1e-7);
    EXPECT_NEAR(gripper.opening(0.03 + time), 0.0, 1e-15);
    gripper.update(10.0, 0.0);
    while (gripper.next_read() < 10.0) gripper.read();
    const GripperStatus status = gripper.read();
    EXPECT_EQ(status.position, 230);
    EXPECT_FALSE(status.moving);
    EXPECT_FALSE(status.stopped);
  }
}

TEST(Gripper, AtMeasuredPlusOneItClosesByOneCountEvery60Milliseconds) {
  // Read at 0, written at 10 ms, it moves from 30 ms on. A read rounds up past half a count, after
  // sqrt(d/a) = 27.3 ms, so the read at 60 ms is the first to see it: 6.23 mm/s for any motor.
  Gripper gripper = at_100();
  std::vector<int> seen;
  for (double time = 0.0; time < 0.6; time += 1e-3) {
    gripper.update(time, 0.0);
    if (gripper.read_due(time)) seen.push_back(gripper.read().position);
    if (gripper.write_due(time)) gripper.write({seen.back() + 1, 0, 0});
  }
  ASSERT_EQ(seen.size(), 30U);
  for (std::size_t n = 0; n < seen.size(); ++n) EXPECT_EQ(seen[n], 100 + static_cast<int>(n / 3)) << n;
}

TEST(Gripper, MotionDoesNotDependOnWhoAsks) {
  Gripper often = at_100(), seldom = at_100();
  for (Gripper* gripper : {&often, &seldom}) {
    gripper->write({110, 0, 0});
    gripper->write({90, 100, 0});
  }
  for (double time = 0.0; time < 0.5; time += 0.7e-3) often.update(time, 0.0);
  seldom.update(0.5, 0.0);
  for (const double time : {0.02, 0.06, 0.1, 0.2, 0.5}) EXPECT_EQ(often.opening(time), seldom.opening(time)) << time;
  EXPECT_NEAR(counts(seldom, 2.0), 90.0, 1e-11);
}

TEST(Gripper, StopsWhereTheForceReachesItsLimitAndLocks) {
  constexpr double tick = 1e-4, stiffness = 8000.0;  // N/m
  Gripper gripper = at_100();
  double time = 0.0;
  bool stopped = false;
  const auto closed = [&gripper](double t) { return 130.0 * count - gripper.opening(t); };
  const auto run = [&](double until, const GripCommand& command, double more_force) {
    for (; time < until; time += tick) {
      gripper.update(time, stiffness * closed(time) + more_force);
      if (gripper.read_due(time)) stopped = gripper.read().stopped;
      if (gripper.write_due(time)) gripper.write(command);
    }
  };
  // A spring of 8 N/mm without a gap reaches the limit of 20 N after 2.5 mm. The motor notices at
  // the next tick at the latest.
  run(1.0, {220, 0, 0}, 0.0);
  EXPECT_GE(closed(time), 2.5e-3);
  EXPECT_LE(closed(time), 2.5e-3 + speed * tick);
  EXPECT_TRUE(stopped);
  // It holds at any force, also after the same command; a larger limit lets it continue: 255 is 235
  // N, 29.4 mm.
  const double held = gripper.opening(time);
  run(2.0, {220, 0, 0}, 1000.0);
  EXPECT_EQ(gripper.opening(time), held);
  run(5.0, {220, 0, 255}, 0.0);
  EXPECT_GE(closed(time), 235.0 / stiffness);
  EXPECT_LE(closed(time), 235.0 / stiffness + speed * tick);
  EXPECT_TRUE(stopped);
  // No force prevents opening.
  run(10.0, {100, 0, 0}, 1000.0);
  EXPECT_NEAR(counts(gripper, time), 100.0, 1e-11);
  EXPECT_FALSE(stopped);
}

TEST(Gripper, LatencyIsThatOfTheScene) {
  for (const double latency : {0.0, 0.05}) {
    Gripper gripper = at_100({{"latency", latency}, {"write_after", 0.004}});
    gripper.write({110, 0, 0});
    gripper.update(0.5, 0.0);
    const double start = 0.004 + latency;
    EXPECT_NEAR(counts(gripper, start), 100.0, 1e-12);
    EXPECT_NEAR(counts(gripper, start + 0.01), 100.0 + 0.5 * acceleration * 1e-4 / count, 1e-10);
  }
}

// The loop has one command in flight: a write at or after the next read would belong to another
// read.
TEST(Gripper, RefusesAWriteNoEarlierThanTheNextRead) {
  EXPECT_NO_THROW(at_100({{"write_after", 0.0199}}));
  for (const double write_after : {0.02, 0.03})
    EXPECT_THROW(at_100({{"write_after", write_after}}), SceneValueError) << write_after;
}

TEST(Gripper, RefusesWhatIsNoByte) {
  for (const GripCommand& command :
       {GripCommand{256, 0, 0}, GripCommand{-1, 0, 0}, GripCommand{0, 256, 0}, GripCommand{0, 0, -7}}) {
    Gripper gripper = at_100();
    const std::string message = refusal(gripper, command);
    EXPECT_THAT(message, mentions({"0", "255", "0.01 s"}));
  }
  Gripper gripper = at_100();
  EXPECT_EQ(refusal(gripper, {255, 255, 255}), "accepted");
  EXPECT_EQ(refusal(gripper, {0, 0, 0}), "accepted");
}

TEST(Gripper, WrapsOnlyWhenAsked) {
  // 256 + 110 = 366 is 110 in the low byte: 10 counts further.
  Gripper gripper = at_100({{"wrap", true}});
  EXPECT_EQ(refusal(gripper, {366, 256, -256}), "accepted");
  gripper.update(10.0, 0.0);
  EXPECT_NEAR(counts(gripper, 10.0), 110.0, 1e-11);
}

TEST(Gripper, DeadBandIgnoresSmallWays) {
  Gripper gripper = at_100({{"dead_band", std::int64_t{1}}});
  gripper.write({101, 0, 0});
  gripper.update(1.0, 0.0);
  EXPECT_EQ(counts(gripper, 1.0), 100.0);
  gripper.write({102, 0, 0});
  gripper.update(2.0, 0.0);
  EXPECT_NEAR(counts(gripper, 2.0), 102.0, 1e-11);
}

TEST(Gripper, DriftHasItsStandardDeviationAndNoCountShowsIt) {
  // Eight sines of 1/2: the variance over whole periods is drift^2 8 (1/2)^2/2 = drift^2. They have
  // 1 to 8 whole periods in 10 s, and 1000 samples of a sine of k < 500 periods have exactly its
  // mean and variance.
  std::vector<DriftTone> tones;
  for (int k = 1; k <= 8; ++k) tones.push_back({2.0 * std::numbers::pi * 0.1 * k, 0.7 * k});
  const Gripper gripper(grip({{"drift", 0.9e-3}}), 130.0 * count, 0.0, tones);
  // At the start the opening is 130 counts, or up to one more.
  EXPECT_GE(gripper.opening(0.0), 130.0 * count - 1e-9);
  EXPECT_LT(gripper.opening(0.0), 131.0 * count);
  double sum = 0.0, squares = 0.0;
  const int position = gripper.position(0.0);
  for (int k = 0; k < 1000; ++k) {
    const double time = 0.01 * k, wander = gripper.opening(time) - (230.0 - position) * count;
    sum += wander;
    squares += wander * wander;
    EXPECT_EQ(gripper.position(time), position);
    // Central difference: an error of h^2/6 times the third derivative, at most amplitude w^3 =
    // 0.45 mm (5.03/s)^3 a tone: 8 of them 5e-8 m/s.
    constexpr double h = 1e-3;
    EXPECT_NEAR(gripper.opening_speed(time), (gripper.opening(time + h) - gripper.opening(time - h)) / (2.0 * h), 8e-8);
  }
  EXPECT_NEAR(sum / 1000.0, 0.0, 1e-15);
  EXPECT_NEAR(std::sqrt(squares / 1000.0), 0.9e-3, 1e-12);
}

}  // namespace
}  // namespace slipbench

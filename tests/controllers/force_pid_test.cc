#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/core/quantity.h"
#include "tests/controllers/rig.h"

namespace slipbench::controllers {
namespace {

int command_at(Controller& controller, double force, int measured, int tick) {
  return controller.update(input_of(PillarFrame::of_forces(force), measured, PadState::non_slip, tick)).position;
}

// r = 40 N, c = 1 N, T = 20 ms, Kp = 0.5, T/Ti = 0.2, Td/T = 1; F = 0, 10, 30 N from u = 100:
// 100 - 0.5*10 + 0.2*30 - (10 - 0) = 91; 91 - 0.5*20 + 0.2*10 - (30 - 20 + 0) = 73.
TEST(ForcePid, IsTheVelocityFormOfPid) {
  const auto controller = make("force_pid",
                               {{"force_per_count", "1 N"},
                                {"proportional", "0.5"},
                                {"integral_time", "0.1 s"},
                                {"derivative_time", "20 ms"},
                                {"dead_band", "0 N"},
                                {"lead", "255"}},
                               40.0);
  EXPECT_EQ(command_at(*controller, 0.0, 100, 0), 100);
  EXPECT_EQ(command_at(*controller, 10.0, 100, 1), 91);
  EXPECT_EQ(command_at(*controller, 30.0, 100, 2), 73);
  EXPECT_EQ(command_at(*controller, 0.0, 100, 2), 73);  // no newer status
}

TEST(ForcePid, LetsTheDeadBandBe) {
  const auto controller = make("force_pid", {{"proportional", "0"}, {"integral_time", "20 ms"}, {"lead", "255"}});
  EXPECT_EQ(command_at(*controller, 4.0, 50, 0), 50);
  EXPECT_EQ(command_at(*controller, 3.25, 50, 1), 50);  // 0.75 N of 0.8 N
  EXPECT_EQ(command_at(*controller, 4.75, 50, 2), 50);
  EXPECT_EQ(command_at(*controller, 3.0, 50, 3), 51);  // 1 N/1.6 N = 0.625 counts
  EXPECT_EQ(command_at(*controller, 5.0, 50, 4), 50);
}

// A stalled motor: F = 0 for 20 s adds no more than the lead, and the first excess takes a count off:
// -0.1 * 8 N - 4 N * 20/150 = -1.33 N, -0.83 counts.
TEST(ForcePid, DoesNotWindUp) {
  const auto controller = make("force_pid");
  for (int tick = 0; tick < 1000; ++tick) EXPECT_LE(command_at(*controller, 0.0, 100, tick), 102);
  EXPECT_EQ(command_at(*controller, 0.0, 100, 1000), 102);
  EXPECT_EQ(command_at(*controller, 8.0, 100, 1001), 101);
}

TEST(ForcePid, KeepsWithinTheRegister) {
  const auto closing = make("force_pid");
  const auto opening = make("force_pid");
  for (int tick = 0; tick < 100; ++tick) {
    EXPECT_LE(command_at(*closing, 0.0, 254, tick), 255);
    EXPECT_GE(command_at(*opening, 50.0, 1, tick), 0);
  }
  EXPECT_EQ(command_at(*closing, 0.0, 254, 100), 255);
  EXPECT_EQ(command_at(*opening, 50.0, 1, 100), 0);
}

// A motor that moves at once 50 ms after the write: the update k + 3 reads what the update k commands. Counts of 10 mN, so that rounding
// is small beside the error of 50 counts it starts with.
struct FineLoop {
  double last_error;  // counts, largest of the last 50 of 600 updates
  double overshoot;   // counts
};

FineLoop fine_loop(double integral_gain) {
  ToyPlant plant;
  plant.per_count = 0.01;
  plant.position = 60;
  plant.latency = 40;
  plant.ms_per_count = 0;
  const auto controller = make("force_pid",
                               {{"force_per_count", "10 mN"},
                                {"proportional", "0"},
                                {"integral_time", format_number(period / integral_gain)},
                                {"dead_band", "0 N"},
                                {"lead", "255"}},
                               1.0);
  const auto history = plant.run(*controller, 600);
  FineLoop result{0.0, 0.0};
  for (std::size_t tick = 0; tick < history.size(); ++tick) {
    const double error = history[tick].measured - 110.0;
    result.overshoot = std::max(result.overshoot, error);
    if (tick >= 550) result.last_error = std::max(result.last_error, std::abs(error));
  }
  return result;
}

// z^3 - z^2 + k = 0 has its roots inside the unit circle for k < 2 sin(pi/10) = 0.618. At 0.55 the slowest is 0.972 (0.972^550 = 2e-7),
// so that only rounding is left; at 0.68 it grows by 1.022 an update, to the ends of what the position and the force can be.
TEST(ForcePid, IsStableUpToTheGainOfItsDelay) {
  EXPECT_LE(fine_loop(0.55).last_error, 3.0);
  EXPECT_GE(fine_loop(0.68).last_error, 50.0);
}

// A double root at z = 2/3 for k = 4/27 = 0.148: no overshoot but for rounding to a count. At 0.3 the pair of roots has
// |z| = 0.79 and overshoots.
TEST(ForcePid, DoesNotOvershootBelowTheDoubleRoot) {
  EXPECT_LE(fine_loop(0.147).overshoot, 1.0);
  EXPECT_GE(fine_loop(0.3).overshoot, 5.0);
}

// The real loop: whole counts, 19 ms for each, 60 ms until they are seen. Wherever the contact and however soft the fingers, the defaults
// come to rest within the dead band, and never beyond it.
TEST(ForcePid, ComesToRestOnWholeCounts) {
  for (const double per_count : {0.4, 0.8, 1.2, 1.6}) {
    for (const double preset : {2.0, 3.3, 4.0, 7.9, 12.0}) {
      for (const double contact : {10.0, 10.3, 10.5, 10.9}) {
        ToyPlant plant;
        plant.position = 8;
        plant.per_count = per_count;
        plant.contact = contact;
        const auto controller = make("force_pid", {}, preset);
        const auto history = plant.run(*controller, 400);
        for (std::size_t tick = 0; tick < 400; ++tick) {
          EXPECT_LE(history[tick].force, preset + 0.8 + 1e-6) << per_count << " " << contact << " update " << tick;
          if (tick >= 250) {
            EXPECT_NEAR(history[tick].force, preset, 0.8 + 1e-6) << per_count << " " << contact;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace slipbench::controllers

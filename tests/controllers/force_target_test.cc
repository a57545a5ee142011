// The controllers that follow a target force: force_pid, force_ratio and stuck_fraction.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

// A stalled motor: F = 0 for 20 s adds no more than the lead, and the first excess removes a count:
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

// A motor that moves instantly 50 ms after the write: the update k + 3 reads the command of update
// k. Counts of 10 mN make rounding small compared with the initial error of 50 counts.
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

// z^3 - z^2 + k = 0 has its roots inside the unit circle for k < 2 sin(pi/10) = 0.618. At 0.55 the
// slowest is 0.972 (0.972^550 = 2e-7), so that only rounding is left; at 0.68 it grows by 1.022 per
// update, to the limits of position and force.
TEST(ForcePid, IsStableUpToTheGainOfItsDelay) {
  EXPECT_LE(fine_loop(0.55).last_error, 3.0);
  EXPECT_GE(fine_loop(0.68).last_error, 50.0);
}

// A double root at z = 2/3 for k = 4/27 = 0.148: no overshoot except rounding to a count. At 0.3
// the pair of roots has |z| = 0.79 and overshoots.
TEST(ForcePid, DoesNotOvershootBelowTheDoubleRoot) {
  EXPECT_LE(fine_loop(0.147).overshoot, 1.0);
  EXPECT_GE(fine_loop(0.3).overshoot, 5.0);
}

// The real loop: whole counts, 19 ms each, visible after 60 ms. For any contact position and finger
// stiffness the defaults settle within the dead band, and never exceed it.
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

// 3 N on the pad, assumed mu 0.5, margin 0.8: 3/(0.5 * 0.8) = 7.5 N, for which counts of 1.2 N give
// 8.4 N. Without load the target is the preset, 4.8 N, which holds the load in the meantime because
// the real mu is 0.8.
TEST(ForceRatio, GripsInProportionToTheLoad) {
  ToyPlant plant;
  plant.load = 6.0;
  plant.load_from = 30;
  plant.mu = 0.8;
  const auto history = plant.run(*make("force_ratio", {{"mu", "0.5"}, {"margin", "0.8"}, {"force_per_count", "1.2 N"}}), 100);
  for (std::size_t tick = 0; tick < 100; ++tick) {
    EXPECT_EQ(history[tick].command, tick < 30 ? 14 : 17) << "update " << tick;  // ceil(4/1.2) = 4, then ceil(2.7/1.2) = 3
  }
  EXPECT_DOUBLE_EQ(plant.grip(), 7 * 1.2);
}

// Counts of 0.4 N that the controller takes for 1.6 N: ceil((4 - F)/1.6) counts at a time, 0 + 3, 3
// + 2, then single ones up to 10.
TEST(ForceRatio, ReachesTheTargetFromBelowWhereACountIsWorthLess) {
  ToyPlant plant;
  plant.per_count = 0.4;
  plant.run(*make("force_ratio"), 200);
  EXPECT_EQ(plant.position, 20);
}

// Beyond the friction limit the measured load is mu F = 0.3 F, for which 0.3 F/(0.5 * 0.8) = 0.75 F
// would suffice.
TEST(ForceRatio, DropsTheBoxWhenItBelievesInTooMuchFriction) {
  ToyPlant plant;
  plant.load = 6.0;
  plant.load_from = 30;
  plant.mu = 0.3;
  plant.run(*make("force_ratio", {{"mu", "0.5"}, {"margin", "0.8"}}), 200);
  EXPECT_FALSE(plant.holds());
  EXPECT_DOUBLE_EQ(plant.grip(), 4.8);
}

// Seven pillars of 1 N and 0.1 N, one of 0.5 N and 0.3 N, one of 0.04 N and 0.04 N, which does not
// count as touching. largest: F = 7.54 N, ratio 0.6, target 7.54 * 0.6/0.4 = 11.31 N:
// ceil(3.77/1.6) = 3 counts. sum: 1.04 N, target 1.04/0.4 = 2.6 N, below the preset of 4 N: no
// counts.
TEST(ForceRatio, TakesTheLargestRatioOrTheSum) {
  PillarFrame frame = PillarFrame::of_forces(9.0, 0.9);
  frame.set_force(3, 0.5, 0.3);
  frame.set_force(7, 0.04, 0.04);
  for (const auto& [ratio, position] : {std::pair{"largest", 33}, std::pair{"sum", 30}}) {
    const auto controller = make("force_ratio", {{"ratio", ratio}, {"mu", "0.5"}, {"margin", "0.8"}});
    EXPECT_EQ(controller->update(input_of(frame, 30)).position, position) << ratio;
  }
}

// The ratio asks for 1000 N. From 4.8 N a ceiling of 11 N leaves floor(6.2/1.2) = 5 counts: 10.8 N.
TEST(ForceRatio, NeverExceedsTheCeiling) {
  ToyPlant plant;
  plant.load = 800.0;
  plant.load_from = 30;
  plant.mu = 2000.0;
  const auto history =
      plant.run(*make("force_ratio", {{"mu", "0.5"}, {"margin", "0.8"}, {"force_per_count", "1.2 N"}, {"ceiling", "11 N"}}), 100);
  double most = 0.0;
  for (const ToyPlant::Update& update : history) most = std::max(most, update.force);
  EXPECT_DOUBLE_EQ(most, 9 * 1.2);
}

// The grip is 10.3 N, the target 4 N, a count 1.2 N: floor(6.3/1.2) = 5 counts are too many.
TEST(ForceFollower, OpensOnlyWhenTold) {
  const PillarFrame tight = PillarFrame::of_forces(10.3);
  EXPECT_EQ(make("force_ratio", {{"force_per_count", "1.2 N"}})->update(input_of(tight, 30)).position, 30);
  const auto loose = make("force_ratio", {{"force_per_count", "1.2 N"}, {"loosen", "true"}});
  EXPECT_EQ(loose->update(input_of(tight, 30)).position, 25);
  EXPECT_EQ(loose->update(input_of(PillarFrame::of_forces(9.1), 29)).position, 25);  // in motion: floor(5.1/1.2) = 4 of 29
  EXPECT_EQ(loose->update(input_of(PillarFrame::of_forces(5.1), 25)).position, 25);  // less than a count too much
  EXPECT_EQ(loose->update(input_of(PillarFrame::of_forces(3.9), 24)).position, 25);
}

TEST(ForceFollower, TakesBackNoCountThatIsOnItsWay) {
  const auto controller = make("force_ratio");
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(1.0), 30)).position, 32);  // ceil(3/1.6) = 2
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(3.9), 30)).position, 32);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(4.1), 31)).position, 32);
}

TEST(ForceFollower, StaysClosedAtTheLastPosition) {
  for (const char* name : {"force_ratio", "stuck_fraction"}) {
    EXPECT_EQ(make(name)->update(input_of(PillarFrame::of_forces(0.0), 254)).position, 255) << name;
    EXPECT_EQ(make(name)->update(input_of(PillarFrame::of_forces(0.0), 255)).position, 255) << name;
  }
  EXPECT_EQ(make("force_ratio", {{"loosen", "true"}})->update(input_of(PillarFrame::of_forces(50.0), 3)).position, 0);
}

// F = 9 N, preset 4 N, gain 12 N, 1.6 N per count. s = 6/9: target 8 N, no counts. s = 3/9: 12 N,
// ceil(3/1.6) = 2 counts; s = 1/9: 14.67 N, ceil(5.67/1.6) = 4; s = 0: 16 N, ceil(7/1.6) = 5.
TEST(StuckFraction, GripsInProportionToThePillarsThatSlide) {
  const auto controller = make("stuck_fraction");
  const PillarFrame frame = PillarFrame::of_forces(9.0);
  ControlInput input = input_of(frame, 30);
  for (const auto& [sticking, position] : {std::pair{9, 30}, {6, 30}, {3, 32}, {1, 34}, {0, 35}}) {
    input.slip.stuck_fraction = sticking / 9.0;
    EXPECT_EQ(controller->update(input).position, position) << sticking << " of 9";
  }
}

// s = 1: the target is 4 N, the grip 9 N: floor(5/1.6) = 3 counts are too many.
TEST(StuckFraction, OpensOnlyWhenTold) {
  const PillarFrame frame = PillarFrame::of_forces(9.0);
  ControlInput input = input_of(frame, 30);
  input.slip.stuck_fraction = 1.0;
  EXPECT_EQ(make("stuck_fraction")->update(input).position, 30);
  EXPECT_EQ(make("stuck_fraction", {{"loosen", "true"}})->update(input).position, 27);
}

TEST(StuckFraction, RefusesADetectorThatTellsNone) {
  const auto controller = make("stuck_fraction");
  const PillarFrame frame = PillarFrame::of_forces(9.0);
  EXPECT_EQ(controller->update(input_of(frame, 30, PadState::no_contact)).position, 30);
  ControlInput input = input_of(frame, 30, PadState::non_slip, 3);
  input.slip.stuck_fraction = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal_of([&] { controller->update(input); }), refused_at("controller stuck_fraction", {"60 ms"}));
}

}  // namespace
}  // namespace slipbench::controllers

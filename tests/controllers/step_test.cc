// The controllers that step by counts: constant_force, hold_preset, timed_grip, step_on_slip.
#include <cmath>

#include "tests/controllers/rig.h"
#include "tests/expect.h"

namespace slipbench::controllers::step_test {
namespace {

constexpr PadState stick = PadState::non_slip;

// A count takes 60 ms: read at 0, written at 10, obeyed at 30, done at 49, read at 60 ms. So the
// three updates from 3n on read the same position and command 9 + n, until 4 counts beyond the
// contact at 10 give 4.8 N >= 4 N, which the update 3 * 6 reads.
TEST(StepControllers, CloseOneCountIn60MillisecondsToThePreset) {
  for (const char* name : {"constant_force", "hold_preset", "step_on_slip"}) {
    ToyPlant plant;
    plant.position = 8;
    const auto history = plant.run(*make(name), 40);
    for (int tick = 0; tick < 40; ++tick) {
      EXPECT_EQ(history[static_cast<std::size_t>(tick)].command, std::min(9 + tick / 3, 14)) << name << " update " << tick;
    }
    EXPECT_DOUBLE_EQ(plant.grip(), 4 * 1.2) << name;
  }
}

TEST(StepControllers, SendTheRegistersThatTheSceneNames) {
  for (const char* name : {"constant_force", "hold_preset", "step_on_slip"}) {
    const GripCommand quiet = make(name)->update(input_of(PillarFrame::of_forces(0.0), 7));
    EXPECT_EQ(quiet.speed, 0);
    EXPECT_EQ(quiet.force, 0);
    const auto strong = make(name, {{"speed_register", "255"}, {"force_register", "17"}});
    const GripCommand command = strong->update(input_of(PillarFrame::of_forces(0.0), 7));
    EXPECT_EQ(command.speed, 255);
    EXPECT_EQ(command.force, 17);
  }
}

TEST(ConstantForce, NeverMovesAgain) {
  const auto controller = make("constant_force");
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(3.9), 20)).position, 21);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(4.1), 21)).position, 21);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(0.0), 21)).position, 21);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(0.1), 20, PadState::gross)).position, 21);
}

TEST(ConstantForce, ThatStartsWithEnoughHoldsWhereItIs) {
  const auto controller = make("constant_force");
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(9.0), 30)).position, 30);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(0.0), 29)).position, 30);
}

TEST(HoldPreset, TightensBelowThePresetAndNeverOnSlip) {
  const auto controller = make("hold_preset");
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(4.1), 20, PadState::gross)).position, 20);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(4.1), 20, PadState::incipient)).position, 20);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(3.9), 20)).position, 21);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(4.1), 20)).position,
            21);  // a count under way is not undone
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(3.9), 21)).position, 22);
}

// 4.8 N on each of two pads with mu 0.4 hold 2 * 0.4 * 4.8 N = 3.84 N.
TEST(HoldPreset, DropsWhatThePresetDoesNotHold) {
  for (const auto& [load, held] : {std::pair{0.999 * 3.84, true}, std::pair{1.001 * 3.84, false}}) {
    ToyPlant plant;
    plant.load = load;
    plant.load_from = 30;
    plant.run(*make("hold_preset"), 200);
    EXPECT_EQ(plant.holds(), held) << load;
    EXPECT_DOUBLE_EQ(plant.grip(), 4.8);
  }
}

// The box is taken at 14 counts, as by constant_force above. Then 3 counts more at 1 s, and from
// 1.4 s on 4 counts less in 0.4 s: one per 0.1 s, rounded, so that the change from 3 to 2 comes at
// 1.45 s, which the update at 1.46 s sees, and so on; -1 from 1.76 s on.
TEST(TimedGrip, TakesTheBoxAndThenFollowsItsTable) {
  Named controller = named("timed_grip");
  controller.parameters.set("changes", NumberTable{"", {{1.0, 0.0}, {1.0, 3.0}, {1.4, 3.0}, {1.8, -1.0}}});
  ToyPlant plant;
  const auto history = plant.run(*make_controller(controller, papillarray_source()), 100);
  const auto command = [&history](double time) { return history[static_cast<std::size_t>(std::lround(time / period))].command; };
  EXPECT_EQ(command(0.98), 14);
  EXPECT_EQ(command(1.0), 17);
  EXPECT_EQ(command(1.44), 17);
  EXPECT_EQ(command(1.46), 16);
  EXPECT_EQ(command(1.56), 15);
  EXPECT_EQ(command(1.66), 14);
  EXPECT_EQ(command(1.74), 14);
  EXPECT_EQ(command(1.76), 13);
  EXPECT_EQ(history.back().command, 13);
}

TEST(TimedGrip, RefusesTimesThatFall) {
  Named controller = named("timed_grip");
  controller.parameters.set("changes", NumberTable{"", {{2.0, 0.0}, {1.0, 3.0}}});
  EXPECT_THAT(refusal_of([&] { (void)make_controller(controller, papillarray_source()); }),
              refused_at("controller.changes", {"row 2", "1 s", "2 s"}));
}

TEST(StepOnSlip, StepsWhileTheClassIsIncipientOrGross) {
  const auto controller = make("step_on_slip");
  const PillarFrame held = PillarFrame::of_forces(5.0);
  EXPECT_EQ(controller->update(input_of(held, 20, stick)).position, 20);
  EXPECT_EQ(controller->update(input_of(held, 20, PadState::incipient)).position, 21);
  EXPECT_EQ(controller->update(input_of(held, 20, PadState::gross)).position, 21);
  EXPECT_EQ(controller->update(input_of(held, 21, PadState::gross)).position, 22);
  EXPECT_EQ(controller->update(input_of(held, 21, PadState::no_contact)).position, 21);
}

// Slip ends when load <= 0.9 * 2 mu F: 6 N and mu 0.4 need 6/(0.9 * 0.8) = 8.33 N, which 7 counts
// of 1.2 N give.
TEST(StepOnSlip, TightensUntilNothingSlips) {
  for (const char* idle : {"measured_position", "last_command"}) {
    ToyPlant plant;
    plant.load = 6.0;
    plant.load_from = 31;
    const auto history = plant.run(*make("step_on_slip", {{"idle", idle}}), 100);
    EXPECT_EQ(plant.position, 17) << idle;
    EXPECT_TRUE(plant.holds());
    // From the 4 counts of the preset: updates 31 to 33 command 15, 34 to 36 command 16, from 37 on
    // 17.
    for (std::size_t tick = 31; tick < 100; ++tick) {
      EXPECT_EQ(history[tick].command, std::min(15 + (static_cast<int>(tick) - 31) / 3, 17)) << idle << " update " << tick;
    }
  }
}

// The loop's delay is three updates, and the idle command is the measured position: one update with
// slip sends a count round the loop for ever. Repeating the last command keeps the count instead.
TEST(StepOnSlip, OneSlipCirculatesWhenTheIdleCommandIsTheMeasuredPosition) {
  for (const bool as_published : {true, false}) {
    ToyPlant plant;
    plant.position = 20;
    plant.false_alarm = 5;
    const auto history = plant.run(*make("step_on_slip", {{"idle", as_published ? "measured_position" : "last_command"}}), 90);
    for (int tick = 0; tick < 90; ++tick) {
      const bool further = tick >= 5 && (!as_published || (tick - 5) % 3 == 0);
      EXPECT_EQ(history[static_cast<std::size_t>(tick)].command, further ? 21 : 20) << as_published << " update " << tick;
    }
  }
}

TEST(StepOnSlip, DebounceCountsUpdatesInARow) {
  const auto controller = make("step_on_slip", {{"debounce", "3"}});
  const PillarFrame held = PillarFrame::of_forces(5.0);
  std::vector<int> commands;
  for (const PadState state : {PadState::gross, PadState::incipient, stick, PadState::incipient, PadState::gross, PadState::gross,
                               PadState::incipient, stick, PadState::gross}) {
    commands.push_back(controller->update(input_of(held, 20, state)).position);
  }
  EXPECT_THAT(commands, ElementsAre(20, 20, 20, 20, 20, 21, 21, 20, 20));
}

TEST(StepOnSlip, DebounceDoesNotDelayThePreset) {
  const auto controller = make("step_on_slip", {{"debounce", "3"}});
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(3.9), 20)).position, 21);
}

// A load that no force holds: counts of 1.2 N stop at 6.0 N, because 7.2 N > 7 N.
TEST(StepOnSlip, NeverExceedsTheCeiling) {
  for (const char* idle : {"measured_position", "last_command"}) {
    ToyPlant plant;
    plant.load = 100.0;
    plant.load_from = 25;
    const auto history =
        plant.run(*make("step_on_slip", {{"idle", idle}, {"ceiling", "7 N"}, {"force_per_count", "1.2 N"}}), 300);
    double most = 0.0;
    for (const ToyPlant::Update& update : history) most = std::max(most, update.force);
    EXPECT_DOUBLE_EQ(most, 5 * 1.2) << idle;
  }
}

TEST(StepOnSlip, RefusesToWrap) {
  const PillarFrame slack = PillarFrame::of_forces(0.0);
  EXPECT_EQ(make("step_on_slip")->update(input_of(slack, 254)).position, 255);
  EXPECT_THAT(refusal_of([&] { make("step_on_slip")->update(input_of(slack, 255, stick, 50)); }),
              refused_at("controller step_on_slip", {"255", "1 s", "overflow"}));
  EXPECT_EQ(make("step_on_slip", {{"overflow", "hold"}})->update(input_of(slack, 255)).position, 255);
  EXPECT_EQ(make("step_on_slip", {{"overflow", "wrap"}})->update(input_of(slack, 255)).position, 0);
  EXPECT_EQ(make("step_on_slip")->update(input_of(PillarFrame::of_forces(5.0), 255)).position, 255);  // nothing asks for more
}

TEST(StepControllers, StayClosedAtTheLastPosition) {
  for (const char* name : {"constant_force", "hold_preset"}) {
    const auto controller = make(name);
    EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(0.0), 255)).position, 255) << name;
    EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(0.0), 255)).position, 255) << name;
  }
}

}  // namespace
}  // namespace slipbench::controllers::step_test

// Algorithms 2 and 3 of the nib pad's paper, step by step: commands as a function of what is felt.
#include <limits>

#include "tests/controllers/rig.h"
#include "tests/expect.h"

namespace slipbench::controllers::reorient_test {
namespace {

GripSource nib_source() {
  GripSource source{
      .channels = {{"si", "counts", {9, 4}, {}}, {"fl", "counts", {2}, {}}, {"fr", "counts", {2}, {}}},
      .features = {{"moment", "N m"}, {"fl_0_6", "counts"}, {"fr_0_6", "counts"}, {"fr_6_8", "counts"}, {"normal", "N"}},
      .guided = true};
  return source;
}

// A gripper that is where it was commanded a period ago, and a pad whose clusters and features a
// test sets.
class Hand {
 public:
  explicit Hand(const Settings& settings = {}) : controller_(make_controller(named("reorient", settings), nib_source())) {}

  double clusters = 0.0;  // counts, the sum over all four above the unloaded value
  double fl = 0.0, fr = 200.0, fr_fast = 0.0, normal = 5.0, moment = 0.05;

  const GripCommand& update() {
    std::vector<float> values(40, 6960.0F);
    values[36] = static_cast<float>(6960.0 + clusters);
    ControlInput input;
    input.slip.features = {moment, fl, fr, fr_fast, normal};
    input.frame = {time(), values};
    input.gripper = {.time = time(), .position = position_, .moving = false, .stopped = false};
    position_ = command_.position;
    if (updates_ == 0) position_ = input.gripper.position = 50;
    command_ = controller_->update(input);
    ++updates_;
    return command_;
  }
  const GripCommand& run_to(double until) {
    while (time() < until - 1e-9) update();
    return command_;
  }
  [[nodiscard]] double time() const { return period * updates_; }
  [[nodiscard]] const GripCommand& command() const { return command_; }

 private:
  std::unique_ptr<Controller> controller_;
  GripCommand command_{};
  int position_ = 50, updates_ = 0;
};

// Brings the hand into contact at 1 s; returns its position.
int touched(Hand& hand) {
  hand.run_to(1.0);
  hand.clusters = 500.0;
  hand.update();
  return hand.command().position;
}

TEST(Reorient, WaitsForItsTareAndClosesUntilItTouches) {
  Hand hand({{"adjust_speed", "3 mm/s"}, {"tare_time", "0.2 s"}, {"contact", "80"}});
  hand.run_to(0.22);
  EXPECT_EQ(hand.command().position, 50);
  hand.clusters = 79.0;
  hand.run_to(1.0);
  EXPECT_GT(hand.command().position, 60);
  EXPECT_EQ(hand.command().arm->up, 0.0);
  hand.clusters = 81.0;
  const int before = hand.command().position;
  hand.update();
  EXPECT_LE(hand.command().position, before);
  EXPECT_EQ(hand.command().arm->up, 3e-3);
  const int stopped = hand.command().position;
  hand.run_to(2.0);
  EXPECT_EQ(hand.command().position, stopped);
}

// Algorithm 2: one count each time FL is above its threshold, then TIME_SETTLE.
TEST(Reorient, TightensWhileItSlipsLinearly) {
  Hand hand({{"adjust_speed", "3 mm/s"}, {"fl_slip", "60"}, {"settle", "0.5 s"}});
  const int first = touched(hand);
  hand.fl = 59.0;
  hand.run_to(2.0);
  EXPECT_EQ(hand.command().position, first);
  hand.fl = 61.0;
  hand.run_to(2.02);
  EXPECT_EQ(hand.command().position, first + 1);
  hand.run_to(2.48);
  EXPECT_EQ(hand.command().position, first + 1);
  hand.run_to(4.02);  // 2, 2.5, 3, 3.5, 4 s
  EXPECT_EQ(hand.command().position, first + 5);
  hand.fl = std::numeric_limits<double>::quiet_NaN();
  hand.run_to(6.0);
  EXPECT_EQ(hand.command().position, first + 5);
}

// 20 mm at 3 mm/s end 6.67 s after the contact at 1 s. Then Algorithm 3, 10 mm/s up: looser while
// the box does not turn.
TEST(Reorient, LoosensWhileItDoesNotTurnAndStopsWhereItTurnsFast) {
  Hand hand({{"adjust_speed", "3 mm/s"},
             {"midpoint", "20 mm"},
             {"fl_slip", "60"},
             {"fr_slip", "60"},
             {"fr_quiet", "0.5 s"},
             {"fr_upright", "70"},
             {"settle", "0.5 s"},
             {"forward", "10 mm/s"}});
  const int first = touched(hand);
  hand.fl = 1000.0;
  hand.run_to(1.0 + 20.0 / 3.0 - 0.02);
  EXPECT_EQ(hand.command().arm->up, 3e-3);
  const int adjusted = hand.command().position;
  EXPECT_EQ(adjusted, first + 13);  // at 1.5, 2, .. 7.5 s
  hand.run_to(1.0 + 20.0 / 3.0 + 0.04);
  EXPECT_EQ(hand.command().arm->up, 10e-3);
  hand.fr = 59.0;
  hand.fr_fast = 69.0;
  hand.run_to(10.5);  // from 7.7 s: 8.7, 9.7, each 0.5 s of waiting and 0.5 s of quiet
  EXPECT_EQ(hand.command().position, first + 13 - 2);
  hand.fr = 61.0;
  hand.run_to(12.0);
  EXPECT_EQ(hand.command().position, first + 13 - 2);
  hand.fr_fast = 71.0;
  hand.update();
  EXPECT_EQ(hand.command().arm->up, 0.0);
  EXPECT_EQ(hand.command().arm->sideways, 10e-3);
}

// Without fr_quiet a single spectrum below the threshold loosens, but none does while the last
// count settles, nor one above the threshold.
TEST(Reorient, LoosensAtOnceWhatIsQuietWhereNoTimeIsAskedFor) {
  Hand hand({{"adjust_speed", "3 mm/s"}, {"midpoint", "3 mm"}, {"fr_slip", "60"}, {"fr_quiet", "0 s"}, {"settle", "0.4 s"}});
  const int first = touched(hand);
  hand.fr = 61.0;
  hand.run_to(4.0);  // turns from 2 s on
  EXPECT_EQ(hand.command().position, first);
  hand.fr = 59.0;
  hand.run_to(4.3);
  EXPECT_EQ(hand.command().position, first - 1);
  hand.run_to(4.5);
  EXPECT_EQ(hand.command().position, first - 2);
}

// One spectrum above the threshold is a turn: the box is quiet if spectra stay below it for
// fr_quiet, counted anew after each count's wait.
TEST(Reorient, LoosensOnlyWhatHasNotTurnedForAWhile) {
  Hand hand({{"adjust_speed", "3 mm/s"}, {"midpoint", "3 mm"}, {"fr_slip", "60"}, {"fr_quiet", "1 s"}, {"settle", "0.4 s"}});
  const int first = touched(hand);
  hand.fr = 59.0;
  hand.run_to(2.9);  // turns from 2 s on
  hand.fr = 61.0;
  hand.update();  // at 2.9 s
  hand.fr = 59.0;
  hand.run_to(3.86);
  EXPECT_EQ(hand.command().position, first);
  hand.run_to(4.0);
  EXPECT_EQ(hand.command().position, first - 1);
  hand.run_to(5.26);  // 0.4 s of waiting and 1 s of quiet
  EXPECT_EQ(hand.command().position, first - 1);
  hand.run_to(5.4);
  EXPECT_EQ(hand.command().position, first - 2);
  hand.fr = std::numeric_limits<double>::quiet_NaN();  // no estimate, so the box is not known to be at rest
  hand.run_to(7.0);
  EXPECT_EQ(hand.command().position, first - 2);
}

// A box that does not turn fast is released at TargetPoint: one count every release_wait, until
// force and moment are gone.
TEST(Reorient, ReleasesGentlyAtTheTargetPoint) {
  Hand hand({{"adjust_speed", "3 mm/s"},
             {"midpoint", "3 mm"},
             {"target", "23 mm"},
             {"settle", "0.4 s"},
             {"release_wait", "0.2 s"},
             {"released_normal", "0.3 N"},
             {"released_moment", "2e-3"}});
  const int first = touched(hand);
  hand.run_to(3.94);  // 1 s and 2 s of rising
  EXPECT_EQ(hand.command().arm->up, 10e-3);
  hand.run_to(4.1);
  EXPECT_EQ(hand.command().arm->up, 0.0);
  const double released = 4.04;  // 23 mm are reached in this update or a neighbouring one
  hand.run_to(released + 0.4 + 3 * 0.2 - 0.1);
  EXPECT_EQ(hand.command().position, first - 3);
  hand.normal = 0.1;
  hand.run_to(released + 0.4 + 4 * 0.2 - 0.1);
  EXPECT_EQ(hand.command().position, first - 4);
  hand.moment = -1e-3;
  hand.update();
  EXPECT_EQ(hand.command().position, 0);
  EXPECT_EQ(hand.command().arm->sideways, 0.0);
  hand.run_to(10.0);
  EXPECT_EQ(hand.command().position, 0);
}

TEST(Reorient, RefusesWhatItCannotWorkWith) {
  const auto refused = [](const auto& spoil) {
    GripSource source = nib_source();
    spoil(source);
    return refusal_of([&] { (void)make_controller(named("reorient"), source); });
  };
  EXPECT_THAT(refused([](GripSource& s) { s.guided = false; }), mentions({"arm", "motion.kind", "guided"}));
  EXPECT_THAT(refused([](GripSource& s) { s.features.pop_back(); }), mentions({"feature", "normal"}));
  EXPECT_THAT(refused([](GripSource& s) { s.channels = papillarray_channels(); }), mentions({"fl", "fr", "[2]"}));
}

}  // namespace
}  // namespace slipbench::controllers::reorient_test

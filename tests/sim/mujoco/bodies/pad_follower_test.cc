// Sensors that follow a pad: they have the pad's contact, at their own rates, and exert no forces.
#include <cmath>
#include <cstring>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench::testing_follower {
namespace {

// Two fingers release a box; friction is uneven, depends on the direction and falls with speed.
DynamicRig rig_of(const std::string& followers, const std::string& step = "250 us",
                  const std::string& scene = SLIPBENCH_SOURCE_DIR "/scenes/bodies/held_box.yaml") {
  return DynamicRig("duration: 1.4 s\ntime_step: " + step +
                        "\nseed: 7\nfriction: {static: 0.5, kinetic: 0.45}\nmodel: two_fingers.xml\n"
                        "bodies:\n  box: {shape: box, size: [40 mm, 40 mm, 60 mm], mass: 100 g, position: [0 mm, 0 mm, 100 mm]}\n"
                        "controls:\n  left: [[0.5 s, 4 N], [1.5 s, 0.5 N]]\n  right: [[0.5 s, 4 N], [1.5 s, 0.5 N]]\n"
                        "effects: [patchy_friction, {anisotropic_friction: {ratio: 0.8}}, stribeck]\n"
                        "sensors:\n  left: {type: papillarray, rate: 1 kHz, site: left_pad, touches: [box]}\n"
                        "  right: {type: papillarray, rate: 1 kHz, site: right_pad, touches: [box]}\n" +
                        followers,
                    scene);
}

// The same with another integrator in the model's option.
DynamicRig rig_by(const std::string& integrator, const std::string& followers) {
  const std::filesystem::path scenes(SLIPBENCH_SOURCE_DIR "/scenes/bodies");
  std::ifstream file(scenes / "two_fingers.xml");
  std::string model(std::istreambuf_iterator<char>(file), {});
  const std::string shipped = "implicitfast";
  model.replace(model.find(shipped), shipped.size(), integrator);
  const ModelFolder folder;
  folder.write("two_fingers.xml", model);
  return rig_of(followers, "250 us", folder.file("held_box.yaml"));
}

// The ticks of every sensor, in order.
using History = std::vector<ContactFrame>;
std::vector<History> run(DynamicRig& rig) {
  const std::size_t pads = rig.scene().sensors.size();
  std::size_t left = 0;
  for (std::size_t pad = 0; pad < pads; ++pad) left += rig->ticks(pad);
  std::vector<History> histories(pads);
  double last = 0.0;
  while (left > 0) {
    rig->step();
    left -= rig->stepped().size();
    for (const std::size_t pad : rig->stepped()) {
      EXPECT_GE(rig->contact(pad).time, last * (1.0 - 1e-12)) << "the bench goes back";
      last = rig->contact(pad).time;
      histories[pad].push_back(rig->contact(pad));
    }
  }
  return histories;
}

template <class Array>
bool same(const Array& a, const Array& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(*a.data())) == 0;
}

// `rounding`: tolerance of the time [s, 1] and of values divided by a step.
bool same_but_events(const ContactFrame& a, const ContactFrame& b, double rounding = 0.0) {
  return same(a.force, b.force) && same(a.contact_force, b.contact_force) && same(a.displacement, b.displacement) &&
         ((a.slip_velocity - b.slip_velocity).abs() <= rounding * a.slip_velocity.abs().maxCoeff()).all() &&
         same(a.slip_distance, b.slip_distance) && same(a.margin, b.margin) && a.unit_state == b.unit_state &&
         a.state == b.state && std::abs(a.slip_angle - b.slip_angle) <= rounding;
}

bool same_event(const ContactEvent& a, const ContactEvent& b) { return a.time == b.time && a.unit == b.unit && a.kind == b.kind; }

std::vector<ContactEvent> events_of(const History& history) {
  std::vector<ContactEvent> all;
  for (const ContactFrame& frame : history) all.insert(all.end(), frame.events.begin(), frame.events.end());
  return all;
}

class PadFollowerBy : public testing::TestWithParam<std::string> {};

// With the elements of the pad a follower is bit-identical to that pad at every sampled instant: no
// pose is skipped, no event lost. (4 x 250 us and 1 ms are the same number.) With RK4 MuJoCo itself
// sums its steps to the time: 5600 roundings of at most 1.1e-16 s are under 1e-12 s, and a step of
// 250 us has a relative rounding of 2.2e-16/250e-6 = 1e-12 at either end, as have values divided by
// it and their sums.
TEST_P(PadFollowerBy, OfTheSameKindIsThePadItself) {
  const double rounding = GetParam() == "RK4" ? 3e-12 : 0.0;
  DynamicRig rig = rig_by(
      GetParam(),
      "  twin: {type: papillarray, rate: 1 kHz, follows: left}\n  slow: {type: papillarray, rate: 100 Hz, follows: left}\n");
  const std::vector<History> all = run(rig);
  ASSERT_EQ(all[0].size(), 5600U);
  ASSERT_EQ(all[2].size(), 1400U);
  ASSERT_EQ(all[3].size(), 140U);
  EXPECT_EQ(all[0].front().time, 0.0);
  EXPECT_NEAR(all[0].front().force.row(2).sum(), 3.9, 0.05) << "pressed from the start on, as two_fingers.xml says";
  for (const std::size_t follower : {2U, 3U}) {
    const std::size_t every = 5600U / all[follower].size();
    std::size_t differ = 0;
    for (std::size_t tick = 0; tick < all[follower].size(); ++tick) {
      const ContactFrame &pad = all[0][every * tick], &twin = all[follower][tick];
      differ += same_but_events(pad, twin, rounding) && std::abs(pad.time - twin.time) <= rounding ? 0 : 1;
    }
    EXPECT_EQ(differ, 0U) << rig.scene().sensors[follower].name;
    std::vector<ContactEvent> events = events_of(all[0]);
    std::erase_if(events, [&](const ContactEvent& event) { return event.time > all[follower].back().time; });
    EXPECT_GT(events.size(), 18U) << "nine pillars touch and slip: else this tests little";
    const auto same_up_to_rounding = [&](const ContactEvent& a, const ContactEvent& b) {
      return std::abs(a.time - b.time) <= rounding && a.unit == b.unit && a.kind == b.kind;
    };
    EXPECT_TRUE(std::ranges::equal(events, events_of(all[follower]), same_up_to_rounding)) << rig.scene().sensors[follower].name;
  }
  EXPECT_EQ(all[0].back().state, PadState::gross);
}
INSTANTIATE_TEST_SUITE_P(Integrators, PadFollowerBy, testing::Values("Euler", "implicit", "implicitfast", "discrete", "RK4"));

// Between two ticks the pose is linear, so the press k_n d of every element is, too. Half-way it is
// their mean, up to the curvature from the turn in one step, under 1e-4 rad: k_n r angle^2/8 = 20
// kN/m 10 mm 1e-8/8 < 1e-6 N.
TEST(PadFollower, StepsOnStraightLinesBetweenTicks) {
  DynamicRig rig = rig_of("  skin: {type: piezo_skin, follows: left}\n", "200 us");
  const History skin = run(rig)[2];
  ASSERT_EQ(skin.size(), 13999U) << "to the last tick, at 1.3998 s, every 100 us";
  double worst = 0.0, most = 0.0, least_change = 1.0;
  for (std::size_t k = 0; k < skin.size(); ++k) EXPECT_NEAR(skin[k].time, 1e-4 * static_cast<double>(k), 1e-12);
  for (std::size_t k = 6001; k < 9000; k += 2) {  // the fingers release by 3.5 N/s, and nothing slips yet
    const Eigen::ArrayXd from = skin[k - 1].force.row(2), half = skin[k].force.row(2), to = skin[k + 1].force.row(2);
    worst = std::max(worst, (half - 0.5 * (from + to)).abs().maxCoeff());
    most = std::max(most, from.maxCoeff());
    least_change = std::min(least_change, (to - from).abs().maxCoeff());
  }
  EXPECT_GT(most, 0.1) << "N, the skin is pressed";
  EXPECT_GT(least_change, 1e-5) << "N, and the press falls";
  EXPECT_LT(worst, 1e-6);
}

// The period of 300 samples a second is not a multiple of the 250 us step.
TEST(PadFollower, NeedsNoCommonStep) {
  DynamicRig rig = rig_of("  nib: {type: nib_pad, follows: left}\n  other: {type: papillarray, rate: 1 kHz, follows: right}\n");
  const std::vector<History> all = run(rig);
  EXPECT_EQ(all[2].size(), 420U);  // the last at 419/300 s = 1.3967 s
  for (std::size_t k = 0; k < all[2].size(); ++k) ASSERT_NEAR(all[2][k].time, static_cast<double>(k) / 300.0, 1e-12);
  std::size_t differ = 0;
  for (std::size_t tick = 0; tick < 1400; ++tick) differ += same_but_events(all[1][4 * tick], all[3][tick]) ? 0 : 1;
  EXPECT_EQ(differ, 0U) << "the other finger's";
}

TEST(PadFollower, ChangesNothingForWhatCarries) {
  DynamicRig alone = rig_of("");
  DynamicRig beside = rig_of("  skin: {type: piezo_skin, follows: left}\n  nib: {type: nib_pad, follows: right}\n");
  const std::vector<History> without = run(alone), with = run(beside);
  EXPECT_EQ(alone->time_step(0), beside->time_step(0));
  for (const std::size_t pad : {0U, 1U}) {
    ASSERT_EQ(without[pad].size(), with[pad].size());
    std::size_t differ = 0;
    for (std::size_t tick = 0; tick < without[pad].size(); ++tick) {
      const ContactFrame &a = without[pad][tick], &b = with[pad][tick];
      differ += a.time == b.time && same_but_events(a, b) && std::ranges::equal(a.events, b.events, same_event) ? 0 : 1;
    }
    EXPECT_EQ(differ, 0U);
  }
  ASSERT_EQ(alone->bodies().size(), beside->bodies().size()) << "a follower must not be a body";
  EXPECT_TRUE(same(alone.body("box").pose.position, beside.body("box").pose.position));
  EXPECT_TRUE(same(alone.body("box").pose.rotation, beside.body("box").pose.rotation));
}

}  // namespace
}  // namespace slipbench::testing_follower

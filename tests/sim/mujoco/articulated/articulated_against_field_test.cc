// The articulated pad against the field: two models of the same pillars that share only the rules
// for units. Prescribed motion on a plane, and one scene of bodies that move by forces.
//
// Expected differences (derived in articulated_stage_test.cc): an articulated pillar slips 85 us
// early (damping) and 0.2 steps late (trailing), rings for 5 ms, needs some steps to follow a press
// (the contact's damping), and detects new contacts at the end of a step. The field has no inertia
// and locates all events inside the step.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "sim/mujoco/articulated/articulated_stage.h"
#include "tests/oracle/pads.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"
#include "tests/sim/mujoco/bodies/dynamic_scenes.h"

namespace slipbench {
namespace {

constexpr double dt = 1e-3, mu = 0.5, k_n = 3000.0, k_t = 500.0;

struct Agreement {
  double worst_force = 0.0;          // N
  double worst_force_at_rest = 0.0;  // N, after the press and its settling
  double worst_time = 0.0;           // s, of an event reported by both
  std::size_t events = 0;            // reported by both
  std::size_t unmatched = 0;         // events reported by one model only
  double states_apart = 0.0;         // ticks x units with different states
};

// Drives both models through `pose(t)`.
Agreement compare(const PadLayout& pad, const Surface& surface, double duration, const std::function<Pose(double)>& pose) {
  Field field(pad, surface, {mu, mu});
  ContactLabels labels(pad);
  ArticulatedStage simulation(pad, surface, {mu, mu}, dt);
  std::map<std::pair<std::uint32_t, EventKind>, std::vector<double>> of_field, of_bench;
  Agreement result;
  const auto ticks = static_cast<std::size_t>(std::lround(duration / dt));
  for (std::size_t tick = 0; tick <= ticks; ++tick) {
    const double time = static_cast<double>(tick) * dt;
    field.step(pose(time), dt);
    const ContactFrame& truth = labels.update({&field, 1}, time, dt);
    const ContactFrame& other = simulation.step(pose(time), time);
    for (const ContactEvent& event : truth.events) of_field[{event.unit, event.kind}].push_back(event.time);
    for (const ContactEvent& event : other.events) of_bench[{event.unit, event.kind}].push_back(event.time);
    const double apart = (truth.force - other.force).abs().maxCoeff();
    result.worst_force = std::max(result.worst_force, apart);
    if (time > 0.098) result.worst_force_at_rest = std::max(result.worst_force_at_rest, apart);
    for (std::size_t u = 0; u < pad.units.size(); ++u) {
      if (truth.unit_state[u] != other.unit_state[u]) result.states_apart += 1.0;
    }
  }
  for (const auto& [key, times] : of_field) {
    const std::vector<double>& others = of_bench[key];
    const std::size_t both = std::min(times.size(), others.size());
    for (std::size_t k = 0; k < both; ++k) result.worst_time = std::max(result.worst_time, std::abs(times[k] - others[k]));
    result.events += both;
  }
  for (const auto& [key, times] : of_bench) {
    const std::size_t in_field = of_field[key].size();
    result.unmatched += std::max(in_field, times.size()) - std::min(in_field, times.size());
  }
  return result;
}

Pose at(double x, double z) {
  Pose pose;
  pose.position = {x, 0.0, z};
  return pose;
}

// Pressed at 20 mm/s for 80 ms from 0.113 mm above, then at rest until 0.1 s: the pillars touch at
// 5.65, 15.65 and 28.15 ms.
double height(double t) { return 0.113e-3 - std::min(1.6e-3, 20e-3 * t); }

void expect_agreement(const PadLayout& pad, const std::function<Pose(double)>& pose, std::size_t events) {
  const Agreement agreement = compare(pad, Plane{}, 1.5, pose);
  // A contact that begins inside a step is found at its end: up to one step of the press, 20 mm/s x
  // 1 ms x 3 kN/m = 60 mN.
  EXPECT_LT(agreement.worst_force, 0.061);
  // After the press: 0.2 steps of trailing (at most 5 mm/s x 0.2 ms x 500 N/m = 0.5 mN) and the
  // damping (0.2 mN).
  EXPECT_LT(agreement.worst_force_at_rest, 1e-3);
  EXPECT_LT(agreement.worst_time, 1.01 * dt);
  EXPECT_EQ(agreement.events, events);
  EXPECT_EQ(agreement.unmatched, 0U);
  // MuJoCo looks for contacts at the beginning of a step: each of the nine tips, which touch
  // between two ticks, is detached for one more tick. Slip is at most 0.14 ms late (0.2 steps of
  // trailing minus the damping), and no onset of these motions is that close to a tick.
  EXPECT_EQ(agreement.states_apart, 9.0);
}

// Touch, micro and slip for each of nine pillars.
TEST(ArticulatedAgainstField, PressAndSlide) {
  expect_agreement(
      oracle::nine_pillars(1, k_n, k_t), [](double t) { return at(4e-3 * std::max(0.0, t - 0.1), height(t)); }, 27);
}

// Pressed in from the start: all touch at 0 s in both, without the transient of a press.
TEST(ArticulatedAgainstField, ASlideThatBeginsInContact) {
  const Agreement agreement = compare(oracle::nine_pillars(1, k_n, k_t), Plane{}, 1.5,
                                      [](double t) { return at(4e-3 * std::max(0.0, t - 0.1), height(1.0)); });
  EXPECT_LT(agreement.worst_force, 1e-3);
  EXPECT_LT(agreement.worst_time, 0.3 * dt);
  EXPECT_EQ(agreement.events, 27U);
  EXPECT_EQ(agreement.unmatched, 0U);
  EXPECT_EQ(agreement.states_apart, 0.0);
}

// Touches of all; micro, slip and stick of the corners, which begin to slip after 1.037 mm x mu
// k_n/(k_t v) = 0.778 s; the edges would after 0.965 s.
TEST(ArticulatedAgainstField, Stop) {
  expect_agreement(
      oracle::nine_pillars(1, k_n, k_t), [](double t) { return at(4e-3 * std::clamp(t - 0.1, 0.0, 0.88), height(t)); },
      9 + 3 * 4);
}

// Touches of all; micro and slip of all but the middle.
TEST(ArticulatedAgainstField, Turn) {
  expect_agreement(
      oracle::nine_pillars(1, k_n, k_t),
      [](double t) {
        return oracle::turned(0.5 * std::max(0.0, t - 0.1), {0.0, 0.0, height(t)});
      },
      9 + 2 * 8);
}

// Two fingers hold a box of 100 g with 4 N each and release by 3.5 N/s from 0.5 s on:
// scenes/bodies/held_box.yaml at 1 ms for the pillars and at the stability limit for the field. Its
// pads have pillars of 7.1 and 3.9 kN/m, five of which touch.
class HeldBox : public testing::Test {
 protected:
  HeldBox() { folder_.write("fingers.xml", two_fingers("")); }
  [[nodiscard]] DynamicRig rig(const std::string& fidelity) const {
    return DynamicRig(held_box("fidelity: " + fidelity +
                               "\nduration: 1.5 s\n"
                               "controls: {left: [[0.5 s, 4 N], [1.5 s, 0.5 N]], right: [[0.5 s, 4 N], [1.5 s, 0.5 N]]}\n"),
                      folder_.file("scene.yaml"));
  }
  ModelFolder folder_;
};

TEST_F(HeldBox, IsCarriedByTheSamePillarsAndCreepsInNeither) {
  DynamicRig field = rig("field"), pillars = rig("articulated");
  for (DynamicRig* one : {&field, &pillars}) one->run_to(0.3);
  const Eigen::Vector3d of_field = field.body("box").pose.position, of_pillars = pillars.body("box").pose.position;
  for (DynamicRig* one : {&field, &pillars}) {
    one->run_to(0.5);
    // Half the weight on each pad, shared equally by five pillars of equal k_t.
    for (const std::size_t pad : {0U, 1U}) {
      const ContactFrame& frame = (*one)->contact(pad);
      for (const Eigen::Index u : {1, 3, 4, 5, 7}) {
        EXPECT_NEAR(frame.contact_force.col(u).head<2>().matrix().norm(), 0.1 * weight_of_100_g, 1e-3 * 0.1 * weight_of_100_g)
            << u;
      }
      EXPECT_NEAR(frame.force.row(0).sum(), (pad == 0 ? -0.5 : 0.5) * weight_of_100_g, 1e-5 * weight_of_100_g);
      EXPECT_NEAR(frame.force.row(2).sum(), 4.0, 1e-5);
    }
  }
  // A slide compensates for the softer contact between light bodies (articulated.cc): by k_n dt^2
  // w/15, 1.5 % here. Turning of the box and the damped fingers would add some 1/kg each to w,
  // 5e-4.
  for (const std::size_t pad : {0U, 1U}) {
    const auto normal_forces = [pad](DynamicRig& simulation) -> Eigen::ArrayXd {
      return simulation->contact(pad).contact_force.row(2);
    };
    EXPECT_LT((normal_forces(pillars) - normal_forces(field)).abs().maxCoeff(), 1e-4 * normal_forces(field).maxCoeff());
  }
  // At most 0.05 um/s, a tenth of the limit, and a sag equal to m g/(10 k_t) = 25 um within the
  // accuracy of k_t.
  EXPECT_LT((field.body("box").pose.position - of_field).norm(), 0.2 * 0.05e-6);
  EXPECT_LT((pillars.body("box").pose.position - of_pillars).norm(), 0.2 * 0.05e-6);
  EXPECT_NEAR(of_pillars.z(), of_field.z(), 1e-3 * 25e-6);
}

TEST_F(HeldBox, IsDroppedByBothWhenTheGripIsTooWeak) {
  DynamicRig field = rig("field"), pillars = rig("articulated");
  const auto onsets = [](DynamicRig& simulation, double until) {
    oracle::FirstTimes slips(9, EventKind::slip);
    while (simulation->contact(0).time < until - 1e-9) {
      simulation->step();
      slips(simulation->contact(0));
    }
    return slips.times();
  };
  const std::vector<double> of_field = onsets(field, 1.39), of_pillars = onsets(pillars, 1.39);
  // The edges begin to slip when their share of the grip no longer holds their share of the
  // weight; the middle, the last to hold, when 2 mu F = m g: at 1.3626 s, and 1.7 ms later due to
  // the fingers' damping (tests/tools/trial/bodies_test.cc). Within a step of 1 ms the grip
  // falls by 0.36 %; the limit for the grip is 0.5 %.
  for (const std::size_t u : {1U, 3U, 4U, 5U, 7U}) EXPECT_NEAR(of_pillars[u], of_field[u], 1e-3) << u;
  EXPECT_NEAR(of_pillars[4], 1.3626 + 0.0017, 1e-3);
  // Both fall: v grows by g (1 - F/F_least), with F falling by 3.5 N/s.
  for (DynamicRig* one : {&field, &pillars}) {
    EXPECT_LT(one->body("box").velocity.z(), -1e-3);
    EXPECT_EQ((*one)->contact(0).state, PadState::gross);
  }
}

}  // namespace
}  // namespace slipbench

// The articulated pad beside the field: two models of the same pillars that share no code but the rules for units.
//
// Where they differ, and by how much (articulated_bench_test.cc derives it): a pillar slips 85 us early (damping) and 0.2 steps
// late (trailing), rings for 5 ms, needs some steps to take up a press (the contact's damping), and finds out at the end of a step
// that a contact began. The field has no inertia and locates all of it inside the step.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "sim/field/contact_labels.h"
#include "sim/mujoco/articulated_bench.h"
#include "tests/oracle/pads.h"

namespace slipbench {
namespace {

constexpr double dt = 1e-3, mu = 0.5, k_n = 3000.0, k_t = 500.0;

struct Agreement {
  double worst_force = 0.0;          // N
  double worst_force_at_rest = 0.0;  // N, after the press and its settling
  double worst_time = 0.0;           // s, of an event that both report
  std::size_t events = 0;            // that both report
  std::size_t unmatched = 0;         // events that one reports and not the other
  double states_apart = 0.0;         // ticks x units with different states
};

// Drives both through `pose(t)`.
Agreement compare(const PadLayout& pad, const Surface& surface, double duration, const std::function<Pose(double)>& pose) {
  Field field(pad, surface, {mu, mu});
  ContactLabels labels(pad);
  ArticulatedBench bench(pad, surface, {mu, mu}, dt);
  std::map<std::pair<std::uint32_t, EventKind>, std::vector<double>> of_field, of_bench;
  Agreement result;
  const auto ticks = static_cast<std::size_t>(std::lround(duration / dt));
  for (std::size_t tick = 0; tick <= ticks; ++tick) {
    const double time = static_cast<double>(tick) * dt;
    field.step(pose(time), dt);
    const ContactFrame& truth = labels.update({&field, 1}, time, dt);
    const ContactFrame& other = bench.step(pose(time), time);
    // The first step places both. The field calls what it finds there a touch.
    for (const ContactEvent& event : truth.events) {
      if (tick > 0) of_field[{event.unit, event.kind}].push_back(event.time);
    }
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

// Pressed at 20 mm/s for 80 ms from 0.1 mm above, then at rest until 0.1 s.
double press(double t) { return 0.1e-3 - std::min(1.6e-3, 20e-3 * t); }

void expect_agreement(const PadLayout& pad, const std::function<Pose(double)>& pose, std::size_t events) {
  const Agreement agreement = compare(pad, Plane{}, 1.5, pose);
  // A contact that began inside a step is found at its end: up to a step's press, 20 mm/s x 1 ms x 3 kN/m = 60 mN.
  EXPECT_LT(agreement.worst_force, 0.061);
  // After the press: 0.2 steps of trailing (at most 5 mm/s x 0.2 ms x 500 N/m = 0.5 mN) and the damping (0.2 mN).
  EXPECT_LT(agreement.worst_force_at_rest, 1e-3);
  EXPECT_LT(agreement.worst_time, 1.01 * dt);
  EXPECT_EQ(agreement.events, events);
  EXPECT_EQ(agreement.unmatched, 0U);
  // A state may differ for a step next to each event.
  EXPECT_LE(agreement.states_apart, static_cast<double>(events));
}

// Touch, micro and slip of nine pillars each.
TEST(ArticulatedAgainstField, PressAndSlide) {
  expect_agreement(
      oracle::nine_pillars(1, k_n, k_t), [](double t) { return at(4e-3 * std::max(0.0, t - 0.1), press(t)); }, 27);
}

// Touches of all; micro, slip and stick of the corners, which let go after 1.05 mm x mu k_n/(k_t v) = 0.79 s; the edges would after
// 0.98 s.
TEST(ArticulatedAgainstField, Stop) {
  expect_agreement(
      oracle::nine_pillars(1, k_n, k_t), [](double t) { return at(4e-3 * std::clamp(t - 0.1, 0.0, 0.88), press(t)); }, 9 + 3 * 4);
}

// Touches of all; micro and slip of all but the middle.
TEST(ArticulatedAgainstField, Turn) {
  expect_agreement(
      oracle::nine_pillars(1, k_n, k_t),
      [](double t) {
        return oracle::turned(0.5 * std::max(0.0, t - 0.1), {0.0, 0.0, press(t)});
      },
      9 + 2 * 8);
}

}  // namespace
}  // namespace slipbench

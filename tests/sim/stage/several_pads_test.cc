// Pads on one stage do not interact: each has a bit-identical history without the others.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/sim/stage/simulation_rig.h"

namespace slipbench::testing_bench {
namespace {

struct Rig {
  PadLayout layout;
  double rate;  // Hz
};

// Everything that a sensor can read in a tick.
std::vector<double> bytes_of(const ContactFrame& frame) {
  std::vector<double> all{frame.time,
                          frame.stuck_fraction,
                          frame.slip_angle,
                          frame.slip_direction,
                          static_cast<double>(frame.state),
                          static_cast<double>(frame.state_micro)};
  const auto add = [&all](const auto& array) { all.insert(all.end(), array.data(), array.data() + array.size()); };
  add(frame.force);
  add(frame.contact_force);
  add(frame.displacement);
  add(frame.slip_velocity);
  add(frame.slip_distance);
  add(frame.margin);
  add(frame.stage_position);
  add(frame.slip_centre);
  add(frame.element_depth);
  add(frame.element_shear);
  for (const UnitState state : frame.unit_state) all.push_back(static_cast<double>(state));
  for (const ContactEvent& event : frame.events) {
    all.insert(all.end(), {event.time, static_cast<double>(event.unit), static_cast<double>(event.kind)});
  }
  return all;
}

// The ticks of every pad, in the simulation's order.
std::vector<std::vector<std::vector<double>>> histories(const Scene& scene, const std::vector<Rig>& rigs) {
  std::vector<const PadLayout*> pads;
  std::vector<double> rates;
  std::size_t left = 0;
  for (const Rig& rig : rigs) {
    pads.push_back(&rig.layout);
    rates.push_back(rig.rate);
  }
  StageSimulation b = simulation(scene, pads, rates);
  for (std::size_t pad = 0; pad < rigs.size(); ++pad) left += b.ticks(pad);
  std::vector<std::vector<std::vector<double>>> result(rigs.size());
  double last = 0.0;
  while (left > 0) {
    b.step();
    left -= b.stepped().size();
    for (const std::size_t pad : b.stepped()) {
      EXPECT_GE(b.contact(pad).time, last) << "the bench never goes back";
      last = b.contact(pad).time;
      EXPECT_EQ(b.bodies().front().state.pose.position.x(), b.contact(pad).stage_position.x())
          << "bodies are those of the instant";
      result[pad].push_back(bytes_of(b.contact(pad)));
    }
  }
  return result;
}

Scene pressed_and_slid(std::size_t pads) {
  Scene asked = scene(pads, {{"compression", 0.4e-3}, {"start", 0.31}, {"speed", 8e-3}, {"vibration", 1.0}});
  asked.duration = 0.5;
  asked.time_step.reset();
  return asked;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void expect_each_as_alone(const std::vector<Named>& effects, const std::vector<Rig>& rigs) {
  Scene all = pressed_and_slid(rigs.size());
  all.effects = effects;
  const auto together = histories(all, rigs);
  for (std::size_t pad = 0; pad < rigs.size(); ++pad) {
    Scene one = pressed_and_slid(1);
    one.effects = effects;
    const auto alone = histories(one, {rigs[pad]});
    ASSERT_EQ(together[pad].size(), alone.front().size()) << rigs[pad].rate << " Hz";
    std::size_t differ = 0;
    for (std::size_t tick = 0; tick < together[pad].size(); ++tick) {
      differ += same(together[pad][tick], alone.front()[tick]) ? 0 : 1;
    }
    EXPECT_EQ(differ, 0U) << rigs[pad].rate << " Hz";
  }
}

PadLayout with_elements(PadLayout layout) {
  layout.element_truth = true;
  return layout;
}

const std::vector<Rig> rigs{{oracle::nine_pillars(), 1000.0},
                            {oracle::nine_pillars(6), 10000.0},
                            {oracle::nine_pillars(), 2400.0},
                            {with_elements(oracle::nine_pillars(3)), 500.0},
                            {oracle::nine_pillars(), 100.0}};

TEST(SeveralPads, EachHasItsOwnStepAndTheHistoryThatItHasAlone) {
  const std::vector<Named> drawn{named(effect_catalogue(), "patchy_friction"), named(effect_catalogue(), "texture"),
                                 named(effect_catalogue(), "inertia")};
  expect_each_as_alone(drawn, rigs);
  expect_each_as_alone({named(effect_catalogue(), "viscoelastic"), named(effect_catalogue(), "ageing")}, rigs);
  expect_each_as_alone({}, {rigs.rbegin(), rigs.rend()});
}

// Sampling times of 100 us, 1 ms and 1 s/2400 (2.4 kHz). None is a multiple of all others, and no
// step is shorter than its sensor needs.
TEST(SeveralPads, TicksAreMultiplesOfEachSamplingTime) {
  const std::vector<Rig> three{rigs[1], rigs[0], rigs[2]};
  const Scene asked = pressed_and_slid(3);
  const StageSimulation b = simulation(asked, {&three[0].layout, &three[1].layout, &three[2].layout}, {10000.0, 1000.0, 2400.0});
  for (std::size_t pad = 0; pad < 3; ++pad) {
    EXPECT_EQ(b.time_step(pad), 1.0 / three[pad].rate);
    EXPECT_EQ(b.stride(pad), 1U);
    EXPECT_EQ(b.ticks(pad), static_cast<std::size_t>(std::llround(0.5 * three[pad].rate)));
  }
}

}  // namespace
}  // namespace slipbench::testing_bench

// A pad over the edge between two surfaces: ContactLabels sums their fields.
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::two_surfaces_test {
namespace {

// Three units of two elements: over the left box, over both, over the right one. Each box has its
// top at z = 0 and its edge at x = 0.
PadLayout straddling_pad() {
  PadLayout pad;
  for (const double x : {-6e-3, -4e-3, -1e-3, 1e-3, 4e-3, 6e-3}) {
    Element element;
    element.tip = {x, 0.0, 0.0};
    element.k_normal = 1000.0 + 1e5 * x;  // the right one of the middle unit is pressed harder
    element.k_tangential = 600.0;
    pad.elements.push_back(element);
  }
  pad.units = {{0, 2}, {2, 2}, {4, 2}};
  pad.element_truth = true;
  return pad;
}

TEST(TwoSurfaces, PadOverTheirEdgeReadsAsOnOnePlane) {
  const PadLayout pad = straddling_pad();
  const Box box{{20e-3, 20e-3, 5e-3}};
  const std::array<Eigen::Vector3d, 2> middles{Eigen::Vector3d(-20e-3, 0.0, -5e-3), Eigen::Vector3d(20e-3, 0.0, -5e-3)};
  std::vector<Field> two, one;
  for (std::size_t k = 0; k < 2; ++k) two.emplace_back(pad, box, Friction{0.5, 0.4});
  one.emplace_back(pad, Plane{}, Friction{0.5, 0.4});
  ContactLabels summed(pad), plain(pad);
  int slipping = 0;
  for (int tick = 0; tick < 200; ++tick) {
    // Down from 0.1 mm above to 1 mm below, then along the edge at 20 mm/s: sticks, then slips from
    // the lightest element on, unit by unit.
    const Pose pose = at(0.0, tick < 60 ? 0.0 : 20e-6 * (tick - 60), std::max(-1e-3, 0.1e-3 - 2e-5 * tick));
    for (std::size_t k = 0; k < 2; ++k) {
      Pose in_box = pose;
      in_box.position -= middles[k];
      two[k].step(in_box, 1e-3);
    }
    one[0].step(pose, 1e-3);
    const ContactFrame &a = summed.update(two, 1e-3 * tick, 1e-3), &b = plain.update(one, 1e-3 * tick, 1e-3);
    EXPECT_TRUE(a.force.isApprox(b.force, 1e-12) || (a.force - b.force).abs().maxCoeff() < 1e-12) << tick;
    EXPECT_LT((a.contact_force - b.contact_force).abs().maxCoeff(), 1e-12) << tick;
    // Lengths agree up to the rounding of coordinates of 20 mm (the field's shortest slip is 1e-13
    // m).
    EXPECT_LT((a.displacement - b.displacement).abs().maxCoeff(), 1e-12) << tick;
    EXPECT_LT((a.slip_distance - b.slip_distance).abs().maxCoeff(), 1e-12) << tick;
    ASSERT_EQ(a.element_depth.size(), 6);
    EXPECT_LT((a.element_depth - b.element_depth).abs().maxCoeff(), 1e-12) << tick;
    EXPECT_LT((a.element_shear - b.element_shear).abs().maxCoeff(), 1e-12) << tick;
    EXPECT_NEAR(b.element_depth[0], std::max(0.0, -pose.position.z()), 1e-15) << tick;
    EXPECT_EQ(a.unit_state, b.unit_state) << tick;
    EXPECT_EQ(a.state, b.state) << tick;
    EXPECT_EQ(a.state_micro, b.state_micro) << tick;
    if (b.state != PadState::no_contact) {
      EXPECT_EQ(a.stuck_fraction, b.stuck_fraction) << tick;
    }
    ASSERT_EQ(a.events.size(), b.events.size()) << tick;
    for (std::size_t k = 0; k < a.events.size(); ++k) {
      EXPECT_EQ(a.events[k].unit, b.events[k].unit);
      EXPECT_EQ(a.events[k].kind, b.events[k].kind);
      EXPECT_NEAR(a.events[k].time, b.events[k].time, 1e-9);
    }
    for (const Eigen::Index unit : {0, 2}) {  // each on one box
      EXPECT_LT((a.slip_velocity.col(unit) - b.slip_velocity.col(unit)).abs().maxCoeff(), 1e-9) << tick;
      if (b.unit_state[static_cast<std::size_t>(unit)] != UnitState::detached) {
        EXPECT_NEAR(a.margin[unit], b.margin[unit], 1e-9) << tick;
      }
    }
    slipping += b.state == PadState::gross ? 1 : 0;
    // The margin of the middle unit is that of its right element alone, which is pressed harder: 1
    // - |f_t|/(mu_s f_n).
    if (a.unit_state[1] == UnitState::stick) {
      EXPECT_NEAR(a.margin[1], 1.0 - two[1].tangential_force(3).norm() / two[1].stick_limit(3), 1e-12) << tick;
    }
  }
  EXPECT_GT(slipping, 10);
}

}  // namespace
}  // namespace slipbench::testing_field::two_surfaces_test

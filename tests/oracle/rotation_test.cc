// Oracle 3: a pad turning about a point at distance r from a pillar. While it sticks the pillar's
// stretch is the chord 2 r sin(theta/2), so it slips at theta = 2 asin(mu f_n/(2 k_t r)). In steady
// sliding the bristle trails: its stretch e = mu f_n/k_t is tangent to the anchor's circle, so the
// anchor moves at radius sqrt(r^2 - e^2), which is also the lever of the force.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/oracle/pads.h"

namespace slipbench::oracle::rotation_test {
namespace {

constexpr double k_n = 7100.0, k_t = 3900.0, compression = 1e-3;

Pose turned_about(const Eigen::Vector2d& pivot, double angle) {
  Pose pose = turned(angle, {0.0, 0.0, -compression});
  const Eigen::Vector3d p(pivot.x(), pivot.y(), 0.0);
  pose.position += p - pose.rotation * p;
  return pose;
}

TEST(Rotation, PillarsSlipByRadius) {
  for (const Eigen::Vector2d& pivot : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(4e-3, -2.5e-3)}) {
    for (const double mu : {0.2, 0.5, 1.0}) {
      for (const double rate : {0.1, -0.4, 1.6}) {  // rad/s
        const PadLayout pad = nine_pillars();
        Field field(pad, Plane{}, {mu, mu});
        FirstTimes first(9, EventKind::slip);
        std::vector<double> exact(9, std::nan(""));
        double last = 0.0;
        for (std::size_t p = 0; p < 9; ++p) {
          const double r = (pad.elements[p].tip.head<2>() - pivot).norm();
          const double chord = mu * k_n * (compression - pad.elements[p].tip.z()) / k_t;
          if (chord < 2.0 * r) {
            exact[p] = 2.0 * std::asin(chord / (2.0 * r)) / std::abs(rate);
            last = std::max(last, exact[p]);
          }
        }
        drive(
            field, 1e-3, std::ceil(1.02 * last / 1e-3) * 1e-3, [&](double t) { return turned_about(pivot, rate * t); },
            std::ref(first));
        for (std::size_t p = 0; p < 9; ++p) {
          if (std::isnan(exact[p])) {
            EXPECT_TRUE(std::isnan(first.times()[p])) << "pillar " << p << " cannot slip";
          } else {
            EXPECT_NEAR(first.times()[p], exact[p], 1e-3 * exact[p]) << "pillar " << p << ", mu " << mu << ", rate " << rate;
          }
        }
      }
    }
  }
}

TEST(Rotation, SteadyTorqueActsAtTheTrailingLever) {
  const double mu = 0.5, rate = 0.5;
  const PadLayout pad = nine_pillars();
  Field field(pad, Plane{}, {mu, mu});
  ContactFrame last;
  drive(
      field, 1e-3, 4.0,
      [&](double t) {
        return turned_about({0.0, 0.0}, rate * t);
      },
      [&](const ContactFrame& frame) { last = frame; });
  double exact = 0.0, naive = 0.0;
  for (const Element& pillar : pad.elements) {
    const double r = pillar.tip.head<2>().norm();
    if (r == 0.0) continue;  // the centre pillar only twists
    const double limit = mu * k_n * (compression - pillar.tip.z()), stretch = limit / k_t;
    exact += limit * std::sqrt(r * r - stretch * stretch);
    naive += limit * r;
  }
  const double torque = std::abs(field.wrench_on_pad().torque.z());
  EXPECT_NEAR(torque, exact, 1e-3 * exact);
  EXPECT_GT(naive - torque, 3e-3 * naive);  // the lever matters

  // The outer eight slip, the centre one sticks: incipient by the strict rule, about the centre, at
  // the drive's rate.
  EXPECT_EQ(last.state, PadState::incipient);
  EXPECT_EQ(last.unit_state[4], UnitState::stick);
  EXPECT_NEAR(last.slip_centre.x(), 0.0, 1e-6);
  EXPECT_NEAR(last.slip_centre.y(), 0.0, 1e-6);
  EXPECT_GT(last.slip_angle, 0.9 * rate * 4.0 - 0.2);
}

TEST(Rotation, CombinedSlideStaysInsideTheLimitSurface) {
  // Rigid slip with velocity (v, w) about the origin dissipates most among all admissible forces
  // (maximum dissipation), so every reached (F, M) obeys F.v + M w <= sum mu f_n |v_i| up to the
  // trailing lever's share, with equality as the stretch becomes short (stiff pad).
  const double mu = 0.5, stiff = 1e3;
  const PadLayout pad = nine_pillars(1, k_n, k_t * stiff);
  for (const double angle : {0.0, 0.3, 0.7, 1.1, 1.5}) {
    const double v = 4e-3 * std::cos(angle), w = 0.6 * std::sin(angle);
    Field field(pad, Plane{}, {mu, mu});
    // The pivot of a motion that turns at w and slides at v.
    drive(
        field, 1e-4, 0.05,
        [&](double t) {
          Pose pose = turned(w * t, {v * t, 0.0, -compression});
          return pose;
        },
        [](const ContactFrame&) {});
    const Wrench wrench = field.wrench_on_surface();
    double bound = 0.0;
    const Pose pose = field.pad_in_surface();
    for (const Element& pillar : pad.elements) {
      const Eigen::Vector3d arm = pose.rotation * pillar.tip;
      const double speed = Eigen::Vector2d(v - w * arm.y(), w * arm.x()).norm();
      bound += mu * k_n * (compression - pillar.tip.z()) * speed;
    }
    const double torque_about_pad =
        wrench.torque.z() - (pose.position.x() * wrench.force.y() - pose.position.y() * wrench.force.x());
    const double power = wrench.force.x() * v + torque_about_pad * w;
    EXPECT_NEAR(power, bound, 1e-3 * bound) << "angle " << angle;
    EXPECT_LE(power, bound * (1.0 + 1e-9));
  }
}

}  // namespace
}  // namespace slipbench::oracle::rotation_test

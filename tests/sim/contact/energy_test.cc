// A frictionless field stores work and returns it, but never returns more. Edges are critical,
// because the face that an element touches changes there.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::energy_test {
namespace {

using Vector = Eigen::Vector3d;

constexpr double k_n = 1000.0;

double normal_energy(const Field& field) {
  double energy = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    energy += 0.5 * field.layout().elements[i].k_normal * field.penetration(i) * field.penetration(i);
  }
  return energy;
}

TEST(FieldEnergy, ElementSweptInFromTheSidePressesWithWhatItIsPressedFurther) {
  // The tip 0.5 mm below the top of a box moves in by 2 mm from its side, is pressed by 0.3 mm
  // more, lifted by 0.4 mm, pressed by 0.2 mm. After the lift it is 0.4 mm below the top, so the
  // last press is 0.2 mm.
  Field field(one_element(k_n, k_n), Box{{10e-3, 10e-3, 10e-3}}, {0.5, 0.5});
  for (int k = 0; k <= 40; ++k) {
    field.step(at(11e-3 - 0.05e-3 * k, 0.0, 9.5e-3), 1e-3);
    ASSERT_EQ(field.normal_force(0), 0.0) << k;
    ASSERT_EQ(field.state(0), ElementState::detached);
  }
  const auto force_at = [&](double z) {
    field.step(at(9e-3, 0.0, z), 1e-3);
    return field.normal_force(0);
  };
  EXPECT_NEAR(force_at(9.2e-3), k_n * 0.3e-3, 1e-12);  // 10 mm round to 1e-18 m
  EXPECT_EQ(force_at(9.6e-3), 0.0);
  EXPECT_NEAR(force_at(9.4e-3), k_n * 0.2e-3, 1e-12);
  EXPECT_EQ(field.normal(0), Vector::UnitZ());
  // Outside above the top the history is discarded.
  EXPECT_EQ(force_at(10.1e-3), 0.0);
  EXPECT_NEAR(force_at(9.4e-3), k_n * 0.6e-3, 1e-12);
}

TEST(FieldEnergy, ChangeOfFaceKeepsThePenetrationAndLetsTheStretchGo) {
  // The axis leans by atan(1/4) towards the side x = 10 mm: behind both faces the side applies
  // while it is nearer in the backward direction, dx < dz/4. Having entered by the side at dx =
  // 0.05 mm, dz = 1 mm, the tip goes in along x: at dx = 0.25 mm the top applies, with the
  // penetration of the side.
  PadLayout pad = one_element(k_n, k_n);
  pad.elements[0].axis = Vector(-1.0, 0.0, -4.0).normalized();
  Field field(pad, Box{{10e-3, 10e-3, 10e-3}}, {10.0, 10.0});
  const auto to = [&](double dx) { field.step(at(10e-3 - dx, 0.0, 9e-3), 1e-3); };
  to(-0.05e-3);
  to(0.05e-3);
  EXPECT_EQ(field.normal(0), Vector::UnitX());
  EXPECT_NEAR(field.penetration(0), 0.05e-3, 1e-17);
  to(0.24e-3);
  EXPECT_EQ(field.normal(0), Vector::UnitX());
  EXPECT_NEAR(field.penetration(0), 0.24e-3, 1e-17);
  to(0.26e-3);
  EXPECT_EQ(field.normal(0), Vector::UnitZ());
  EXPECT_NEAR(field.penetration(0), 0.24e-3, 1e-17) << "not the 1 mm of the top";
  EXPECT_EQ(field.tangential_force(0), Vector(0.0, 0.0, 0.0));
  EXPECT_EQ(field.state(0), ElementState::stick);
  to(0.30e-3);
  EXPECT_NEAR(field.penetration(0), 0.24e-3, 1e-17);
  EXPECT_NEAR((field.tangential_force(0) - k_n * Vector(-0.04e-3, 0.0, 0.0)).norm(), 0.0, 1e-12) << "the stretch since";
}

TEST(FieldEnergy, ElementThatPassesTheWidestPartOfABallPressesWithWhatItIsPressedFurther) {
  // The tip comes up beside the middle of a ball, 1 mm inside at its equator, where its axis begins
  // to point at the surface in front of it. Upwards it leaves the ball; sideways by 0.2 mm, at a
  // height of 2 mm, it goes further in.
  Field field(one_element(k_n, k_n), Sphere{10e-3}, {0.5, 0.5});
  for (int k = 0; k <= 70; ++k) {
    field.step(at(9e-3, 0.0, -5e-3 + 0.1e-3 * k), 1e-3);
    ASSERT_EQ(field.normal_force(0), 0.0) << k;
  }
  field.step(at(8.8e-3, 0.0, 2e-3), 1e-3);
  EXPECT_NEAR(field.normal_force(0), k_n * (std::hypot(9e-3, 2e-3) - std::hypot(8.8e-3, 2e-3)), 1e-12);
}

// True if p is beyond the plane of the face with the outward normal n, or outside the side of a
// cylinder.
bool beyond(const Box& box, const Vector& p, const Vector& n) { return n.dot(p) > n.cwiseAbs().dot(box.half); }
bool beyond(const Cylinder& cylinder, const Vector& p, const Vector& n) {
  return n.z() != 0.0 ? n.z() * p.z() > cylinder.half_length : p.head<2>().norm() > cylinder.radius;
}

template <class Shape>
void check_faces(const Shape& shape, RandomStream& draw) {
  const auto met = [&](const Vector& p, const Vector& a) { return shape.at(p.x(), p.y(), p.z(), a.x(), a.y(), a.z()); };
  const auto point = [&](double reach) {
    return Vector(draw.uniform(-reach, reach), draw.uniform(-reach, reach), draw.uniform(-reach, reach));
  };
  int may = 0, may_not = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vector axis = Vector(draw.normal(), draw.normal(), draw.normal()).normalized(), p = point(16e-3), q = point(7e-3);
    const SurfacePoint from = met(p, axis), to = met(q, axis);
    if (to.gap > 0.0) {
      ASSERT_EQ(to.faces, 0U) << "q is inside: it looks away";
    }
    if (from.gap < 0.0 || to.gap > 0.0 || from.faces == 0U) continue;
    const bool expected = beyond(shape, p, {to.nx, to.ny, to.nz});
    ASSERT_EQ((from.faces & to.faces) != 0U, expected) << "from " << p.transpose() << " to " << q.transpose();
    (expected ? may : may_not) += 1;
  }
  EXPECT_GT(may, 1000);
  EXPECT_GT(may_not, 1000);
}

TEST(FieldEnergy, AFaceIsEnteredFromBeyondItsPlaneOnly) {
  RandomStream draw(2, 0, "faces");
  check_faces(Box{{8e-3, 9e-3, 10e-3}}, draw);
  check_faces(Cylinder{10e-3, 8e-3}, draw);
}

TEST(FieldEnergy, ElementThatEntersByTheFaceItLooksAtIsPressedByAllItsDepth) {
  RandomStream draw(1, 0, "entry");
  Field field(one_element(k_n, k_n), Box{{10e-3, 10e-3, 10e-3}}, {0.5, 0.5});
  for (int k = 0; k < 200; ++k) {
    const double x = draw.uniform(-9e-3, 9e-3), y = draw.uniform(-9e-3, 9e-3), depth = draw.uniform(1e-6, 2e-3);
    field.step(at(x, y, 10e-3 + draw.uniform(1e-9, 1e-3)), 1e-3);
    field.step(at(x, y, 10e-3 - depth), 1e-3);
    EXPECT_NEAR(field.penetration(0), depth, 1e-17);
  }
}

// Waves of all six coordinates: 4 mm sideways, pressed by up to 1.2 mm and lifted by as much,
// turned by `lean` about each axis.
struct Waves {
  Pose facing;
  double lean;
  double rate[6], phase[6];

  Waves(RandomStream& draw, Pose start, double most) : facing(std::move(start)), lean(most) {
    for (int k = 0; k < 6; ++k) rate[k] = draw.uniform(2.0, 25.0), phase[k] = draw.uniform(0.0, 2.0 * std::numbers::pi);
  }

  [[nodiscard]] Pose at(double t) const {
    const auto wave = [&](int k) { return std::sin(rate[k] * t + phase[k]); };
    Pose local;
    local.rotation = (Eigen::AngleAxisd(lean * wave(0), Vector::UnitZ()) * Eigen::AngleAxisd(lean * wave(1), Vector::UnitX()) *
                      Eigen::AngleAxisd(lean * wave(2), Vector::UnitY()))
                         .toRotationMatrix();
    local.position = {4e-3 * wave(3), 4e-3 * wave(4), 1.2e-3 * wave(5)};
    return facing * local;
  }
};

struct Balance {
  double given = 0.0;       // work of the field on the pad [J]
  double rounding = 0.0;    // J, share of it that may come from the finite steps
  double taken = 0.0;       // J, work of the steps in which the pad pressed
  std::size_t changes = 0;  // changes of the face under an element in contact
};

// True if the tip is behind a face that its axis points at.
bool is_inside(const Field& field, const Surface& surface, std::size_t i) {
  const Vector tip = field.pad_in_surface() * field.layout().elements[i].tip;
  const Vector axis = field.pad_in_surface().rotation * field.layout().elements[i].axis;
  return std::visit([&](const auto& s) { return s.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z()); }, surface).gap <
         0.0;
}

// Accounts for one step of an element whose tip moved by d. The work k delta n.d is summed by the
// trapezoidal rule, whose error is
// - zero on one flat face, where delta is linear in d,
// - on a curved face |d|^3/12 times the second derivative of k delta c along d, c = n.d/|d|: on a
//   ball, which curves most, 3 c (1 - c^2) k (1 + delta/R)/R, and c (1 - c^2) < 0.39, so below 2 k
//   (1 + delta/R)/R,
// - at a touch or a lift-off, where delta is linear only in a share s of the step, k |d|^2 (s -
//   s^2)/2: at most |d|^2/8,
// - at a change of face at most the whole term, k delta |d| with the larger of the two forces.
void account(const Field& before, const Field& after, std::size_t i, const Vector& d, double bend, Balance& sum) {
  const double k = after.layout().elements[i].k_normal, old_depth = before.penetration(i), new_depth = after.penetration(i);
  if (old_depth == 0.0 && new_depth == 0.0) return;
  const double size = d.norm();
  const double work = 0.5 * k * (old_depth * before.normal(i) + new_depth * after.normal(i)).dot(d);
  sum.given += work;
  sum.taken += std::max(0.0, -work);
  if (old_depth == 0.0 || new_depth == 0.0) {
    sum.rounding += k * size * size / 8.0;
  } else if ((before.normal(i) - after.normal(i)).norm() > 1.1 * size * bend) {
    sum.rounding += k * std::max(old_depth, new_depth) * size;
    ++sum.changes;
  } else {
    sum.rounding += k * size * size * size / 12.0 * 2.0 * bend * (1.0 + std::max(old_depth, new_depth) * bend);
  }
}

TEST(FieldEnergy, AFrictionlessFieldNeverGivesMoreThanItTook) {
  // At every tick of random motions: the work returned, minus the error of finite steps, is at most
  // the initial energy minus the current one.
  struct Case {
    Shape shape;
    double bend;  // 1/m, largest curvature down to a quarter of the radius of 15 mm below the surface, deeper than any tip
    bool edges;
  };
  std::size_t changes = 0, spared = 0;
  double taken = 0.0, rounding = 0.0;
  for (const Case& met : {Case{Shape::box, 0.0, true}, Case{Shape::cylinder, 1.0 / 11.25e-3, true},
                          Case{Shape::capsule, 1.0 / 11.25e-3, false}, Case{Shape::sphere, 1.0 / 11.25e-3, false}}) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      RandomStream draw(seed, static_cast<std::uint64_t>(met.shape), "field energy");
      const Target target = testing_field::target(met.shape);
      PadLayout pad = random_pad(draw, 20, false);
      if (seed % 3 == 0) {  // neither splayed nor leaning: moved from outside to under the top at once
        for (Element& element : pad.elements) element.axis = -Vector::UnitZ();
      }
      Field before(pad, target.surface, {0.0, 0.0}), after(pad, target.surface, {0.0, 0.0});
      const Waves motion(draw, target.facing, seed % 3 == 0 ? 0.0 : seed % 3 == 1 ? 0.05 : 0.4);
      before.step(motion.at(0.0), 1.0);
      after.step(motion.at(0.0), 1.0);
      const double at_start = normal_energy(after);
      Balance sum;
      const double dt = 20e-6;  // some 2 um a step
      for (int tick = 1; tick < 40000; ++tick) {
        after.step(motion.at(tick * dt), dt);
        for (std::size_t i = 0; i < after.size(); ++i) {
          const Vector& tip = pad.elements[i].tip;
          account(before, after, i, after.pad_in_surface() * tip - before.pad_in_surface() * tip, met.bend, sum);
          if (tick % 100 == 0 && after.penetration(i) == 0.0 && is_inside(after, target.surface, i)) ++spared;
        }
        // A sum of energies, each exact to some 1e-16 of the current ones.
        const double released = at_start - normal_energy(after), tolerance = sum.rounding + 1e-12 * (at_start + sum.taken);
        ASSERT_LE(sum.given, released + tolerance)
            << "shape " << static_cast<int>(met.shape) << ", seed " << seed << ", tick " << tick << ", taken " << sum.taken;
        if (!met.edges) {
          ASSERT_GE(sum.given, released - tolerance) << "without edges nothing is lost either";
        }
        before.step(motion.at(tick * dt), dt);
      }
      changes += sum.changes;
      taken += sum.taken;
      rounding += sum.rounding;
    }
  }
  EXPECT_GT(changes, 30U) << "faces change under elements in contact";
  EXPECT_GT(spared, 300U) << "and elements are swept in from the sides";
  EXPECT_LT(rounding, 0.01 * taken) << "the finite steps hide nothing";
}

}  // namespace
}  // namespace slipbench::testing_field::energy_test

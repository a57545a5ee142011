// Properties of every element of every field at every step: random pads, surfaces, frictions and
// motions.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::field_property_test {
namespace {

// A force is a product and sum of a few rounded numbers: 1e-12 is some thousand roundings.
constexpr double rounding = 1e-12;

struct Seen {
  std::size_t detached = 0, stick = 0, slip = 0;
};

void check_element(const Field& field, std::size_t i, double path_before, bool dashpots, Seen& seen) {
  const Element& element = field.layout().elements[i];
  const double f_n = field.normal_force(i), depth = field.penetration(i), path = field.slip_path(i);
  const Eigen::Vector3d f_t = field.tangential_force(i), u = field.stretch(i), slip = field.slip_step(i), n = field.normal(i);
  ASSERT_TRUE(std::isfinite(f_n) && std::isfinite(path) && f_t.allFinite() && u.allFinite() && slip.allFinite() && n.allFinite());
  ASSERT_NEAR(n.norm(), 1.0, rounding);
  ASSERT_GE(f_n, 0.0);
  if (!dashpots) {
    ASSERT_NEAR(f_n, element.k_normal * depth, rounding * f_n);
    ASSERT_NEAR((f_t - element.k_tangential * u).norm(), 0.0, element.k_tangential * 1e-15)
        << "positions of 20 mm round at 1e-18 m";
  }
  ASSERT_NEAR(f_t.dot(n), 0.0, rounding * f_n);

  const double limit_static = field.friction().mu_static * f_n, limit_kinetic = field.friction().mu_kinetic * f_n;
  ASSERT_NEAR(field.stick_limit(i), limit_static, rounding * limit_static);
  ASSERT_NEAR(path - path_before, slip.norm(), 1e-15);
  ASSERT_GE(path, path_before);
  ASSERT_GE(f_t.dot(slip), 0.0) << "friction takes energy, never gives it";
  switch (field.state(i)) {
    case ElementState::detached:
      ++seen.detached;
      ASSERT_EQ(f_n, 0.0);
      ASSERT_EQ(f_t.norm(), 0.0);
      ASSERT_EQ(u.norm(), 0.0);
      ASSERT_EQ(slip.norm(), 0.0);
      break;
    case ElementState::stick:
      ++seen.stick;
      ASSERT_GT(f_n, 0.0);
      ASSERT_LE(f_t.norm(), limit_static * (1.0 + rounding) + element.k_tangential * 2e-15) << "a stretch of 2 fm is rounding";
      ASSERT_EQ(slip.norm(), 0.0);
      break;
    case ElementState::slip:
      ++seen.slip;
      ASSERT_GT(f_n, 0.0);
      ASSERT_NEAR(f_t.norm(), limit_kinetic, rounding * limit_kinetic);
      break;
  }
}

TEST(FieldProperty, LawHoldsForRandomFieldsAndMotions) {
  Seen seen;
  for (const Shape shape : all_shapes) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const bool dashpots = seed % 3 == 2;
      RandomStream draw(seed, static_cast<std::uint64_t>(shape), "field property");
      const Target target = testing_field::target(shape);
      Field field(random_pad(draw, 300, dashpots), target.surface, random_friction(draw));
      const RandomMotion motion(draw, target.facing);
      const double dt = seed % 2 == 0 ? 1e-3 : 7e-3;
      std::vector<double> path(field.size(), 0.0);
      for (int tick = 0; tick < 200; ++tick) {
        field.step(motion.at(tick * dt), dt);
        for (std::size_t i = 0; i < field.size(); ++i) {
          ASSERT_NO_FATAL_FAILURE(check_element(field, i, path[i], dashpots, seen))
              << "shape " << static_cast<int>(shape) << ", seed " << seed << ", tick " << tick << ", element " << i;
          path[i] = field.slip_path(i);
        }
        for (const ElementEvent& event : field.events()) {
          ASSERT_GE(event.fraction, 0.0);
          ASSERT_LE(event.fraction, 1.0);
          ASSERT_NE(event.from, event.to);
          ASSERT_EQ(event.to, field.state(event.element));
        }
      }
    }
  }
  // The cases cover every branch often: 48 fields x 200 steps x some 150 elements.
  EXPECT_GT(seen.detached, 10000U);
  EXPECT_GT(seen.stick, 10000U);
  EXPECT_GT(seen.slip, 10000U);
}

Eigen::Vector3d moved(const Eigen::Vector3d& torque, const Eigen::Vector3d& force, const Eigen::Vector3d& from) {
  return torque + from.cross(force);  // about the world's origin
}

TEST(FieldProperty, ForcesAndTorquesOfBothSidesSumToZeroInTheWorld) {
  int loaded = 0;
  for (const Shape shape : all_shapes) {
    for (std::uint64_t seed = 100; seed < 108; ++seed) {
      RandomStream draw(seed, static_cast<std::uint64_t>(shape), "field momentum");
      const Target target = testing_field::target(shape);
      Field field(random_pad(draw, 100, seed % 2 == 0), target.surface, random_friction(draw));
      const RandomMotion motion(draw, target.facing);
      const Pose surface_in_world = random_pose(draw);
      for (int tick = 0; tick < 100; ++tick) {
        const Pose pad_in_surface = motion.at(tick * 1e-3);
        const Pose pad_in_world = surface_in_world * pad_in_surface;
        field.step(pad_in_surface, 1e-3);

        const Wrench on_pad = field.wrench_on_pad(), on_surface = field.wrench_on_surface();
        const Eigen::Vector3d force_on_pad = pad_in_world.rotation * on_pad.force;
        const Eigen::Vector3d force_on_surface = surface_in_world.rotation * on_surface.force;
        const Eigen::Vector3d torque_on_pad = moved(pad_in_world.rotation * on_pad.torque, force_on_pad, pad_in_world.position);
        const Eigen::Vector3d torque_on_surface =
            moved(surface_in_world.rotation * on_surface.torque, force_on_surface, surface_in_world.position);

        Eigen::Vector3d force_sum = Eigen::Vector3d::Zero(), torque_sum = Eigen::Vector3d::Zero();
        double total = 0.0;  // N, sum of the forces' magnitudes: the scale of rounding
        for (std::size_t i = 0; i < field.size(); ++i) {
          const Eigen::Vector3d force =
              surface_in_world.rotation * (field.normal_force(i) * field.normal(i) - field.tangential_force(i));
          force_sum += force;
          torque_sum += (surface_in_world * field.contact_point(i)).cross(force);
          total += force.norm();
        }
        loaded += total > 0.0;
        // Levers are below 1 m, so the same scale serves forces and torques.
        ASSERT_LE((force_on_pad + force_on_surface).norm(), rounding * total);
        ASSERT_LE((torque_on_pad + torque_on_surface).norm(), rounding * total);
        ASSERT_LE((force_on_pad - force_sum).norm(), rounding * total);
        ASSERT_LE((torque_on_pad - torque_sum).norm(), rounding * total);
      }
    }
  }
  EXPECT_GT(loaded, 1000);
}

TEST(FieldProperty, SurfaceMovingUnderAStillPadEqualsThePadMovingTheOppositeWay) {
  for (const Shape shape : all_shapes) {
    RandomStream draw(5, static_cast<std::uint64_t>(shape), "field frames");
    const Target target = testing_field::target(shape);
    const PadLayout pad = random_pad(draw, 60, false);
    const Friction friction = random_friction(draw);
    const RandomMotion motion(draw, target.facing);
    const Pose still = random_pose(draw);
    Field pad_moves(pad, target.surface, friction), surface_moves(pad, target.surface, friction);
    for (int tick = 0; tick < 200; ++tick) {
      const Pose relative = motion.at(tick * 2e-3);
      pad_moves.step(relative, 2e-3);
      // The pad is fixed at `still`; the surface moves so that the pad has the same pose relative
      // to it.
      const Pose surface_in_world = still * relative.inverse();
      surface_moves.step(surface_in_world.inverse() * still, 2e-3);
      const Wrench a = pad_moves.wrench_on_pad(), b = surface_moves.wrench_on_pad();
      // Poses of 0.5 m round at 1e-16 m; with k up to 1e4 N/m and 60 elements: 1e-10 N; levers of
      // 0.02 m. Rounding does not accumulate, because slip discards history.
      ASSERT_NEAR((a.force - b.force).norm(), 0.0, 1e-9) << "shape " << static_cast<int>(shape) << ", tick " << tick;
      ASSERT_NEAR((a.torque - b.torque).norm(), 0.0, 1e-10);
    }
  }
}

// Compares all values of element i of field a and element j of field b bit by bit.
void expect_same(const Field& a, std::size_t i, const Field& b, std::size_t j) {
  ASSERT_EQ(a.state(i), b.state(j));
  ASSERT_EQ(a.normal_force(i), b.normal_force(j));
  ASSERT_EQ(a.penetration(i), b.penetration(j));
  ASSERT_EQ(a.slip_path(i), b.slip_path(j));
  ASSERT_EQ(a.tangential_force(i), b.tangential_force(j));
  ASSERT_EQ(a.stretch(i), b.stretch(j));
  ASSERT_EQ(a.slip_step(i), b.slip_step(j));
}

TEST(FieldProperty, EveryElementDoesWhatAFieldOfItAloneDoes) {
  for (const Shape shape : all_shapes) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      RandomStream draw(seed, static_cast<std::uint64_t>(shape), "field alone");
      const Target target = testing_field::target(shape);
      const PadLayout pad = random_pad(draw, 30, seed % 2 == 1);
      const Friction friction = random_friction(draw);
      const RandomMotion motion(draw, target.facing);
      Field together(pad, target.surface, friction);
      std::vector<Field> alone;
      for (const Element& element : pad.elements) {
        PadLayout single;
        single.elements = {element};
        single.units = {{0, 1}};
        alone.emplace_back(single, target.surface, friction);
      }
      for (int tick = 0; tick < 200; ++tick) {
        const Pose pose = motion.at(tick * 2e-3);
        together.step(pose, 2e-3);
        std::size_t events = 0;
        for (std::size_t i = 0; i < alone.size(); ++i) {
          alone[i].step(pose, 2e-3);
          ASSERT_NO_FATAL_FAILURE(expect_same(together, i, alone[i], 0))
              << "seed " << seed << ", tick " << tick << ", element " << i;
          for (const ElementEvent& event : alone[i].events()) {
            ASSERT_LT(events, together.events().size());
            ASSERT_EQ(together.events()[events].element, i);
            ASSERT_EQ(together.events()[events].fraction, event.fraction);
            ++events;
          }
        }
        ASSERT_EQ(events, together.events().size());
      }
    }
  }
}

TEST(FieldProperty, MovedFieldGoesOnAsIfItHadStayed) {
  RandomStream draw(9, 0, "field move");
  const Target target = testing_field::target(Shape::sphere);
  const PadLayout pad = random_pad(draw, 50, true);
  const RandomMotion motion(draw, target.facing);
  Field stayed(pad, target.surface, {0.6, 0.4}), first(pad, target.surface, {0.6, 0.4});
  for (int tick = 0; tick < 50; ++tick) {
    stayed.step(motion.at(tick * 4e-3), 4e-3);
    first.step(motion.at(tick * 4e-3), 4e-3);
  }
  Field second(std::move(first));
  Field third(one_element(1.0, 1.0), Plane{}, {0.1, 0.1});
  third = std::move(second);
  for (int tick = 50; tick < 150; ++tick) {
    stayed.step(motion.at(tick * 4e-3), 4e-3);
    third.step(motion.at(tick * 4e-3), 4e-3);
    for (std::size_t i = 0; i < stayed.size(); ++i) ASSERT_NO_FATAL_FAILURE(expect_same(stayed, i, third, i));
  }
}

}  // namespace
}  // namespace slipbench::testing_field::field_property_test

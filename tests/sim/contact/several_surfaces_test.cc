// Surfaces that overlap or adjoin under a pad: each element touches one of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "sim/contact/several_surfaces.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "tests/oracle/pads.h"
#include "tests/sim/contact/random_case.h"
#include "tests/sim/stage/simulation_rig.h"

namespace slipbench::testing_field::several_surfaces_test {
namespace {

constexpr double k_n = 7100.0, k_t = 3900.0, mu = 0.5;

// A surface and its place in the world.
struct Placed {
  Surface shape;
  Eigen::Vector3d place;
};

PadLayout pillars(int side = 3, double width = 8e-3) { return oracle::square_grid(side, width, k_n, k_t); }

// Pads of one layout on several surfaces, stepped by poses in the world.
class Rig {
 public:
  Rig(const PadLayout& pad, std::vector<Placed> surfaces, const std::vector<Named>& effects = {})
      : surfaces_(std::move(surfaces)), labels_(pad) {
    for (const Placed& surface : surfaces_) {
      fields.emplace_back(pad, surface.shape, Friction{mu, mu}, install_effects(effects, pad, surface.shape, 1, 0));
    }
  }

  const ContactFrame& step(const Pose& pose) {
    std::vector<Pose> poses;
    for (const Placed& surface : surfaces_) poses.push_back({pose.rotation, pose.position - surface.place});
    step_on_surfaces(fields, poses, 1e-3, {});
    time_ += 1e-3;
    return labels_.update(fields, time_, 1e-3);
  }

  [[nodiscard]] std::size_t touching_twice() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < fields.front().size(); ++i) {
      count += std::ranges::count_if(fields, [i](const Field& f) { return f.state(i) != ElementState::detached; }) > 1 ? 1 : 0;
    }
    return count;
  }

  std::vector<Field> fields;

 private:
  std::vector<Placed> surfaces_;
  ContactLabels labels_;
  double time_ = 0.0;
};

// Down to `depth` in 10 steps, then 0.05 mm sideways in one.
const ContactFrame& press_and_shear(Rig& rig, double depth, double x = 0.0) {
  for (int k = 0; k <= 10; ++k) rig.step(at(x, 0.0, 0.1e-3 - (depth + 0.1e-3) * k / 10.0));
  return rig.step(at(x + 0.05e-3, 0.0, -depth));
}

void expect_one_spring_each(std::vector<Placed> surfaces, const char* what) {
  // Each of 9 pillars is 0.3 mm deep in the union of all: f_n = k_n d, and after 0.05 mm of shear,
  // within the cone (k_t u = 0.195 N < mu k_n d = 1.065 N), f_t = k_t u.
  PadLayout pad = pillars();
  pad.unit_height = 5e-3;  // so that a thin plate supports it (thin_surface_test.cc)
  Rig rig(pad, std::move(surfaces));
  const ContactFrame& frame = press_and_shear(rig, 0.3e-3);
  for (Eigen::Index unit = 0; unit < 9; ++unit) {
    EXPECT_NEAR(frame.force(2, unit), k_n * 0.3e-3, 1e-9) << what << ", unit " << unit;
    EXPECT_NEAR(frame.force(0, unit), -k_t * 0.05e-3, 1e-9) << what << ", unit " << unit;
    EXPECT_NEAR(frame.displacement(2, unit), 0.3e-3, 1e-12) << what << ", unit " << unit;
    EXPECT_EQ(frame.unit_state[static_cast<std::size_t>(unit)], UnitState::stick) << what;
  }
  EXPECT_EQ(rig.touching_twice(), 0U) << what;
}

const Box wide{{20e-3, 20e-3, 10e-3}};

TEST(SeveralSurfaces, ElementsPressOnceWhereSurfacesOverlap) {
  const Eigen::Vector3d below(0.0, 0.0, -10e-3);
  expect_one_spring_each({{wide, below}}, "one box");
  expect_one_spring_each({{wide, below}, {wide, below}}, "two boxes in one place");
  expect_one_spring_each({{wide, below}, {wide, below}, {wide, below}}, "three boxes in one place");
  expect_one_spring_each({{wide, below}, {wide, below + Eigen::Vector3d(15e-3, 3e-3, 0.0)}}, "two boxes side by side");
  expect_one_spring_each({{Box{{30e-3, 5e-3, 10e-3}}, below}, {Box{{5e-3, 30e-3, 10e-3}}, below}}, "a cross of two bars");
  expect_one_spring_each({{Box{{10e-3, 20e-3, 10e-3}}, below + Eigen::Vector3d(-10e-3, 0.0, 0.0)},
                          {Box{{10e-3, 20e-3, 10e-3}}, below + Eigen::Vector3d(10e-3, 0.0, 0.0)}},
                         "halves, flush under the middle pillars");
  expect_one_spring_each({{wide, below}, {Plane{}, Eigen::Vector3d::Zero()}}, "box and plane, level");
  expect_one_spring_each({{Plane{}, Eigen::Vector3d::Zero()}, {Cylinder{15e-3, 5e-3}, {0.0, 0.0, -5e-3}}},
                         "plane and disc, level");
  expect_one_spring_each({{wide, below}, {Box{{5e-3, 5e-3, 5e-3}}, below}}, "a box inside of a box");
  expect_one_spring_each({{Box{{20e-3, 20e-3, 0.1e-3}}, {0.0, 0.0, -0.1e-3}}, {wide, below - Eigen::Vector3d(0.0, 0.0, 0.2e-3)}},
                         "a plate of 0.2 mm on a box: the face met first is the plate's");
}

TEST(SeveralSurfaces, TheFaceMetFirstCounts) {
  // Tops at 0 and 0.1 mm: a pillar that comes down over both touches the higher one, in either
  // order.
  const Placed low{wide, {0.0, 0.0, -10e-3}}, high{wide, {0.0, 0.0, -9.9e-3}};
  for (const auto& surfaces : {std::vector{low, high}, std::vector{high, low}}) {
    Rig rig(pillars(), surfaces);
    const ContactFrame& frame = press_and_shear(rig, 0.3e-3);
    EXPECT_NEAR(frame.force(2, 4), k_n * 0.4e-3, 1e-9);
    EXPECT_NEAR(frame.displacement(2, 4), 0.4e-3, 1e-12);
  }
}

TEST(SeveralSurfaces, ABallInABoxIsMetWhereItStandsOut) {
  // A ball of 8 mm protrudes 0.1 mm above a box: under its crest a pillar is 0.4 mm deep, beside it
  // 0.3 mm deep in the box.
  Rig rig(pillars(), {{wide, {0.0, 0.0, -10e-3}}, {Sphere{8e-3}, {0.0, 0.0, -7.9e-3}}});
  const ContactFrame& frame = press_and_shear(rig, 0.3e-3);
  EXPECT_NEAR(frame.force.matrix().col(4).norm(), std::hypot(k_n * 0.4e-3, k_t * 0.05e-3), 1e-3);
  for (const Eigen::Index corner : {0, 2, 6, 8}) EXPECT_NEAR(frame.force(2, corner), k_n * 0.3e-3, 1e-9);
}

// Events at one instant are unordered.
std::vector<ContactEvent> by_unit(std::vector<ContactEvent> events) {
  std::ranges::stable_sort(events, {}, &ContactEvent::unit);
  return events;
}

// The same path over a plane and over surfaces with a seam at x = 0 gives the same forces.
void expect_as_on_a_plane(const PadLayout& pad, std::vector<Placed> surfaces, const std::vector<Named>& effects, double shortest,
                          double tilt = 0.0) {
  Rig seams(pad, std::move(surfaces), effects), plane(pad, {{Plane{}, Eigen::Vector3d::Zero()}}, effects);
  int stuck = 0, slipping = 0;
  for (int tick = 0; tick < 600; ++tick) {
    // Down to 0.3 mm, then 6 mm along x with 12 mm/s, back by 0.1 mm, and up.
    const double x = tick < 40 ? 0.0 : tick < 540 ? 12e-6 * (tick - 40) : 6e-3 - 5e-6 * (tick - 540);
    const double z = tick < 590 ? std::max(-0.3e-3, 0.05e-3 - 1e-5 * tick) : -0.3e-3 + 4e-5 * (tick - 589);
    const Pose pose{Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix(), {x - 3.02e-3, 0.1e-3, z}};
    const ContactFrame &a = seams.step(pose), &b = plane.step(pose);
    ASSERT_EQ(seams.touching_twice(), 0U) << tick;
    ASSERT_LT((a.force - b.force).abs().maxCoeff(), shortest * k_n) << tick;
    ASSERT_LT((a.displacement - b.displacement).abs().maxCoeff(), shortest) << tick;
    ASSERT_LT((a.slip_distance - b.slip_distance).abs().maxCoeff(), shortest) << tick;
    ASSERT_EQ(a.unit_state, b.unit_state) << tick;
    const std::vector<ContactEvent> ours = by_unit(a.events), theirs = by_unit(b.events);
    ASSERT_EQ(ours.size(), theirs.size()) << tick;
    for (std::size_t k = 0; k < ours.size(); ++k) {
      EXPECT_EQ(ours[k].unit, theirs[k].unit) << tick;
      EXPECT_EQ(ours[k].kind, theirs[k].kind) << tick;
      EXPECT_NEAR(ours[k].time, theirs[k].time, 1e-9) << tick;
    }
    stuck += b.state == PadState::non_slip ? 1 : 0;
    slipping += b.state == PadState::gross ? 1 : 0;
  }
  EXPECT_GT(stuck, 20);
  EXPECT_GT(slipping, 200);
}

std::vector<Placed> halves(double overlap) {
  const double half = 10e-3 + 0.5 * overlap;
  return {{Box{{half, 20e-3, 10e-3}}, {0.5 * overlap - half, 0.0, -10e-3}},
          {Box{{half, 20e-3, 10e-3}}, {half - 0.5 * overlap, 0.0, -10e-3}}};
}

TEST(SeveralSurfaces, ASeamBetweenLevelFacesIsNotFelt) {
  // Lengths agree up to the rounding of coordinates of 20 mm, accumulated over some hundred steps.
  for (const double overlap : {0.0, 0.3e-3}) expect_as_on_a_plane(pillars(), halves(overlap), {}, 1e-12);
  expect_as_on_a_plane(pillars(9), halves(0.0), {}, 1e-12);  // 81 elements: a sparse field (active_set.h)
  // Slices of 1 mm: a pillar crosses six seams.
  std::vector<Placed> slices;
  for (int k = -9; k < 9; ++k) slices.push_back({Box{{0.5e-3, 20e-3, 10e-3}}, {1e-3 * k + 0.5e-3, 0.0, -10e-3}});
  expect_as_on_a_plane(pillars(), slices, {}, 1e-12);
}

TEST(SeveralSurfaces, ASeamIsNotFeltByATiltedPad) {
  // Just past a seam an element's column comes from the other half. With and without a known
  // height, on boxes and on a box next to a mesh.
  constexpr double degree = std::numbers::pi / 180.0;
  PadLayout high = pillars();
  high.unit_height = 5e-3;
  for (const double tilt : {-3.0 * degree, -0.1 * degree, 0.1 * degree, 1.0 * degree, 3.0 * degree}) {
    SCOPED_TRACE(tilt / degree);
    expect_as_on_a_plane(pillars(), halves(0.0), {}, 1e-11, tilt);
    expect_as_on_a_plane(high, halves(0.0), {}, 1e-11, tilt);
    expect_as_on_a_plane(high, halves(0.3e-3), {}, 1e-11, tilt);
  }
}

TEST(SeveralSurfaces, AStillTiltedPadPressesBesideASeamAsOnAPlane) {
  const double tilt = std::numbers::pi / 180.0;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
  PadLayout pad = pillars();
  pad.unit_height = 5e-3;
  for (const double x : {-20e-6, -5e-6, -1e-6, 0.0, 1e-6, 5e-6, 20e-6}) {
    Rig seams(pad, halves(0.0)), plane(pad, {{Plane{}, Eigen::Vector3d::Zero()}});
    for (int k = 0; k <= 40; ++k) {
      const Pose pose{turn, {x, 0.0, 0.1e-3 - 1e-5 * k}};
      const ContactFrame &a = seams.step(pose), &b = plane.step(pose);
      ASSERT_LT((a.force - b.force).abs().maxCoeff(), 1e-9) << x << " " << k;
    }
  }
}

TEST(SeveralSurfaces, ManyWaysUpAndDownASlopeLoseNoForce) {
  // A ramp that rises from a flat face, crossed to and fro: back on the flat face the element
  // presses with k_n d as before.
  for (const double angle : {5.0, 20.0}) {
    const double rise = angle * std::numbers::pi / 180.0;
    const Box ramp{{20e-3, 20e-3, 10e-3}};
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(-rise, Eigen::Vector3d::UnitY()).toRotationMatrix();
    // Its upper face contains the line x = z = 0.
    const Eigen::Vector3d middle = turn * Eigen::Vector3d(0.0, 0.0, -10e-3);
    std::vector<Field> fields;
    const PadLayout pad = pillars(1, 0.0);
    for (const Box& box : {wide, ramp}) fields.emplace_back(pad, box, Friction{0.0, 0.0});
    const auto force_at = [&](double x) {
      const Pose pose = at(x, 0.0, -0.3e-3),
                 in_ramp{turn.transpose() * pose.rotation, turn.transpose() * (pose.position - middle)};
      step_on_surfaces(fields, std::array{Pose{pose.rotation, pose.position - Eigen::Vector3d(0.0, 0.0, -10e-3)}, in_ramp}, 1e-3,
                       {});
      return fields[0].normal_force(0) + fields[1].normal_force(0);
    };
    for (int k = 0; k <= 40; ++k) {
      const Pose pose = at(-2e-3, 0.0, 0.1e-3 - 1e-5 * k);
      const Pose in_ramp{turn.transpose() * pose.rotation, turn.transpose() * (pose.position - middle)};
      step_on_surfaces(fields, std::array{Pose{pose.rotation, pose.position - Eigen::Vector3d(0.0, 0.0, -10e-3)}, in_ramp}, 1e-3,
                       {});
    }
    for (int pass = 0; pass < 50; ++pass) {
      for (int k = 0; k <= 80; ++k) force_at(-2e-3 + 50e-6 * k);
      for (int k = 0; k <= 80; ++k) force_at(2e-3 - 50e-6 * k);
    }
    EXPECT_NEAR(force_at(-2e-3), k_n * 0.3e-3, 1e-6) << angle;
  }
}

TEST(SeveralSurfaces, EffectsRememberAnElementOverASeam) {
  for (const char* name : {"ageing", "stribeck", "viscous_friction", "viscoelastic"}) {
    SCOPED_TRACE(name);
    expect_as_on_a_plane(pillars(), halves(0.0), {testing_bench::named(effect_catalogue(), name)}, 1e-11);
  }
  PadLayout damped = pillars();
  for (Element& element : damped.elements) element.c_normal = element.c_tangential = 5.0;
  expect_as_on_a_plane(damped, halves(0.0), {}, 1e-11);
}

TEST(SeveralSurfaces, BumpsOfTwoSurfacesBearOnce) {
  // Ridges of 20 um protrude from two level boxes: in the step of a touch a pillar is outside both
  // shapes and on a ridge of either.
  const std::vector<Named> ridges{testing_bench::named(effect_catalogue(), "texture", {{"height", 20e-6}, {"wavelength", 1e-3}})};
  Rig two(pillars(), {{wide, {0.0, 0.0, -10e-3}}, {wide, {0.0, 0.0, -10e-3}}}, ridges),
      one(pillars(), {{wide, {0.0, 0.0, -10e-3}}}, ridges);
  for (int k = 0; k < 400; ++k) {
    const Pose pose = at(1e-5 * k, 0.0, 30e-6 - 1e-7 * k);
    const ContactFrame &a = two.step(pose), &b = one.step(pose);
    ASSERT_EQ(two.touching_twice(), 0U) << k;
    ASSERT_LT((a.force - b.force).abs().maxCoeff(), 1e-12) << k;
  }
  EXPECT_GT(one.fields[0].touching(), 0U);
}

TEST(SeveralSurfaces, AHigherNeighbourGivesNoEnergyToWhatComesFromTheSide) {
  // From a face at 0 to one at 0.2 mm, entered from the side: the depth continues from 0.3 mm, so
  // the force does not grow.
  Rig rig(pillars(1, 0.0),
          {{Box{{10e-3, 20e-3, 10e-3}}, {-10e-3, 0.0, -10e-3}}, {Box{{10e-3, 20e-3, 10e-3}}, {10e-3, 0.0, -9.8e-3}}});
  for (int k = 0; k <= 40; ++k) rig.step(at(-2e-3, 0.0, 0.1e-3 - 1e-5 * k));
  for (int k = 0; k <= 400; ++k) {
    const ContactFrame& frame = rig.step(at(-2e-3 + 1e-5 * k, 0.0, -0.3e-3));
    ASSERT_NEAR(frame.force(2, 0), k_n * 0.3e-3, 1e-9) << k;
  }
  EXPECT_EQ(rig.fields[1].touching(), 1U);
  EXPECT_NEAR(rig.step(at(2e-3, 0.0, -0.35e-3)).force(2, 0), k_n * 0.35e-3, 1e-9);  // pressed further
  for (int k = 0; k <= 20; ++k) rig.step(at(2e-3, 0.0, -0.35e-3 + 5e-5 * k));
  EXPECT_EQ(rig.fields[1].touching(), 0U);  // and out again
}

TEST(SeveralSurfaces, ASlopeThatRisesOutOfAFaceIsClimbed) {
  // A ball of 20 mm protrudes from a box by 0.5 mm: a sliding element always feels the higher of
  // the two. On the ball it is R - r deep, on the box 0.3 mm; the ball is higher within 4.444 mm,
  // sqrt(R^2 - (R - 0.5 mm)^2), of its middle.
  const double radius = 20e-3, out = 0.5e-3;
  const Eigen::Vector3d middle(0.0, 0.0, out - radius);
  PadLayout pad = pillars(1, 0.0);
  Rig rig(pad, {{wide, {0.0, 0.0, -10e-3}}, {Sphere{radius}, middle}});
  for (int k = 0; k <= 40; ++k) rig.step(at(-8e-3, 0.0, 0.1e-3 - 1e-5 * k));
  double highest = 0.0;
  for (int k = 0; k <= 1600; ++k) {
    const double x = -8e-3 + 1e-5 * k;
    rig.step(at(x, 0.0, -0.3e-3));
    const double on_ball = radius - (Eigen::Vector3d(x, 0.0, -0.3e-3) - middle).norm();
    const double edge = std::sqrt(radius * radius - (radius - out) * (radius - out));
    const double expected = k_n * (std::abs(x) < edge ? on_ball : 0.3e-3);
    // Distances along the axis are exact to first order, so the change is up to 40 um off. At the
    // edge the ball's face leans by 13 deg, so it is 7 to 9 um less deep: the element gains no
    // depth where it returns to the box.
    if (std::abs(std::abs(x) - edge) > 0.05e-3) {
      ASSERT_NEAR(rig.fields[0].normal_force(0) + rig.fields[1].normal_force(0), expected, k_n * 10e-6) << x;
    }
    ASSERT_EQ(rig.touching_twice(), 0U);
    highest = std::max(highest, expected);
  }
  EXPECT_NEAR(highest, k_n * 0.8e-3, 1e-3);
}

TEST(SeveralSurfaces, TrialsAheadGiveAnElementToOneSurface) {
  const PadLayout pad = pillars(1, 0.0);
  Rig rig(pad, {{wide, {0.0, 0.0, -10e-3}}, {wide, {0.0, 0.0, -10e-3}}});
  rig.step(at(0.0, 0.0, 0.01e-3));
  const Pose ahead = at(0.0, 0.0, 10e-3 - 0.02e-3);
  exclude_all_but_first(rig.fields, std::array{ahead, ahead});
  for (Field& field : rig.fields) field.step(ahead, 1e-3);  // one at a time, as the implicit solver does
  EXPECT_EQ(rig.fields[0].touching(), 1U);
  EXPECT_EQ(rig.fields[1].touching(), 0U);
}

TEST(SeveralSurfaces, TrialsAheadMeetTheHigherFace) {
  // Tops at 0 and 0.1 mm, a trial down to -0.02 mm: 0.12 mm deep in the higher one alone.
  const Placed low{wide, {0.0, 0.0, -10e-3}}, high{wide, {0.0, 0.0, -9.9e-3}};
  for (const std::size_t higher : {0U, 1U}) {
    const std::vector<Placed> surfaces = higher == 0 ? std::vector{high, low} : std::vector{low, high};
    Rig rig(pillars(1, 0.0), surfaces);
    rig.step(at(0.0, 0.0, 0.2e-3));
    std::vector<Pose> ahead;
    for (const Placed& surface : surfaces) ahead.push_back(at(0.0, 0.0, -0.02e-3 - surface.place.z()));
    exclude_all_but_first(rig.fields, ahead);
    for (std::size_t k = 0; k < 2; ++k) rig.fields[k].step(ahead[k], 1e-3);
    EXPECT_NEAR(rig.fields[higher].normal_force(0), k_n * 0.12e-3, 1e-9) << higher;
    EXPECT_EQ(rig.fields[1 - higher].touching(), 0U) << higher;
  }
}

}  // namespace
}  // namespace slipbench::testing_field::several_surfaces_test

// The skin as a mesh: its area, its elastic foundation against closed forms, its refinement, and
// the field on a curved pad.
#include "sensors/biotac_sp/skin.h"

#include <algorithm>
#include <limits>

#include "tests/expect.h"
#include "tests/sensors/biotac_sp/rig.h"

namespace slipbench::biotac_sp_test {
namespace {

using biotac_sp::make_skin;
using biotac_sp::Skin;

constexpr double k_normal = 37e3;

Skin skin(std::size_t elements, const Eigen::Vector3d& of_radii = radii) {
  return make_skin({elements, of_radii, k_normal, 0.5}, "sensors.finger");
}

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

TEST(BioTacSkin, ElementsStandForTheirAreaOfIt) {
  // Half a sphere: 2 pi R^2, with equal elements. Half an ellipsoid of revolution with a > b = c:
  // pi b^2 (1 + a/(b e) asin e), e^2 = 1 - b^2/a^2. The points follow the midpoint rule in height,
  // whose error for this smooth integrand is some 1/n^2, and the golden angle around, some n^-3/2:
  // 2e-4.
  constexpr double r = 10e-3;
  EXPECT_NEAR(sum(skin(300, {r, r, r}).area) / (2.0 * pi * r * r), 1.0, 1e-12);
  constexpr double a = 14e-3, b = 10e-3;
  const double e = std::sqrt(1.0 - b * b / (a * a));
  EXPECT_NEAR(sum(skin(300, {a, b, b}).area) / (pi * b * b * (1.0 + a / (b * e) * std::asin(e))), 1.0, 1e-3);
}

TEST(BioTacSkin, LiesOnTheEllipsoidAndLooksOutwards) {
  const Skin mesh = skin(300);
  double stiffness = 0.0;
  for (std::size_t i = 0; i < mesh.area.size(); ++i) {
    const Element& element = mesh.layout.elements[i];
    // In P the ellipsoid's middle is b above the origin; its radii are a along X, c along Y, b
    // along Z.
    const Eigen::Vector3d in_p(radii.x(), radii.z(), radii.y()), from_middle = element.tip - Eigen::Vector3d(0.0, 0.0, radii.y());
    EXPECT_NEAR(from_middle.cwiseQuotient(in_p).norm(), 1.0, 1e-12);
    EXPECT_LT(from_middle.z(), 0.0);
    const Eigen::Vector3d normal = from_middle.cwiseQuotient(in_p.cwiseProduct(in_p)).normalized();
    EXPECT_NEAR((element.axis - normal).norm(), 0.0, 1e-12);
    EXPECT_NEAR(element.k_normal / mesh.area[i], k_normal / sum(mesh.area), 1e-3) << "an elastic foundation";
    EXPECT_DOUBLE_EQ(element.k_tangential, 0.5 * element.k_normal);
    stiffness += element.k_normal;
  }
  EXPECT_NEAR(stiffness, k_normal, 1e-6);
}

TEST(BioTacSkin, UnitsAreWhatIsNearestToAnElectrode) {
  // E1 is at x = 9.8 mm, on the side of z > 0, which is -Y of P; E11 is its mirror image; E24 is in
  // the middle.
  const Skin mesh = skin(300);
  const auto& units = mesh.layout.units;
  ASSERT_EQ(units.size(), electrodes);
  const auto mean = [&](std::size_t e) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < units[e].count; ++i) middle += mesh.layout.elements[units[e].first + i].tip;
    return Eigen::Vector3d(middle / static_cast<double>(units[e].count));
  };
  EXPECT_GT(mean(0).x(), 8e-3);
  EXPECT_LT(mean(0).y(), -3e-3);
  EXPECT_GT(mean(10).y(), 3e-3);
  EXPECT_LT(mean(9).x(), -8e-3) << "E10, towards the nail's root";
  EXPECT_LT(mean(23).z(), 1e-3) << "E24, near the outermost point";
  for (std::size_t e = 0; e < electrodes; ++e) {
    for (std::size_t i = 0; i < units[e].count; ++i) {
      const Eigen::Vector3d& tip = mesh.layout.elements[units[e].first + i].tip;
      for (std::size_t other = 0; other < electrodes; ++other) {
        ASSERT_LE((tip - mesh.above[e]).norm(), (tip - mesh.above[other]).norm()) << e << ' ' << other;
      }
    }
  }
  for (const std::size_t n : {200U, 250U, 400U, 1000U, 4000U}) EXPECT_NO_THROW(skin(n)) << n;
}

TEST(BioTacSkin, RefusesRadiiThatLeaveAnElectrodeWithoutSkin) {
  // A needle of 100 mm: 300 points over 200 mm of length, with pairs of electrodes at nearly the
  // same place along it.
  EXPECT_THAT(scene_refusal_of([&] {
                make({{"radii", std::vector{100e-3, 1e-3, 1e-3}}});
              }),
              AllOf(refused_at("sensors.finger.radii", {"[100 mm, 1 mm, 1 mm]", "[13.85 mm, 10.1 mm, 9.85 mm]"}),
                    testing::ContainsRegex("electrode E[0-9]+")));
}

double force_on_plane(const Skin& mesh, const Eigen::Vector3d& outward, double depth, const Eigen::Vector3d& of_radii) {
  Field field(mesh.layout, Plane{}, {0.5, 0.5});
  field.step(pressed(outward, depth, of_radii), 1e-3);
  return field.wrench_on_surface().force.norm();
}

TEST(BioTacSkin, CarriesTheForceOfAnElasticFoundation) {
  // A sphere of foundation modulus q = k_normal/(2 pi R^2): depth d - h at the height h above the
  // lowest point, and by Archimedes the same area 2 pi R dh at each height: F = q pi R d^2 =
  // k_normal d^2/(2R), exactly. The error of the sum over n points comes from the rim of the
  // contact, where the depth goes to zero; its share of n d/R points is small.
  constexpr double r = 10e-3;
  const Skin fine = skin(4000, {r, r, r});
  for (const Eigen::Vector3d& outward : {Eigen::Vector3d(0.0, 0.0, -1.0), Eigen::Vector3d(0.4, 0.3, -1.0)}) {
    for (const double d : {1e-3, 2e-3}) {
      EXPECT_NEAR(force_on_plane(fine, outward, d, {r, r, r}) / (k_normal * d * d / (2.0 * r)), 1.0, 0.003) << d;
    }
  }
  // The finger: near its outermost point the radii of curvature are a^2/b = 19.0 mm and c^2/b = 9.6
  // mm, so F = q pi sqrt(R1 R2) d^2 up to d/R ([johnson1985], sec. 4.3). With the default q that is
  // 2 N at 1 mm, where the manual's pressure saturates.
  const Skin finger = skin(4000);
  const double q = k_normal / sum(finger.area), d = 0.2e-3;
  const double r1 = radii.x() * radii.x() / radii.y(), r2 = radii.z() * radii.z() / radii.y();
  EXPECT_NEAR(force_on_plane(finger, {0.0, 0.0, -1.0}, d, radii) / (q * pi * std::sqrt(r1 * r2) * d * d), 1.0, 0.04)
      << "d/R, rim";
  EXPECT_NEAR(force_on_plane(finger, {0.0, 0.0, -1.0}, 1e-3, radii), 2.0, 0.15);
}

TEST(BioTacSkin, EnclosesTheVolumeOfAnEllipsoidsCap) {
  // The plane at depth d cuts off a cap whose volume an affine map takes to a cap of the unit
  // sphere: a b c pi t^2 (3 - t)/3 with t = d/h and h = |(a, b, c) n|, the distance from the middle
  // to the tangent plane. The volume is the sum of depth times area projected along the plane's
  // normal.
  for (const auto& [n, tolerance] : {std::pair{300U, 0.01}, {4000U, 0.001}}) {
    const Skin mesh = skin(n);
    for (const Eigen::Vector3d& outward :
         {Eigen::Vector3d(0.0, 0.0, -1.0), Eigen::Vector3d(0.6, 0.0, -1.0), Eigen::Vector3d(-0.3, 0.5, -1.0)}) {
      const double d = 1.5e-3;
      Field field(mesh.layout, Plane{}, {0.5, 0.5});
      field.step(pressed(outward, d, radii), 1e-3);
      double volume = 0.0;
      for (std::size_t i = 0; i < mesh.area.size(); ++i) {
        volume += field.penetration(i) * mesh.area[i] * mesh.layout.elements[i].axis.dot(outward.normalized());
      }
      const double h = Eigen::Vector3d(radii.x(), radii.z(), radii.y()).cwiseProduct(outward.normalized()).norm(), t = d / h;
      EXPECT_NEAR(volume / (radii.prod() * pi * t * t * (3.0 - t) / 3.0), 1.0, tolerance) << n << ' ' << outward.transpose();
    }
  }
}

// The curved pad, whose elements have axes of their own, on each kind of surface: depth by element,
// against the distance computed here.
TEST(BioTacSkin, MeetsEverySurfaceAtItsDistance) {
  const Skin mesh = skin(300);
  const Pose flat = pressed({0.1, -0.2, -1.0}, 1.5e-3, radii);
  const auto raised = [&](double height) {
    Pose pose = flat;
    pose.position.z() += height;
    return pose;
  };
  struct Case {
    const char* name;
    Surface surface;
    double height;  // of the surface's top above its origin [m]
    double (*depth)(const Eigen::Vector3d& tip);
  };
  constexpr double r = 20e-3;
  const Case cases[] = {
      {"plane", Plane{}, 0.0, [](const Eigen::Vector3d& p) { return -p.z(); }},
      {"box", Box{{30e-3, 30e-3, r}}, r, [](const Eigen::Vector3d& p) { return r - p.z(); }},
      {"sphere", Sphere{r}, r, [](const Eigen::Vector3d& p) { return r - p.norm(); }},
      {"cylinder", Cylinder{15e-3, r}, r, [](const Eigen::Vector3d& p) { return r - p.z(); }},
  };
  for (const Case& c : cases) {
    Field field(mesh.layout, c.surface, {0.5, 0.5});
    ContactLabels labels(mesh.layout);
    const Pose pose = raised(c.height);
    field.step(pose, 1e-3);
    const ContactFrame& frame = labels.update({&field, 1}, 0.0, 1e-3);
    std::size_t touching = 0;
    for (std::size_t i = 0; i < mesh.area.size(); ++i) {
      const Element& element = mesh.layout.elements[i];
      const bool looks = (pose.rotation * element.axis).z() < 0.0;
      const double depth = looks ? std::max(0.0, c.depth(pose * element.tip)) : 0.0;
      touching += depth > 0.0 ? 1U : 0U;
      EXPECT_NEAR(frame.element_depth[static_cast<Eigen::Index>(i)], depth, 1e-12) << c.name << ' ' << i;
    }
    EXPECT_GT(touching, 15U) << c.name;
    // Units report their elements' forces, along the surface's normal.
    Eigen::Array3d force = frame.force.rowwise().sum();
    EXPECT_NEAR(force.matrix().norm(), field.wrench_on_pad().force.norm(), 1e-9) << c.name;
    for (std::size_t e = 0; e < electrodes; ++e) {
      const UnitRange unit = mesh.layout.units[e];
      bool touches = false;
      for (std::size_t i = 0; i < unit.count; ++i) touches = touches || field.penetration(unit.first + i) > 0.0;
      EXPECT_EQ(frame.unit_state[e], touches ? UnitState::stick : UnitState::detached) << c.name << ' ' << e;
    }
  }
}

TEST(BioTacSkin, UnitsAtTheRimOfTheContactSlipFirst) {
  // Dragged by s, a sticking element has the stretch s and slips at k_t s = mu k_n d. So elements
  // with d < k_t s/(k_n mu) slip: with k_t/k_n = 1/2 and mu = 1/2, d < s. After 0.5 mm in a contact
  // 1 mm deep the middle sticks, and elements shallower than 0.5 mm slip.
  const Skin mesh = skin(1000);
  Field field(mesh.layout, Plane{}, {0.5, 0.5});
  ContactLabels labels(mesh.layout);
  Pose pose = pressed({0.0, 0.0, -1.0}, 1e-3, radii);
  field.step(pose, 1e-3);
  pose.position.x() += 0.5e-3;
  field.step(pose, 1e-3);
  const ContactFrame& frame = labels.update({&field, 1}, 1e-3, 1e-3);
  for (std::size_t e = 0; e < electrodes; ++e) {
    double deepest = 0.0, shallowest = std::numeric_limits<double>::infinity();
    const UnitRange unit = mesh.layout.units[e];
    for (std::size_t i = unit.first; i < unit.first + unit.count; ++i) {
      const double depth = frame.element_depth[static_cast<Eigen::Index>(i)];
      if (depth == 0.0) continue;
      deepest = std::max(deepest, depth);
      shallowest = std::min(shallowest, depth);
    }
    const UnitState expected = deepest == 0.0         ? UnitState::detached
                               : deepest < 0.5e-3     ? UnitState::slip
                               : shallowest >= 0.5e-3 ? UnitState::stick
                                                      : UnitState::partial;
    EXPECT_EQ(frame.unit_state[e], expected) << e;
  }
  EXPECT_EQ(frame.state, PadState::incipient);
}

// Returns the contact of a finger pressed onto `surface`: from 0.5 mm above down by 2 mm, then
// along X by `drag` [m].
ContactFrame press_down(const Skin& mesh, const Surface& surface, double top, Friction friction, double drag) {
  Field field(mesh.layout, surface, friction);
  ContactLabels labels(mesh.layout);
  Pose pose = pressed({0.3, -0.2, -1.0}, 1.5e-3, radii);
  const double height = pose.position.z() + top;
  for (int k = 0; k <= 20; ++k) {
    pose.position.z() = height + 2e-3 - 1e-4 * k;
    field.step(pose, 1e-3);
  }
  pose.position.x() += drag;
  field.step(pose, 1e-3);
  return labels.update({&field, 1}, 0.0, 1e-3);
}

// Largest contribution of the drag term to an electrode's dent [m].
double largest_drag(const Skin& mesh, const ContactFrame& frame) {
  const biotac_sp::Kernel kernel{.near = 3.5e-3, .far = 9e-3, .far_share = 0.5, .swell = 0.35, .stretch = 0.3};
  biotac_sp::Kernel still = kernel;
  still.stretch = 0.0;
  const biotac_sp::Dents with(mesh, kernel, "sensors.finger"), without(mesh, still, "sensors.finger");
  std::vector<Eigen::Index> touching;
  for (Eigen::Index i = 0; i < frame.element_depth.size(); ++i) {
    if (frame.element_depth[i] > 0.0) touching.push_back(i);
  }
  double largest = 0.0;
  for (std::size_t e = 0; e < electrodes; ++e) {
    largest = std::max(largest, std::abs(with.dent(e, frame, touching) - without.dent(e, frame, touching)));
  }
  return largest;
}

TEST(BioTacSkin, APressDragsNothingAlong) {
  // On a plane a tip goes straight in, with friction or without. On a ball without friction nothing
  // holds it: what remains is at most 1e-13 m, which does not count as slip
  // (kernel::shortest_slip). Then |w| <= S q d sum_i|dG_i/dr|: sqrt(pi/2)/l = 358 /m on a flat skin
  // for the near kernel, 1/L = 111 /m for the far one, half of each, so 0.3 * 1e-13 m * 1.5 mm *
  // 235 /m = 1.1e-14 m.
  const Skin mesh = skin(300);
  for (const double mu : {0.0, 0.9}) {
    const ContactFrame on_plane = press_down(mesh, Plane{}, 0.0, {mu, mu}, 0.0);
    ASSERT_GT(on_plane.element_depth.maxCoeff(), 1.4e-3);
    EXPECT_LE(on_plane.element_shear.abs().maxCoeff(), 1e-13) << mu;
    EXPECT_LT(largest_drag(mesh, on_plane), 2e-14) << mu;
  }
  const ContactFrame on_ball = press_down(mesh, Sphere{20e-3}, 20e-3, {0.0, 0.0}, 0.0);
  ASSERT_GT(on_ball.element_depth.maxCoeff(), 1.0e-3);
  EXPECT_LE(on_ball.element_shear.abs().maxCoeff(), 1e-13);
  EXPECT_LT(largest_drag(mesh, on_ball), 2e-14);
}

TEST(BioTacSkin, ADragIsHeldByFriction) {
  // k_t q <= mu k_n d with k_t = k_n/2: elements that are deep enough stick and trail by the whole
  // drag, against it; all others trail by 2 mu d. On a plane the drag has no normal component.
  const Skin mesh = skin(300);
  constexpr double mu = 0.2, drag = 0.3e-3;
  const Pose pose = pressed({0.3, -0.2, -1.0}, 1.5e-3, radii);
  const ContactFrame frame = press_down(mesh, Plane{}, 0.0, {mu, mu}, drag);
  std::size_t stuck = 0, slipping = 0;
  for (Eigen::Index i = 0; i < frame.element_depth.size(); ++i) {
    const double held = std::min(drag, 2.0 * mu * frame.element_depth[i]);
    const Eigen::Vector3d in_world = pose.rotation * Eigen::Vector3d(frame.element_shear.row(i).transpose().matrix());
    EXPECT_NEAR((in_world - Eigen::Vector3d(-held, 0.0, 0.0)).norm(), 0.0, 1e-12) << i;
    stuck += held == drag ? 1U : 0U;
    slipping += held > 0.0 && held < drag ? 1U : 0U;
  }
  EXPECT_GT(stuck, 5U);
  EXPECT_GT(slipping, 5U);
  EXPECT_GT(largest_drag(mesh, frame), 1e-6) << "is felt";
}

// The deepest dent that an electrode feels, with elements at the depths of `depth`.
template <class Depth>
double deepest_dent(std::size_t n, Depth&& depth) {
  const Skin mesh = skin(n);
  const biotac_sp::Dents dents(mesh, {.near = 3.5e-3, .far = 9e-3, .far_share = 0.5, .swell = 0.35, .stretch = 0.0},
                               "sensors.finger");
  ContactFrame frame;
  frame.element_depth.setZero(static_cast<Eigen::Index>(n));
  frame.element_shear.setZero(static_cast<Eigen::Index>(n), 3);
  std::vector<Eigen::Index> touching;
  for (std::size_t i = 0; i < n; ++i) {
    const auto place = static_cast<Eigen::Index>(i);
    frame.element_depth[place] = depth(mesh.layout.elements[i]);
    if (frame.element_depth[place] > 0.0) touching.push_back(place);
  }
  double deepest = 0.0;
  for (std::size_t e = 0; e < electrodes; ++e) deepest = std::max(deepest, dents.dent(e, frame, touching));
  return deepest;
}

TEST(BioTacSkin, DentsAreThoseOfAFourTimesFinerMesh) {
  // The limit is 1 %, at the depths of the recordings (1.1 to 2.7 mm), for a plane at any
  // orientation. An edge through the contact cuts off whole elements, and the mesh becomes
  // noticeable (README).
  for (const double d : {1.1e-3, 1.6e-3, 2.7e-3}) {
    for (const double x : {-0.6, -0.3, 0.0, 0.3, 0.6}) {
      for (const double y : {-0.5, -0.2, 0.0, 0.2, 0.5}) {
        const Eigen::Vector3d outward(x, y, -1.0);
        const Pose pose = pressed(outward, d, radii);
        const auto depth = [&](const Element& element) {
          return (pose.rotation * element.axis).z() < 0.0 ? std::max(0.0, -(pose * element.tip).z()) : 0.0;
        };
        EXPECT_NEAR(deepest_dent(300, depth) / deepest_dent(1200, depth), 1.0, 0.01) << d << ' ' << outward.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace slipbench::biotac_sp_test

// The friction map of patchy_friction.
#include <cmath>
#include <utility>

#include "tests/expect.h"
#include "tests/oracle/pads.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::patchy_friction_test {
namespace {

constexpr double shortest = 2e-3, longest = 5e-3, sd = 0.3;
constexpr double period = 16.0 * shortest;  // the map is tabulated at an eighth of the shortest wave, 128 times, and then repeats
constexpr double cell = shortest / 8.0;

// ln of the friction factor under a pad's elements: mu_s f_n over its value without the effect. The
// pad is set down anew at every pose, because sticking tips would not move.
class Map {
 public:
  explicit Map(PadLayout pad, std::uint64_t seed = 7, std::uint64_t trial = 0, const std::vector<Wanted>& others = {},
               const std::pair<double, double>& waves = {shortest, longest})
      : plain_(pad, Plane{}, {0.5, 0.5}), field_(with(pad, seed, trial, others, waves)) {}

  std::vector<double> at(const Pose& pose) {
    Pose lifted = pose;
    lifted.position.z() += 0.1;
    for (Field* field : {&plain_, &field_}) {
      field->step(lifted, 1e-3);
      field->step(pose, 1e-3);
    }
    std::vector<double> values;
    for (std::size_t i = 0; i < field_.size(); ++i) values.push_back(std::log(field_.stick_limit(i) / plain_.stick_limit(i)));
    return values;
  }

 private:
  static Field with(const PadLayout& pad, std::uint64_t seed, std::uint64_t trial, std::vector<Wanted> others,
                    const std::pair<double, double>& waves) {
    others.push_back({"patchy_friction", {{"sd", sd}, {"shortest", waves.first}, {"longest", waves.second}}});
    return field_with(pad, {0.5, 0.5}, others, seed, trial);
  }

  Field plain_, field_;
};

// 64 x 64 elements at pitch `pitch`, whose first element is at the pad's origin.
PadLayout patch(double pitch) {
  PadLayout pad = oracle::square_grid(64, 64.0 * pitch, 1000.0, 600.0);
  for (Element& element : pad.elements) element.tip += Eigen::Vector3d(31.5 * pitch, 31.5 * pitch, 0.0);
  return pad;
}

TEST(PatchyFriction, LogarithmHasTheMeanAndDeviationAsked) {
  // Over one period, at the grid's points: each of 24 waves has a whole number of periods, so g has
  // mean 0 and ln mu the mean -sd^2/2. The variance of g is 1 if all 24 waves differ; two equal
  // ones change it by at most 2/24 cos(difference of phases). Among some 340 possible waves 24
  // draws give 24 x 23/2/340 = 0.8 coincidences on average: over 20 maps the mean variance has a
  // standard error of sqrt(0.8/2 x 20) x 2/24/20 = 0.012; three of these are allowed.
  double sum_variance = 0.0;
  const int maps = 20;
  const PadLayout pad = patch(cell);
  for (int trial = 0; trial < maps; ++trial) {
    Map map(pad, 7, static_cast<std::uint64_t>(trial));
    double mean = 0.0, square = 0.0, count = 0.0;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, std::pair{1.0, 0.0}, std::pair{0.0, 1.0}, std::pair{1.0, 1.0}}) {
      for (const double value : map.at(at(0.5 * period * x, 0.5 * period * y, -1e-3))) {
        mean += value;
        square += (value + 0.5 * sd * sd) * (value + 0.5 * sd * sd);
        count += 1.0;
      }
    }
    EXPECT_NEAR(mean / count, -0.5 * sd * sd, 1e-9) << "trial " << trial;
    sum_variance += square / count;
  }
  EXPECT_NEAR(sum_variance / maps / (sd * sd), 1.0, 3.0 * 0.012 + 0.01);
}

TEST(PatchyFriction, IsFixedToTheSurface) {
  // A tip held over one spot sees the same friction at any pose of the pad and after any path.
  PadLayout pad = one_unit(1000.0, 600.0);
  pad.elements[0].tip = {4e-3, 0.0, 0.0};
  Map map(pad);
  const Eigen::Vector3d spot(3.1e-3, -1.7e-3, -1e-3);
  std::vector<double> seen;
  for (const double angle : {0.0, 1.0, 2.5, -2.0}) {
    const Pose turned = oracle::turned(angle, Eigen::Vector3d::Zero());
    seen.push_back(map.at(oracle::turned(angle, spot - turned.rotation * pad.elements[0].tip))[0]);
  }
  for (const double value : seen) EXPECT_NEAR(value, seen[0], 1e-12);  // slopes of 22/mm times 1e-18 m of rounding
  EXPECT_GT(std::abs(map.at(at(0.0, 0.0, -1e-3))[0] - seen[0]), 1e-6) << "and another one elsewhere";
}

TEST(PatchyFriction, DependsOnSeedAndTrialOnly) {
  const PadLayout pad = patch(0.37e-3);
  const Pose pose = at(0.0, 0.0, -1e-3);
  const auto map = Map(pad, 7, 3).at(pose);
  EXPECT_EQ(Map(pad, 7, 3).at(pose), map);
  EXPECT_NE(Map(pad, 7, 4).at(pose), map);
  EXPECT_NE(Map(pad, 8, 3).at(pose), map);
  // Fields share a map: the map depends on these waves alone, and lives as long as its users.
  Map older(pad, 7, 3);
  EXPECT_NE(Map(pad, 7, 3, {}, {1.5e-3, longest}).at(pose), map);
  EXPECT_NE(Map(pad, 7, 3, {}, {shortest, 4e-3}).at(pose), map);
  EXPECT_EQ(older.at(pose), map);
  // Its draws depend neither on an effect before it nor on the pad's structure.
  EXPECT_EQ(Map(pad, 7, 3, {{"stribeck", {}}, {"ageing", {}}, {"texture", {{"height", 0.0}}}}).at(pose), map);
  PadLayout half = pad;
  half.elements.resize(2048);
  half.units.resize(2048);
  const auto part = Map(half, 7, 3).at(pose);
  EXPECT_TRUE(std::equal(part.begin(), part.end(), map.begin()));
}

TEST(PatchyFriction, RepeatsWithoutASeam) {
  // The slope of g is at most sqrt(2/24) x 24 x 2 pi/shortest = 22/mm, so over 1 um ln mu changes
  // by at most sd x 0.022, across the seam as elsewhere.
  Map map(one_unit(1000.0, 600.0));
  const auto value = [&](double x, double y) { return map.at(at(x, y, -1e-3))[0]; };
  for (const double y : {0.0, 1.234e-3, -7.7e-3}) {
    for (const double x : {0.3e-3, 5.1e-3, 31.99e-3}) {
      EXPECT_NEAR(value(x, y), value(x + period, y), 1e-9);
      EXPECT_NEAR(value(x, y), value(x - 3.0 * period, y + 2.0 * period), 1e-9);
    }
    for (const double seam : {0.0, period, -period}) {
      EXPECT_NEAR(value(seam - 0.5e-6, y), value(seam + 0.5e-6, y), sd * 0.022);
      EXPECT_NEAR(value(y, seam - 0.5e-6), value(y, seam + 0.5e-6), sd * 0.022);
    }
  }
}

TEST(PatchyFriction, RefusesCurvedSurfacesAndWavesOutOfOrder) {
  const PadLayout pad = one_unit(1000.0, 600.0);
  EXPECT_THAT(refusal_of([&] {
                installed(pad, {{"patchy_friction", {}}}, false);
              }),
              refused_at("effects", {"patchy_friction", "plane", "box"}));
  for (const double longer : {1.9e-3, 20.1e-3}) {
    EXPECT_THAT(refusal_of([&] {
                  installed(pad, {{"patchy_friction", {{"shortest", 2e-3}, {"longest", longer}}}});
                }),
                AllOf(HasSubstr("the longest wavelength of patchy_friction is " + format_quantity(longer, Quantity::length)),
                      HasSubstr("allowed: `shortest` (2 mm) to ten times `shortest`")));
  }
  for (const double longer : {2e-3, 20e-3}) {
    EXPECT_EQ(refusal_of([&] { installed(pad, {{"patchy_friction", {{"shortest", 2e-3}, {"longest", longer}}}}); }), "accepted");
  }
}

TEST(PatchyFriction, EveryFaceOfABoxHasPatchesAlongBothItsDirections) {
  // One element on a face of a box of 40 mm, moved along it in steps of 1 mm: friction varies along
  // either direction, and differently on two faces. On the top it equals the plane's.
  const double half = 0.02, indentation = 1e-4;
  PadLayout pad = oracle::square_grid(1, 1e-3, 1000.0, 600.0);
  pad.elements[0].tip.setZero();
  const Wanted patches{"patchy_friction", {{"sd", sd}, {"shortest", shortest}, {"longest", longest}}};
  const auto factor = [&](const Eigen::Vector3d& normal, const Eigen::Vector3d& along) {
    Field field(pad, Box{Eigen::Vector3d::Constant(half)}, {0.5, 0.5}, installed(pad, {patches}));
    Pose pose{.rotation = element_frame(-normal), .position = (half - indentation) * normal + along};
    field.step(pose, 1e-3);
    return field.stick_limit(0) / (0.5 * 1000.0 * indentation);
  };
  std::vector<double> seen;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      Eigen::Vector3d normal = Eigen::Vector3d::Zero(), first = normal, second = normal;
      normal[axis] = side, first[(axis + 1) % 3] = 1e-3, second[(axis + 2) % 3] = 1e-3;
      const double here = factor(normal, Eigen::Vector3d::Zero());
      EXPECT_GT(std::abs(factor(normal, first) - here), 1e-3) << axis << ' ' << side;
      EXPECT_GT(std::abs(factor(normal, second) - here), 1e-3) << axis << ' ' << side;
      for (const double other : seen) EXPECT_GT(std::abs(here - other), 1e-6) << axis << ' ' << side;
      seen.push_back(here);
    }
  }
  Field plane = field_with(pad, {0.5, 0.5}, {patches});
  plane.step(at(1e-3, 2e-3, -indentation), 1e-3);
  EXPECT_NEAR(factor(Eigen::Vector3d::UnitZ(), {1e-3, 2e-3, 0.0}), plane.stick_limit(0) / (0.5 * 1000.0 * indentation), 1e-9);
}

}  // namespace
}  // namespace slipbench::testing_effects::patchy_friction_test
